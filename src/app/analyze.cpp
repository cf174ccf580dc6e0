// stillbase analyze: the impact in the start posture, in the stated direction or in many.
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <stillbase/io/problem_file.hpp>
#include <stillbase/report/plot.hpp>

#include "app/commands.hpp"
#include "app/exit_code.hpp"
#include "app/load.hpp"
#include "app/output.hpp"
#include "app/start_impact.hpp"
#include "io/json.hpp"
#include "io/json_impact.hpp"

namespace stillbase::app {

namespace {

using io::Json;

struct Options {
  std::string problem;
  int directions = 0;
  OutputFile output;
  bool json = false;
};

struct Row {
  double direction_deg = 0;  ///< in the plane x y of B, from x about z
  ImpactSummary impact;
};

double angle_deg(const Vector3d& direction) {
  const double angle = std::atan2(direction.y(), direction.x()) * 180 / M_PI;
  return angle < 0 ? angle + 360 : angle;
}

std::vector<Row> analyse(CaptureProblem problem, int directions) {
  if (directions == 0) {
    const ImpactSummary impact = start_impact(problem);
    return {{angle_deg(impact.Fbar.head<3>()), impact}};
  }
  if (!problem.impulse.direction) {
    throw CommandLineError(
        "--sweep-direction: the direction of this problem's impulse follows from the target's "
        "motion; a sweep needs a problem that states impact.direction and closing_speed");
  }
  std::vector<Row> rows;
  problem.impulse.direction_frame = Frame::Base;
  for (int i = 0; i < directions; ++i) {
    const double degrees = 360.0 * i / directions;
    const double angle = degrees * M_PI / 180;
    problem.impulse.direction = Vector3d(std::cos(angle), std::sin(angle), 0);
    rows.push_back({degrees, start_impact(problem)});
  }
  return rows;
}

std::string json_text(const CaptureProblem& problem, const std::vector<Row>& rows) {
  Json list = Json::array();
  for (const Row& row : rows) {
    Json json = {{"direction_deg", io::number_json(row.direction_deg)}};
    json.update(io::impact_json(row.impact, problem.robot));
    list.push_back(std::move(json));
  }
  return io::pretty({{"format", "stillbase.analysis"}, {"version", 1}, {"rows", list}});
}

void add_columns(std::string& text, const Eigen::Ref<const Eigen::VectorXd>& values) {
  for (const double x : values) text += fmt::format(",{}", x);
}

std::string csv_text(const CaptureProblem& problem, const std::vector<Row>& rows) {
  std::string text = "direction_deg,impulse_Ns,closing_speed_m_s,case";
  for (const char* name : {"total", "base", "coupling"}) {
    for (const char* axis : {"x", "y", "z"}) text += fmt::format(",{}_{}_Nms", name, axis);
  }
  for (const char* axis : {"x", "y", "z"}) text += fmt::format(",omega_{}_rad_s", axis);
  for (const char* part : {"jump", "rns", "orthogonal"}) {
    for (const Joint& joint : problem.robot.joints) {
      text += fmt::format(",{}_{}_{}", joint.name, part, joint.is_prismatic() ? "m_s" : "rad_s");
    }
  }
  text += '\n';
  for (const Row& row : rows) {
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

std::string table_text(const std::vector<Row>& rows) {
  std::string text =
      fmt::format("{:>9} {:>10} {:>5} {:>11} {:>11} {:>11} {:>12} {:>12}\n", "direction", "impulse",
                  "case", "|total|", "|base|", "|coupling|", "|base rate|", "|joint rate|");
  text += fmt::format("{:>9} {:>10} {:>5} {:>11} {:>11} {:>11} {:>12} {:>12}\n", "deg", "N s", "",
                      "N m s", "N m s", "N m s", "rad/s", "rad/s");
  for (const Row& row : rows) {
    const ImpactSummary& impact = row.impact;
    text += fmt::format(
        "{:>9.2f} {:>10.4g} {:>5} {:>11.4e} {:>11.4e} {:>11.4e} {:>12.4e} {:>12.4e}\n",
        row.direction_deg, impact.Fbar.head<3>().norm(), to_string(impact.judgement.impact_case),
        impact.total.norm(), impact.base.norm(), impact.coupling.norm(),
        impact.Delta_Omega.tail<3>().norm(), impact.Delta_phidot.norm());
  }
  return text;
}

/// Where a curve over the rows crosses zero, by linear interpolation.
void add_zero_marks(const std::vector<double>& x, const std::vector<double>& y,
                    const std::string& label, std::vector<PlotMark>& marks) {
  for (std::size_t i = 0; i + 1 < x.size(); ++i) {
    if ((y[i] < 0) == (y[i + 1] < 0)) continue;
    marks.push_back({x[i] + (x[i + 1] - x[i]) * y[i] / (y[i] - y[i + 1]), label});
  }
}

/// The paper's Figs. 4 and 5: momenta about z, and joint rates, over the direction of the impulse.
std::string svg_text(const CaptureProblem& problem, std::vector<Row> rows) {
  // Close the circle, so that the curves end where they begin.
  rows.push_back(rows.front());
  rows.back().direction_deg = 360;
  PlotPanel momenta{"Change of angular momentum about z: " + problem.name,
                    "direction of the impulse [deg]",
                    "N m s",
                    {},
                    {{"total", {}}, {"base part", {}}, {"coupling part", {}}},
                    {}};
  PlotPanel rates{"Joint rates after the impact",
                  "direction of the impulse [deg]",
                  "rad/s",
                  {},
                  {{"norm", {}}, {"null-space part", {}}, {"orthogonal part", {}}},
                  {}};
  for (const Row& row : rows) {
    const ImpactSummary& impact = row.impact;
    momenta.x.push_back(row.direction_deg);
    momenta.series[0].y.push_back(impact.total.z());
    momenta.series[1].y.push_back(impact.base.z());
    momenta.series[2].y.push_back(impact.coupling.z());
    rates.series[0].y.push_back(impact.Delta_phidot.norm());
    rates.series[1].y.push_back(impact.Delta_phidot_rns.norm());
    rates.series[2].y.push_back(impact.Delta_phidot_orthogonal.norm());
  }
  rates.x = momenta.x;
  const char* labels[] = {"C", "G2", "G3"};
  for (std::size_t i = 0; i < 3; ++i) {
    add_zero_marks(momenta.x, momenta.series[i].y, labels[i], momenta.marks);
  }
  return plot_svg({momenta, rates});
}

int run(const Options& options) {
  options.output.check();
  const std::string extension = extension_of(options.output.path);
  if (options.output.is_given() && extension != ".json" && extension != ".csv" &&
      extension != ".svg") {
    throw CommandLineError(options.output.path + ": the result is written as .json, .csv or .svg");
  }
  if (extension == ".svg" && options.directions < 2) {
    throw CommandLineError("a plot needs --sweep-direction with at least 2 directions");
  }
  const CaptureProblem problem = read_problem(options.problem);
  const std::vector<Row> rows = analyse(problem, options.directions);
  if (extension == ".csv") options.output.write(csv_text(problem, rows));
  if (extension == ".svg") options.output.write(svg_text(problem, rows));
  if (extension == ".json") options.output.write(json_text(problem, rows));
  if (options.json) {
    write_stdout(json_text(problem, rows));
  } else if (!options.output.is_given()) {
    write_stdout(table_text(rows));
  }
  return kDone;
}

}  // namespace

void add_analyze(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "analyze", "what the impact does in the start posture, also over all directions in a plane");
  command->add_option("problem", options->problem, "problem file (YAML)")
      ->type_name("PROBLEM.yaml")
      ->required();
  command
      ->add_option("--sweep-direction", options->directions,
                   "N directions of the impulse, evenly around the base's z axis from x")
      ->type_name("N")
      ->check(CLI::Range(1, 1'000'000));
  add_output(*command, options->output, "-o,--output",
             "result as .json, .csv or a plot as .svg; else a table");
  command->add_flag("--json", options->json, "print one JSON object");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace stillbase::app
