// Words of the files for the values of the plain data, in both directions.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <stillbase/plan/plan.hpp>

namespace stillbase::io {

/// A list of words, each with the value that it stands for.
template <class E, std::size_t N>
using Names = std::array<std::pair<std::string_view, E>, N>;

template <class E, std::size_t N>
constexpr Names<E, N> names(const std::pair<std::string_view, E> (&list)[N]) {
  return std::to_array(list);
}

template <class List>
auto value_of(const List& names, std::string_view word) {
  std::optional<typename List::value_type::second_type> found;
  for (const auto& [name, value] : names) {
    if (name == word) found = value;
  }
  return found;
}

template <class List, class E>
std::string word_of(const List& names, const E& value) {
  for (const auto& [name, candidate] : names) {
    if (candidate == value) return std::string(name);
  }
  return {};
}

template <class List>
std::vector<std::string> words_of(const List& names) {
  std::vector<std::string> words;
  for (const auto& entry : names) words.emplace_back(entry.first);
  return words;
}

/// The words that to_string() has for the values from 0 to `last`.
template <class E>
std::vector<std::pair<std::string, E>> names_up_to(E last) {
  std::vector<std::pair<std::string, E>> out;
  for (int i = 0; i <= static_cast<int>(last); ++i) {
    out.emplace_back(to_string(static_cast<E>(i)), static_cast<E>(i));
  }
  return out;
}

inline constexpr auto kFrameNames =
    names<Frame>({{"base", Frame::Base}, {"inertial", Frame::Inertial}});
inline constexpr auto kImpulseSourceNames =
    names<ImpulseSource>({{"given", ImpulseSource::Given},
                          {"point_mass", ImpulseSource::PointMass},
                          {"rigid_body", ImpulseSource::RigidBody}});
inline constexpr auto kAttitudeFreedomNames =
    names<AttitudeFreedom>({{"fixed", AttitudeFreedom::Fixed},
                            {"axis", AttitudeFreedom::Axis},
                            {"cone", AttitudeFreedom::Cone},
                            {"free", AttitudeFreedom::Free}});
inline constexpr auto kPositionFreedomNames =
    names<PositionFreedom>({{"fixed", PositionFreedom::Fixed},
                            {"box", PositionFreedom::Box},
                            {"free", PositionFreedom::Free}});
inline constexpr auto kMeasureNames = names<RiskMeasure>({{"nominal", RiskMeasure::Nominal},
                                                          {"worst_case", RiskMeasure::WorstCase},
                                                          {"expectation", RiskMeasure::Expectation},
                                                          {"cvar", RiskMeasure::Cvar}});
inline constexpr auto kResidualFrameNames = names<ResidualFrame>(
    {{"target", ResidualFrame::Target}, {"inertial", ResidualFrame::Inertial}});
inline constexpr auto kHandConstraintNames =
    names<HandConstraint>({{"none", HandConstraint::None},
                           {"position", HandConstraint::Position},
                           {"axis", HandConstraint::Axis},
                           {"pose", HandConstraint::Pose}});
inline constexpr auto kCaseConstraintNames = names<CaseConstraint>({{"none", CaseConstraint::None},
                                                                    {"C", CaseConstraint::C},
                                                                    {"C1", CaseConstraint::C1},
                                                                    {"C2", CaseConstraint::C2},
                                                                    {"G2", CaseConstraint::G2},
                                                                    {"G3", CaseConstraint::G3}});
inline constexpr auto kBaseModeNames = names<BaseMode>({{"held", BaseMode::Held},
                                                        {"floating", BaseMode::Floating},
                                                        {"reaction-null", BaseMode::ReactionNull}});
inline constexpr auto kPathPolishNames = names<PathPolish>(
    {{"none", PathPolish::None}, {"attitude", PathPolish::Attitude}, {"time", PathPolish::Time}});
inline constexpr auto kContactModelNames = names<ContactModel>(
    {{"instantaneous", ContactModel::Instantaneous}, {"compliant", ContactModel::Compliant}});
inline constexpr auto kContactLawNames = names<ContactLaw>({{"normal", ContactLaw::Frictionless},
                                                            {"sticking", ContactLaw::Sticking},
                                                            {"latch", ContactLaw::Latch}});
inline constexpr auto kArrivalRatesNames =
    names<ArrivalRates>({{"least_joint_rate", ArrivalRates::LeastJointRate},
                         {"least_base_rate", ArrivalRates::LeastBaseRate}});
inline constexpr auto kApproachEffortNames =
    names<ApproachEffort>({{"first", ApproachEffort::First}, {"best", ApproachEffort::Best}});

inline constexpr auto kCollisionMeshesNames = names<CollisionMeshes>(
    {{"hull", CollisionMeshes::Hull}, {"decompose", CollisionMeshes::Decompose}});

inline auto resistance_names() { return names_up_to(ResistanceModel::Locked); }
inline auto impact_case_names() { return names_up_to(ImpactCase::C2); }
inline auto plan_status_names() { return names_up_to(PlanStatus::Limit); }
inline auto proof_status_names() { return names_up_to(ProofStatus::Undecided); }
inline auto capture_limit_names() { return names_up_to(CaptureLimit::TimeWindow); }
inline auto approach_status_names() { return names_up_to(ApproachStatus::Stopped); }

/// Of the catalogue of quantities.
inline std::vector<std::pair<std::string, ObjectiveQuantity>> objective_names() {
  std::vector<std::pair<std::string, ObjectiveQuantity>> out;
  for (const QuantityRow& row : quantities()) out.emplace_back(row.name, row.quantity);
  return out;
}

}  // namespace stillbase::io
