// stillbase analyze: the impact in the start posture, in the stated direction or in many, with the
// joints resisting in different ways, and the directions that leave the base alone.
#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/encounter/encounter.hpp>
#include <stillbase/impact/compare_resistances.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/report/plot.hpp>

#include "app/command_line.hpp"
#include "app/words.hpp"
#include "core/escape.hpp"
#include "io/fields/results.hpp"

namespace stillbase::app {

namespace {

using io::Analysis;
using io::AnalysisComparison;
using io::AnalysisRow;
using io::PostureIndices;

/// Azimuth of a direction, from x towards y, in [0, 360) deg.
double angle_deg(const Vector3d& direction) {
  const double angle = std::atan2(direction.y(), direction.x()) * 180 / kPi;
  return angle < 0 ? angle + 360 : angle;
}

/// Angle of a direction with the xy plane, deg.
double elevation_deg(const Vector3d& direction) {
  return std::atan2(direction.z(), direction.head<2>().norm()) * kDegrees;
}

std::vector<AnalysisRow> sweep(CaptureProblem problem, int directions) {
  if (directions == 0) {
    const ImpactSummary impact = impact_at(problem, start_configuration(problem));
    return {{angle_deg(impact.Fbar.head<3>()), impact}};
  }
  if (!problem.impulse.direction) {
    throw CommandLineError(
        "--sweep-direction: the direction of this problem's impulse follows from the target's "
        "motion; a sweep needs a problem that states impact.direction and closing_speed");
  }
  std::vector<AnalysisRow> rows;
  problem.impulse.direction_frame = Frame::Base;
  for (int i = 0; i < directions && signal_exit_code() == 0; ++i) {
    const double degrees = 360.0 * i / directions;
    const double angle = degrees * kPi / 180;
    problem.impulse.direction = Vector3d(std::cos(angle), std::sin(angle), 0);
    rows.push_back({degrees, impact_at(problem, start_configuration(problem))});
  }
  return rows;
}

std::vector<AnalysisComparison> compare(CaptureProblem problem) {
  std::vector<AnalysisComparison> out;
  for (const ComparedResistance& entry :
       resistances_to_compare(problem.robot, problem.start, problem.resistance)) {
    problem.resistance = entry.resistance;
    out.push_back({entry.is_illustrative, impact_at(problem, start_configuration(problem))});
  }
  return out;
}

PostureIndices posture_indices(const CaptureProblem& problem) {
  const auto posture = evaluate_posture<double>(
      problem.robot, prepare_resistance(problem.resistance, problem.robot.n()), problem.start);
  const Matrix6d W_h = extended_inverse_inertia(posture.factor, posture.jacobian);
  PostureIndices out;
  out.impulse = impulse_ellipsoid(W_h, Matrix3d::Zero());
  out.reaction = base_reaction_ellipsoid(posture);
  out.favourable_in_plane = favourable_directions(posture, directions_in_xy_plane());
  out.favourable_in_space = favourable_directions(posture, all_directions());
  out.zero_in_plane = case_directions(posture, directions_in_xy_plane());
  out.zero_in_space = case_directions(posture, all_directions());
  out.jacobian = generalized_jacobian_indices(posture);
  out.coupling = dynamic_coupling(posture);
  return out;
}

Analysis analyse(const CaptureProblem& problem, int directions) {
  return {problem.name, problem.robot, sweep(problem, directions), compare(problem),
          posture_indices(problem)};
}

std::string analysis_json(Analysis analysis) {
  return io::pretty(io::written([&](io::Table& t) { io::analysis_fields(t, analysis); }));
}

void add_columns(std::string& text, const Eigen::Ref<const Eigen::VectorXd>& values) {
  for (const double x : values) text += fmt::format(",{}", x);
}

std::string analysis_csv(const Analysis& analysis) {
  std::string text = "direction_deg,impulse_Ns,closing_speed_m_s,case";
  for (const char* name : {"total", "base", "coupling"}) {
    for (const char* axis : {"x", "y", "z"}) text += fmt::format(",{}_{}_Nms", name, axis);
  }
  for (const char* axis : {"x", "y", "z"}) text += fmt::format(",omega_{}_rad_s", axis);
  for (const char* part : {"jump", "rns", "orthogonal"}) {
    for (const Joint& joint : analysis.robot.joints) {
      const char* const unit = joint.is_prismatic() ? "m_s" : "rad_s";
      text += ',' + csv_field(fmt::format("{}_{}_{}", joint.name, part, unit));
    }
  }
  text += ",elevation_deg\n";
  for (const AnalysisRow& row : analysis.rows) {
    const ImpactSummary& impact = row.impact;
    text += fmt::format("{},{},{},{}", row.direction_deg, impact.Fbar.head<3>().norm(),
                        impact.closing_speed, to_string(impact.judgement.impact_case));
    for (const Vector3d& v : {impact.total, impact.base, impact.coupling}) add_columns(text, v);
    add_columns(text, impact.Omega_after().tail<3>());
    add_columns(text, impact.Delta_phidot);
    add_columns(text, impact.Delta_phidot_rns);
    add_columns(text, impact.Delta_phidot_orthogonal);
    text += fmt::format(",{}\n", elevation_deg(impact.Fbar.head<3>()));
  }
  return text;
}

/// Momenta and rates are those after the impact. Of a robot at rest before it they are the jump.
constexpr const char* kImpactHead = "{:>14} {:>5} {:>14} {:>14} {:>14} {:>14} {:>14}\n";

std::string impact_head() {
  return fmt::format(kImpactHead, "impulse", "case", "|total|", "|base|", "|coupling|",
                     "|base rate|", "|joint rate|");
}

std::string impact_units() {
  return fmt::format(kImpactHead, "N s", "", "N m s", "N m s", "N m s", "rad/s", "rad/s");
}

std::string impact_numbers(const ImpactSummary& impact) {
  const auto size = [](double x) { return size_words(x, 5); };
  return fmt::format(kImpactHead, size_words(impact.Fbar.head<3>().norm(), 4),
                     to_string(impact.judgement.impact_case), size(impact.total.norm()),
                     size(impact.base.norm()), size(impact.coupling.norm()),
                     size(impact.Omega_after().tail<3>().norm()),
                     size(impact.phidot_after().norm()));
}

/// Of a line in the xy plane, in [0, 180) deg.
double line_angle_deg(const Vector3d& direction) {
  const double angle = std::atan2(direction.y(), direction.x()) * kDegrees;
  const double line = angle < 0 ? angle + 180 : angle;
  return line < 180 ? line : 0;
}

std::string zero_words(const ZeroDirections& plane, const ZeroDirections& space) {
  std::string in_plane = "none", in_space = "none";
  if (plane.directions.cols() == 1) {
    in_plane = fmt::format("{:.2f} deg", line_angle_deg(plane.directions.col(0)));
  }
  if (plane.directions.cols() == 2) in_plane = "all";
  if (space.directions.cols() == 1) in_space = "along " + vector_words(space.directions.col(0));
  if (space.directions.cols() == 2) {
    const Vector3d normal =
        Vector3d(space.directions.col(0)).cross(Vector3d(space.directions.col(1)));
    in_space = "normal to " + vector_words(normal);
  }
  if (space.directions.cols() == 3) in_space = "all";
  return fmt::format("{:<18} {}\n", in_plane, in_space);
}

std::string direction_words(const PostureIndices& posture) {
  const auto &plane = posture.zero_in_plane, &space = posture.zero_in_space;
  std::string text = fmt::format("\n{:<28} {:<18} {}\n", "impulse directions", "in the xy plane",
                                 "in space (base frame)");
  const auto line = [&](const char* name, const ZeroDirections& a, const ZeroDirections& b) {
    text += fmt::format("{:<28} {}", name, zero_words(a, b));
  };
  line("zero base part (G2)", plane.base, space.base);
  line("zero coupling part (G3)", plane.coupling, space.coupling);
  line("zero total (C1)", plane.total, space.total);
  line("all three zero (C2)", plane.all, space.all);
  const auto &in_plane = posture.favourable_in_plane, &in_space = posture.favourable_in_space;
  text += fmt::format("{:<28} {:<18} along {}\n", "least base rate per impulse",
                      fmt::format("{:.2f} deg", line_angle_deg(in_plane.directions.col(0))),
                      vector_words(in_space.directions.col(0)));
  text += fmt::format("{:<28} {:<18} {} rad/s per N s\n", "  that is",
                      size_words(in_plane.base_reaction[0], 4),
                      size_words(in_space.base_reaction[0], 4));
  return text;
}

void add_marks(PlotPanel& panel, const ZeroDirections& zero, const std::string& name) {
  if (zero.directions.cols() != 1) return;
  const double line = line_angle_deg(zero.directions.col(0));
  for (const double x : {line, line + 180}) {
    if (x <= panel.x.back()) panel.marks.push_back({x, name});
  }
}

/// The impulse as a vector, where one angle in the xy plane does not say it; else empty.
std::string impulse_words(const AnalysisRow& row) {
  constexpr double kInPlane = 1e-9;    // rad
  constexpr double kNoImpulse = 1e-9;  // N s
  const Vector3d force = row.impact.Fbar.head<3>(), moment = row.impact.Fbar.tail<3>();
  const double size = force.norm();
  const double elevation = elevation_deg(force);
  if (row.impact.before && row.impact.Fbar.norm() < kNoImpulse) {
    return "no impulse: hand and target have no relative velocity\n\n";
  }
  if (!(size > 0) || std::abs(elevation) < kInPlane * kDegrees) return "";
  std::string text = fmt::format(
      "impulse along {} in the base frame: azimuth {:.2f} deg (the direction below), "
      "elevation {:.2f} deg\n",
      vector_words(force / size), row.direction_deg, elevation);
  if (!moment.isZero(0)) text += fmt::format("with a moment of {} N m s\n", vector_words(moment));
  return text + '\n';
}

std::string analysis_words(const Analysis& analysis) {
  // A sweep stays in the plane.
  std::string text = analysis.rows.size() == 1 ? impulse_words(analysis.rows.front()) : "";
  if (analysis.rows.front().impact.before) {
    text += "the robot moves before the impact; momenta and rates are those right after it\n\n";
  }
  text += fmt::format("{:>9} {}", "direction", impact_head());
  text += fmt::format("{:>9} {}", "deg", impact_units());
  for (const AnalysisRow& row : analysis.rows) {
    text += fmt::format("{:>9.2f} {}", row.direction_deg, impact_numbers(row.impact));
  }
  text += fmt::format("\n{:<15} {}{:<15} {}", "joints", impact_head(), "(stated impulse)",
                      impact_units().substr(1));
  bool is_any_illustrative = false;
  for (const AnalysisComparison& entry : analysis.resistances) {
    is_any_illustrative = is_any_illustrative || entry.is_illustrative;
    const std::string name =
        to_string(entry.impact.resistance.model) + (entry.is_illustrative ? " *" : "");
    text += fmt::format("{:<15} {}", name, impact_numbers(entry.impact));
  }
  if (is_any_illustrative) {
    text +=
        "* values not of the problem but on the scale of each joint's own inertia: a rotor of the "
        "same\n  inertia; a servo of 10 Hz, critically damped, over a contact of 10 ms (--json has "
        "them)\n";
  }
  return text + direction_words(analysis.posture);
}

/// Two panels over the direction, as Figs. 4 and 5 of the paper: the three momenta with their zero
/// line and marks at the zero directions; the norm of the joint rates with its two parts. Momenta
/// about z where all of them are (planar robots), else their norms.
std::string analysis_svg(const Analysis& analysis) {
  if (analysis.rows.size() < 2) {
    throw CommandLineError(
        "the plot is over the direction: give --sweep-direction N, N at least 2");
  }
  double along_z = 0, across = 0;
  for (const AnalysisRow& row : analysis.rows) {
    for (const Vector3d& v : {row.impact.total, row.impact.base, row.impact.coupling}) {
      along_z = std::max(along_z, std::abs(v.z()));
      across = std::max(across, v.head<2>().norm());
    }
  }
  const bool is_planar = across <= 1e-9 * along_z;
  PlotPanel momenta, rates;
  momenta.title =
      (is_planar ? "Change of angular momentum about z: " : "Change of angular momentum, norms: ") +
      analysis.problem;
  momenta.y_label = "N m s";
  rates.title = "Joint rates after the impact";
  rates.y_label = "rad/s";
  momenta.x_label = rates.x_label = "direction of the impulse [deg]";
  momenta.series = {{"total", {}}, {"base part", {}}, {"coupling part", {}}};
  rates.series = {{"norm", {}}, {"null-space part", {}}, {"orthogonal part", {}}};
  const auto value = [&](const Vector3d& v) { return is_planar ? v.z() : v.norm(); };
  std::vector<AnalysisRow> rows = analysis.rows;
  rows.push_back({360, rows.front().impact});  // 360 deg is 0 deg: the curves close
  for (const AnalysisRow& row : rows) {
    const ImpactSummary& impact = row.impact;
    momenta.x.push_back(row.direction_deg);
    momenta.series[0].y.push_back(value(impact.total));
    momenta.series[1].y.push_back(value(impact.base));
    momenta.series[2].y.push_back(value(impact.coupling));
    rates.series[0].y.push_back(impact.Delta_phidot.norm());
    rates.series[1].y.push_back(impact.Delta_phidot_rns.norm());
    rates.series[2].y.push_back(impact.Delta_phidot_orthogonal.norm());
  }
  rates.x = momenta.x;
  const CaseDirections& zero = analysis.posture.zero_in_plane;
  if (zero.all.directions.cols() == 1) {
    add_marks(momenta, zero.all, "C2");
  } else {
    add_marks(momenta, zero.base, "G2");
    add_marks(momenta, zero.coupling, "G3");
    add_marks(momenta, zero.total, "C1");
  }
  return plot_svg({momenta, rates});
}

struct AnalyzeRequest {
  std::string problem;
  int directions = 0;
  OutputFile output;
  bool json = false;
};

int analyze_impact(const AnalyzeRequest& request) {
  request.output.check({".json", ".csv", ".svg"});
  const std::string extension = extension_of(request.output.path);
  const Analysis analysis = analyse(read_problem(request.problem), request.directions);
  // A stopped sweep is saved as far as it came, but a plot of a part of the circle misleads.
  if (signal_exit_code() != 0 && extension == ".svg") return signal_exit_code();
  if (extension == ".csv") request.output.write(analysis_csv(analysis));
  if (extension == ".json") request.output.write(analysis_json(analysis));
  if (extension == ".svg") request.output.write(analysis_svg(analysis));
  if (request.json) {
    write_stdout(analysis_json(analysis));
  } else if (!request.output.is_given()) {
    write_stdout(analysis_words(analysis));
  }
  return signal_exit_code() != 0 ? signal_exit_code() : kDone;
}

}  // namespace

Command analyze_command() {
  auto request = std::make_shared<AnalyzeRequest>();
  return {"analyze",
          "what the impact does in the start posture, also over all directions in a plane",
          std::vector<Option>{
              {"problem", "PROBLEM.yaml", "problem file (YAML)", &request->problem, true},
              {"--sweep-direction", "N",
               "N directions of the impulse, evenly around the base's z axis from x",
               &request->directions, false, 1, 1'000'000},
              {"--json", "", "print one JSON object", &request->json}} +
              output_options(request->output, "-o,--output",
                             "result as .json, .csv or .svg (plot of the sweep); else tables"),
          [request] { return analyze_impact(*request); }};
}

}  // namespace stillbase::app
