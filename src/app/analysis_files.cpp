// The analysis for programs: JSON and CSV.
#include <fmt/format.h>

#include "app/analysis.hpp"
#include "io/json.hpp"
#include "io/json_impact.hpp"

namespace stillbase::app {

namespace {

using io::array_json;
using io::Json;

/// A list of directions (columns).
Json directions_json(const Directions& directions) {
  Json list = Json::array();
  for (Eigen::Index i = 0; i < directions.cols(); ++i) {
    list.push_back(array_json(directions.col(i)));
  }
  return list;
}

Json zero_json(const ZeroDirections& zero) {
  return {{"directions", directions_json(zero.directions)},
          {"rank", zero.rank},
          {"singular_values", array_json(zero.singular_values)}};
}

Json cases_json(const CaseDirections& cases) {
  return {{"tolerance", cases.tolerance},
          {"base", zero_json(cases.base)},
          {"coupling", zero_json(cases.coupling)},
          {"total", zero_json(cases.total)},
          {"all", zero_json(cases.all)}};
}

Json favourable_json(const FavourableDirections& favourable) {
  return {{"directions", directions_json(favourable.directions)},
          {"base_reaction", array_json(favourable.base_reaction)}};
}

Json posture_json(const PostureIndices& posture) {
  return {{"zero_directions",
           {{"in_xy_plane", cases_json(posture.zero_in_plane)},
            {"in_space", cases_json(posture.zero_in_space)}}},
          {"favourable_directions",
           {{"in_xy_plane", favourable_json(posture.favourable_in_plane)},
            {"in_space", favourable_json(posture.favourable_in_space)}}},
          {"impulse_ellipsoid",
           {{"axes", directions_json(posture.impulse.axes)},
            {"lengths", array_json(posture.impulse.lengths)}}},
          {"base_reaction_ellipsoid",
           {{"axes", directions_json(posture.reaction.ellipsoid.axes)},
            {"lengths", array_json(posture.reaction.ellipsoid.lengths)},
            {"causes", directions_json(posture.reaction.causes)},
            {"rank", posture.reaction.rank},
            {"rank_tolerance", posture.reaction.rank_tolerance}}},
          {"generalized_jacobian",
           {{"singular_values", array_json(posture.jacobian.all)},
            {"linear", array_json(posture.jacobian.linear)},
            {"angular", array_json(posture.jacobian.angular)},
            {"linear_manipulability", posture.jacobian.linear_manipulability},
            {"angular_manipulability", posture.jacobian.angular_manipulability}}},
          {"dynamic_coupling",
           {{"rotation_per_rate", array_json(posture.coupling.rotation_per_rate)},
            {"translation_per_rate", array_json(posture.coupling.translation_per_rate)},
            {"rotation_per_hand", array_json(posture.coupling.rotation_per_hand)},
            {"hand_rank", posture.coupling.hand_rank}}}};
}

void add_columns(std::string& text, const Eigen::Ref<const Eigen::VectorXd>& values) {
  for (const double x : values) text += fmt::format(",{}", x);
}

}  // namespace

std::string analysis_json(const Analysis& analysis) {
  Json rows = Json::array();
  for (const AnalysisRow& row : analysis.rows) {
    Json json = {{"direction_deg", row.direction_deg}};
    json.update(io::impact_json(row.impact, analysis.robot));
    rows.push_back(std::move(json));
  }
  Json resistances = Json::array();
  for (const AnalysisComparison& entry : analysis.resistances) {
    Json json = {{"illustrative", entry.is_illustrative}};
    json.update(io::impact_json(entry.impact, analysis.robot));
    resistances.push_back(std::move(json));
  }
  return io::pretty({{"format", "stillbase.analysis"},
                     {"version", 1},
                     {"rows", rows},
                     {"joint_resistances", resistances},
                     {"posture", posture_json(analysis.posture)}});
}

std::string analysis_csv(const Analysis& analysis) {
  std::string text = "direction_deg,impulse_Ns,closing_speed_m_s,case";
  for (const char* name : {"total", "base", "coupling"}) {
    for (const char* axis : {"x", "y", "z"}) text += fmt::format(",{}_{}_Nms", name, axis);
  }
  for (const char* axis : {"x", "y", "z"}) text += fmt::format(",omega_{}_rad_s", axis);
  for (const char* part : {"jump", "rns", "orthogonal"}) {
    for (const Joint& joint : analysis.robot.joints) {
      text += fmt::format(",{}_{}_{}", joint.name, part, joint.is_prismatic() ? "m_s" : "rad_s");
    }
  }
  text += '\n';
  for (const AnalysisRow& row : analysis.rows) {
    const ImpactSummary& impact = row.impact;
    text += fmt::format("{},{},{},{}", row.direction_deg, impact.Fbar.head<3>().norm(),
                        impact.closing_speed, to_string(impact.judgement.impact_case));
    for (const Vector3d& v : {impact.total, impact.base, impact.coupling}) add_columns(text, v);
    add_columns(text, impact.Delta_Omega.tail<3>());
    add_columns(text, impact.Delta_phidot);
    add_columns(text, impact.Delta_phidot_rns);
    add_columns(text, impact.Delta_phidot_orthogonal);
    text += '\n';
  }
  return text;
}

}  // namespace stillbase::app
