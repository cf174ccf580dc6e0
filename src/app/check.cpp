// stillbase check: validates files and says what was understood.
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include <stillbase/capture/formulation.hpp>
#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/dynamics/reaction_null_space.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>

#include "app/commands.hpp"
#include "app/exit_code.hpp"
#include "app/load.hpp"
#include "app/output.hpp"
#include "app/words.hpp"

namespace stillbase::app {

namespace {

struct Options {
  std::vector<std::string> files;
  std::string hand;
};

std::string body_line(const Body& body) {
  const Vector3d principal =
      Eigen::SelfAdjointEigenSolver<Matrix3d>(body.inertia, Eigen::EigenvaluesOnly).eigenvalues();
  std::string text =
      fmt::format("  {}: {:.6g} kg, centroid {} m, principal moments {} kg m^2", body.name,
                  body.mass, vector_words(body.centroid), vector_words(principal));
  std::vector<std::string> merged = body.merged_links;
  merged.erase(std::remove(merged.begin(), merged.end(), body.name), merged.end());
  if (!merged.empty()) text += fmt::format(", with {}", fmt::join(merged, ", "));
  return text + '\n';
}

std::string joint_line(const Joint& joint) {
  const char* const unit = joint.is_prismatic() ? "m" : "deg";
  const double scale = joint.is_prismatic() ? 1 : kDegrees;
  std::string text = fmt::format("  {}: ", joint.name);
  if (joint.type == JointType::Continuous) {
    text += "continuous";
  } else {
    text +=
        fmt::format("{} from {:.6g} to {:.6g} {}", joint.is_prismatic() ? "prismatic" : "revolute",
                    joint.lower * scale, joint.upper * scale, unit);
  }
  if (std::isfinite(joint.max_velocity)) {
    text += fmt::format(", at most {:.6g} {}/s", joint.max_velocity * scale, unit);
  }
  if (std::isfinite(joint.max_effort)) {
    text += fmt::format(", {:.6g} {}", joint.max_effort, joint.is_prismatic() ? "N" : "N m");
  }
  return text + '\n';
}

JointVectord random_posture(const RobotModel& robot, Random& random) {
  JointVectord phi(robot.n());
  for (int k = 0; k < robot.n(); ++k) {
    const Joint& joint = robot.joints[static_cast<std::size_t>(k)];
    const bool is_bounded = std::isfinite(joint.lower) && std::isfinite(joint.upper);
    phi[k] = is_bounded ? random.uniform(joint.lower, joint.upper) : random.uniform(-M_PI, M_PI);
  }
  return phi;
}

/// How many directions of base angular momentum the joints can take over, at random postures.
std::string coupling_line(const RobotModel& robot) {
  constexpr int kPostures = 16;
  Random random(1);
  std::map<int, int> ranks;
  for (int i = 0; i < kPostures; ++i) {
    const auto kinematics = compute_kinematics<double>(robot, random_posture(robot, random));
    const auto tilde = compute_tilde_inertia<double>(compute_inertia<double>(robot, kinematics));
    ++ranks[angular_reaction_null_space(tilde).rank];
  }
  std::string text;
  for (const auto& [rank, count] : ranks) {
    if (!text.empty()) text += ", ";
    text += fmt::format("{} in {}", rank, count);
  }
  return fmt::format("angular coupling: rank {} of {} random postures\n", text, kPostures);
}

std::string robot_report(const RobotModel& robot) {
  const JointVectord zero = JointVectord::Zero(robot.n());
  const auto inertia = compute_inertia<double>(robot, compute_kinematics<double>(robot, zero));
  std::string text =
      fmt::format("robot {}: {}, {}, {:.6g} kg\n", robot.name,
                  count_words(robot.n() + 1, "body", "bodies after merging fixed links"),
                  count_words(robot.n(), "joint", "joints"), robot.total_mass());
  text += fmt::format("system centroid with all joints at zero: {} m from the base centroid\n",
                      vector_words(inertia.r_bg));
  text += "bodies:\n" + body_line(robot.base);
  for (const Body& body : robot.bodies) text += body_line(body);
  text += "joints:\n";
  for (const Joint& joint : robot.joints) text += joint_line(joint);
  text += fmt::format("hand: {}; collision shapes: {}\n", robot.hand, robot.shapes.size());
  if (robot.n() > 0) text += coupling_line(robot);
  return text;
}

/// In words; empty for problems that are there to be analysed and simulated only.
std::vector<std::string> free_variables(const CaptureProblem& problem) {
  std::vector<std::string> free;
  for (int k = 0; k < problem.robot.n(); ++k) {
    const auto i = static_cast<std::size_t>(k);
    if (problem.variables.joints[i]) free.push_back(problem.robot.joints[i].name);
  }
  const VariableSpec& spec = problem.variables;
  if (spec.base_attitude == AttitudeFreedom::Axis) free.push_back("base attitude about one axis");
  if (spec.base_attitude == AttitudeFreedom::Free) free.push_back("base attitude");
  if (spec.contact_time_lower < spec.contact_time_upper) {
    free.push_back(fmt::format("contact time from {:.6g} to {:.6g} s", spec.contact_time_lower,
                               spec.contact_time_upper));
  }
  return free;
}

std::string problem_report(const CaptureProblem& problem) {
  std::string text = fmt::format("problem {}: {}\n", problem.name, problem.purpose);
  text += fmt::format("start: {}\nbase: {}\n", posture_words(problem.robot, problem.start),
                      pose_words(problem.base));
  if (problem.target) {
    text += fmt::format("target {}: {:.6g} kg{}\n", problem.target->name, problem.target->mass,
                        problem.target->is_point_mass ? ", a point mass" : "");
  }
  text += fmt::format("joints during the impact: {}\n", to_string(problem.resistance.model));
  text += fmt::format("objective: {}\n", objective_name(problem));
  if (problem.measure.kind == RiskMeasure::WorstCase) {
    text += fmt::format("measure: the worst direction within {:.6g} deg\n",
                        problem.uncertainty.cone_half_angle * 180 / 3.14159265358979323846);
  } else if (problem.measure.kind != RiskMeasure::Nominal) {
    const bool tail = problem.measure.kind == RiskMeasure::Cvar;
    text += fmt::format(
        "measure: root mean square over {}{} samples\n",
        tail ? fmt::format("the worst {:.4g} % of ", 100 * (1 - problem.measure.cvar_level)) : "",
        problem.measure.samples);
  }
  const std::vector<std::string> free = free_variables(problem);
  if (free.empty()) {
    text += "free: nothing, so there is nothing to plan\n";
  } else {
    const Formulation formulation(problem);
    text += fmt::format("free: {}\n", fmt::join(free, ", "));
    text += fmt::format(
        "{}, {}: {} left free\n", count_words(formulation.num_variables(), "variable", "variables"),
        count_words(formulation.num_equations(), "independent equation", "independent equations"),
        formulation.freedom());
  }
  return text + robot_report(problem.robot);
}

std::string plan_report(const PlanFile& file) {
  const Plan& plan = file.plan;
  const auto fingerprint = [](const std::string& stated, const std::string& computed) {
    return stated == computed ? "as stated" : "not as stated: the file was changed";
  };
  std::string text =
      fmt::format("plan for {}: {}, {}, approach {}\n", plan.problem.name, to_string(plan.status),
                  count_words(static_cast<long>(plan.candidates.size()), "candidate", "candidates"),
                  to_string(plan.approach.status));
  text += fmt::format("fingerprint of the content: {}; of the robot: {}\n",
                      fingerprint(file.stated_sha256, file.computed_sha256),
                      fingerprint(file.stated_robot_sha256, file.computed_robot_sha256));
  return text + problem_report(plan.problem);
}

std::string report_on(const std::string& path, const std::string& hand) {
  const std::string extension = extension_of(path);
  if (extension == ".urdf" || extension == ".xml") return robot_report(load_robot(path, hand));
  if (extension == ".yaml" || extension == ".yml") return problem_report(read_problem(path));
  if (extension == ".json") return plan_report(read_plan(read_text_file(path), path));
  throw CommandLineError(path + ": a robot ends in .urdf, a problem in .yaml, a plan in .json");
}

/// Every file is looked at, whatever is wrong with the ones before it.
int run(const Options& options) {
  int code = kDone;
  for (const std::string& file : options.files) {
    try {
      write_stdout(fmt::format("{}: ok\n{}\n", file, report_on(file, options.hand)));
    } catch (const InputError& error) {
      say(error.what());
      code = kInputRefused;
    }
  }
  return code;
}

}  // namespace

void add_check(CLI::App& app, Action& action) {
  auto options = std::make_shared<Options>();
  CLI::App* command = app.add_subcommand(
      "check", "validate robot, problem or plan files and print what was understood");
  command->add_option("files", options->files, "robots (.urdf), problems (.yaml), plans (.json)")
      ->type_name("FILE...")
      ->required();
  command->add_option("--hand", options->hand, "hand link of the robots that have several ends")
      ->type_name("LINK");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace stillbase::app
