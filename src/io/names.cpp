#include "io/names.hpp"

namespace stillbase::io {

const Names<Frame>& frame_names() {
  static const Names<Frame> names{{"base", Frame::Base}, {"inertial", Frame::Inertial}};
  return names;
}

const Names<ImpulseSource>& impulse_source_names() {
  static const Names<ImpulseSource> names{{"given", ImpulseSource::Given},
                                          {"point_mass", ImpulseSource::PointMass},
                                          {"rigid_body", ImpulseSource::RigidBody}};
  return names;
}

const Names<ResistanceModel>& resistance_names() {
  static const Names<ResistanceModel> names{{"free", ResistanceModel::Free},
                                            {"rotor_inertia", ResistanceModel::RotorInertia},
                                            {"servo", ResistanceModel::Servo},
                                            {"locked", ResistanceModel::Locked}};
  return names;
}

const Names<AttitudeFreedom>& attitude_freedom_names() {
  static const Names<AttitudeFreedom> names{{"fixed", AttitudeFreedom::Fixed},
                                            {"axis", AttitudeFreedom::Axis},
                                            {"cone", AttitudeFreedom::Cone},
                                            {"free", AttitudeFreedom::Free}};
  return names;
}

const Names<PositionFreedom>& position_freedom_names() {
  static const Names<PositionFreedom> names{{"fixed", PositionFreedom::Fixed},
                                            {"box", PositionFreedom::Box},
                                            {"free", PositionFreedom::Free}};
  return names;
}

const Names<ObjectiveQuantity>& objective_names() {
  static const Names<ObjectiveQuantity> names = [] {
    Names<ObjectiveQuantity> out;
    for (const QuantityRow& row : quantities()) out.emplace_back(row.name, row.quantity);
    return out;
  }();
  return names;
}

const Names<RiskMeasure>& measure_names() {
  static const Names<RiskMeasure> names{{"nominal", RiskMeasure::Nominal},
                                        {"worst_case", RiskMeasure::WorstCase},
                                        {"expectation", RiskMeasure::Expectation},
                                        {"cvar", RiskMeasure::Cvar}};
  return names;
}

const Names<HandConstraint>& hand_constraint_names() {
  static const Names<HandConstraint> names{{"none", HandConstraint::None},
                                           {"position", HandConstraint::Position},
                                           {"axis", HandConstraint::Axis},
                                           {"pose", HandConstraint::Pose}};
  return names;
}

const Names<CaseConstraint>& case_constraint_names() {
  static const Names<CaseConstraint> names{
      {"none", CaseConstraint::None}, {"C", CaseConstraint::C},   {"C1", CaseConstraint::C1},
      {"C2", CaseConstraint::C2},     {"G2", CaseConstraint::G2}, {"G3", CaseConstraint::G3}};
  return names;
}

const Names<BaseMode>& base_mode_names() {
  static const Names<BaseMode> names{{"held", BaseMode::Held},
                                     {"floating", BaseMode::Floating},
                                     {"reaction-null", BaseMode::ReactionNull}};
  return names;
}

const Names<PathPolish>& path_polish_names() {
  static const Names<PathPolish> names{
      {"none", PathPolish::None}, {"attitude", PathPolish::Attitude}, {"time", PathPolish::Time}};
  return names;
}

const Names<ImpactCase>& impact_case_names() {
  static const Names<ImpactCase> names{{"G1", ImpactCase::G1},
                                       {"G2", ImpactCase::G2},
                                       {"G3", ImpactCase::G3},
                                       {"C1", ImpactCase::C1},
                                       {"C2", ImpactCase::C2}};
  return names;
}

const Names<PlanStatus>& plan_status_names() {
  static const Names<PlanStatus> names{{"optimal", PlanStatus::Optimal},
                                       {"feasible", PlanStatus::Feasible},
                                       {"infeasible", PlanStatus::Infeasible},
                                       {"limit", PlanStatus::Limit}};
  return names;
}

const Names<ContactModel>& contact_model_names() {
  static const Names<ContactModel> names{{"jump", ContactModel::Jump},
                                         {"compliant", ContactModel::Compliant},
                                         {"latch", ContactModel::Latch}};
  return names;
}

const Names<ProofStatus>& proof_status_names() {
  static const Names<ProofStatus> names{{"not_applicable", ProofStatus::NotApplicable},
                                        {"complete", ProofStatus::Complete},
                                        {"undecided", ProofStatus::Undecided}};
  return names;
}

const Names<ApproachStatus>& approach_status_names() {
  static const Names<ApproachStatus> names{
      {"found", ApproachStatus::Found},
      {"not_requested", ApproachStatus::NotRequested},
      {"start_invalid", ApproachStatus::StartInvalid},
      {"goal_invalid", ApproachStatus::GoalInvalid},
      {"goal_unreachable", ApproachStatus::GoalUnreachable},
      {"unreachable_in_base_mode", ApproachStatus::UnreachableInBaseMode},
      {"hit_early", ApproachStatus::HitEarly},
      {"time_out", ApproachStatus::TimeOut},
      {"interrupted", ApproachStatus::Interrupted},
      {"too_slow", ApproachStatus::TooSlow},
      {"base_drift_open", ApproachStatus::BaseDriftOpen}};
  return names;
}

}  // namespace stillbase::io
