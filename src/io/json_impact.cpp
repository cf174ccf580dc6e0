#include "io/json_impact.hpp"

#include "io/json_problem.hpp"
#include "io/problem_reader.hpp"

namespace stillbase::io {

namespace {

void read_wrench(MapReader& map, const std::string& key, const char* linear, const char* angular,
                 Vector6d& out) {
  const Node* node = map.child(key, Need::Required);
  if (node == nullptr) return;
  MapReader fields(map.context(), *node, map.path_of(key));
  Vector3d upper = Vector3d::Zero(), lower = Vector3d::Zero();
  fields.vector3(linear, upper, Dimension::None, Need::Required);
  fields.vector3(angular, lower, Dimension::None, Need::Required);
  fields.finish();
  out << upper, lower;
}

}  // namespace

Json impact_json(const ImpactSummary& impact, const RobotModel& robot) {
  Json values = resistance_json(impact.resistance, robot);
  const Json model = values["model"];
  values.erase("model");
  const CaseJudgement& judgement = impact.judgement;
  return {
      {"impulse",
       {{"force", array_json(impact.Fbar.head<3>())},
        {"moment", array_json(impact.Fbar.tail<3>())}}},
      {"base_velocity_jump",
       {{"linear", array_json(impact.Delta_Omega.head<3>())},
        {"angular", array_json(impact.Delta_Omega.tail<3>())}}},
      {"joint_velocity_jump", array_json(impact.Delta_phidot)},
      {"joint_velocity_rns", array_json(impact.Delta_phidot_rns)},
      {"joint_velocity_orthogonal", array_json(impact.Delta_phidot_orthogonal)},
      {"momentum",
       {{"total", array_json(impact.total)},
        {"base", array_json(impact.base)},
        {"coupling", array_json(impact.coupling)}}},
      {"case", word_of(impact_case_names(), judgement.impact_case)},
      {"case_tolerance", judgement.tolerance},
      {"case_residuals",
       {{"total", judgement.total}, {"base", judgement.base}, {"coupling", judgement.coupling}}},
      {"rank_tolerance", impact.rank_tolerance},
      {"rank", impact.rank},
      {"closing_speed", impact.closing_speed},
      {"joint_resistance", model},
      {"joint_resistance_values", values}};
}

void read_joint_list(MapReader& map, const std::string& key, int n, JointVectord& out) {
  const Node* node = map.child(key, Need::Required);
  if (node == nullptr) return;
  const auto values = read_numbers(map.context(), *node, map.path_of(key), Dimension::None, n);
  if (values) out = Eigen::Map<const Eigen::VectorXd>(values->data(), n);
}

ImpactSummary read_impact_object(ReadContext& context, const Node& node, const std::string& path,
                                 const RobotModel& robot) {
  ImpactSummary impact;
  MapReader map(context, node, path);
  read_wrench(map, "impulse", "force", "moment", impact.Fbar);
  read_wrench(map, "base_velocity_jump", "linear", "angular", impact.Delta_Omega);
  read_joint_list(map, "joint_velocity_jump", robot.n(), impact.Delta_phidot);
  read_joint_list(map, "joint_velocity_rns", robot.n(), impact.Delta_phidot_rns);
  read_joint_list(map, "joint_velocity_orthogonal", robot.n(), impact.Delta_phidot_orthogonal);
  if (const Node* momentum = map.child("momentum", Need::Required)) {
    MapReader fields(context, *momentum, map.path_of("momentum"));
    fields.vector3("total", impact.total, Dimension::None, Need::Required);
    fields.vector3("base", impact.base, Dimension::None, Need::Required);
    fields.vector3("coupling", impact.coupling, Dimension::None, Need::Required);
    fields.finish();
  }
  CaseJudgement& judgement = impact.judgement;
  map.choice("case", judgement.impact_case, impact_case_names(), Need::Required);
  map.number("case_tolerance", judgement.tolerance, Dimension::None, kNonNegative, Need::Required);
  if (const Node* residuals = map.child("case_residuals", Need::Required)) {
    MapReader fields(context, *residuals, map.path_of("case_residuals"));
    fields.number("total", judgement.total, Dimension::None, kNonNegative, Need::Required);
    fields.number("base", judgement.base, Dimension::None, kNonNegative, Need::Required);
    fields.number("coupling", judgement.coupling, Dimension::None, kNonNegative, Need::Required);
    fields.finish();
  }
  map.number("rank_tolerance", impact.rank_tolerance, Dimension::None, kNonNegative,
             Need::Required);
  map.integer("rank", impact.rank, 0, kMaxJoints, Need::Required);
  map.number("closing_speed", impact.closing_speed, Dimension::None, kAny, Need::Required);
  map.choice("joint_resistance", impact.resistance.model, resistance_names(), Need::Required);
  if (const Node* values = map.child("joint_resistance_values", Need::Required)) {
    MapReader fields(context, *values, map.path_of("joint_resistance_values"));
    read_resistance_values(fields, robot, impact.resistance);
    fields.finish();
  }
  map.finish();
  return impact;
}

}  // namespace stillbase::io
