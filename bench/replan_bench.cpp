// How long an update of a replanner takes: noisy estimates of the target of a plan, one by one.
//
//   replan_bench [--updates N] [--noise SIZE] [--covariance] [--deadline MS] [problem.yaml ...]
//
// Default: 10 000 updates of problems/iiwa_client_50.yaml. Each estimate is the target's nominal
// motion at a time that runs from the problem's estimate to 20 s before the earliest contact, with
// independent Gaussian errors of SIZE times 0.02 m, 0.01 rad, 2e-4 m/s and 2e-4 rad/s per axis.
// Prints median, 99 % and worst latency, the worst processor time of one update (what a busy
// machine does not lengthen), the number of steps, and how many were cut, feasible and optimal.
// Without --deadline none is given; with --covariance the contact's deviations are predicted as
// well.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <string>
#include <vector>

#include <fmt/format.h>

#include <stillbase/core/random.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/planner/planner.hpp>
#include <stillbase/planner/replanner.hpp>

namespace {

using namespace stillbase;

struct Request {
  int updates = 10000;
  double noise = 1;
  bool covariance = false;
  double deadline = 0;  ///< s; 0: none
  std::vector<std::string> problems;
};

Request request_of(int argc, char** argv) {
  Request out;
  const std::vector<std::string> words(argv + 1, argv + argc);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const bool has_value = i + 1 < words.size();
    if (words[i] == "--updates" && has_value) {
      out.updates = std::max(1, std::atoi(words[++i].c_str()));
    } else if (words[i] == "--noise" && has_value) {
      out.noise = std::atof(words[++i].c_str());
    } else if (words[i] == "--deadline" && has_value) {
      out.deadline = 1e-3 * std::atof(words[++i].c_str());
    } else if (words[i] == "--covariance") {
      out.covariance = true;
    } else if (words[i].rfind('-', 0) == 0) {
      std::cerr << "replan_bench [--updates N] [--noise SIZE] [--covariance] [--deadline MS] "
                   "[problem.yaml ...]\n";
      std::exit(2);
    } else {
      out.problems.push_back(words[i]);
    }
  }
  if (out.problems.empty()) {
    out.problems.push_back(std::string(STILLBASE_SOURCE_DIR) + "/problems/iiwa_client_50.yaml");
  }
  return out;
}

double gaussian(Random& random) {  // Box and Muller, 1958
  const double u = 1 - random.uniform(0, 1), v = random.uniform(0, 1);
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * kPi * v);
}

Vector3d errors(Random& random, double sigma) {
  return sigma * Vector3d(gaussian(random), gaussian(random), gaussian(random));
}

void run(const std::string& file, const Request& request) {
  CaptureProblem problem = read_problem(file);
  problem.approach.enabled = false;
  PlannerOptions options;
  options.prover = nullptr;
  const Plan plan = make_plan(problem, options);
  Replanner replanner(plan);
  const double first = problem.target_state.time;
  const double last = std::max(first, problem.variables.contact_time_lower - 20);
  const TargetMotion motion(*problem.target, problem.target_state, last - first + 1);
  Random random(1);
  std::vector<double> seconds, processor, steps;
  int cut = 0, feasible = 0, optimal = 0;
  for (int i = 0; i < request.updates; ++i) {
    StateEstimate estimate{motion.state(first + (last - first) * i / request.updates)};
    TargetState& state = estimate.state;
    state.pose.position += errors(random, 0.02 * request.noise);
    state.pose.orientation =
        (state.pose.orientation * rotation_exp(errors(random, 0.01 * request.noise))).normalized();
    state.linear_velocity += errors(random, 2e-4 * request.noise);
    state.angular_velocity += errors(random, 2e-4 * request.noise);
    if (request.covariance) {
      StateCovariance& covariance = estimate.covariance.emplace(StateCovariance::Zero());
      covariance.diagonal() << Vector3d::Constant(4e-4), Vector3d::Constant(1e-4),
          Eigen::Matrix<double, 6, 1>::Constant(4e-8);
      covariance *= request.noise * request.noise;
    }
    StopCondition stop;
    if (request.deadline > 0) {
      stop.deadline =
          StopCondition::Clock::now() + std::chrono::duration_cast<StopCondition::Clock::duration>(
                                            std::chrono::duration<double>(request.deadline));
    }
    const std::clock_t before = std::clock();
    const ReplanResult& result = replanner.replan(estimate, stop);
    processor.push_back(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC);
    seconds.push_back(result.seconds);
    steps.push_back(result.steps);
    if (result.was_cut) ++cut;
    if (result.max_violation <= kFeasibilityTolerance) ++feasible;
    if (result.status == ReplanStatus::Optimal) ++optimal;
  }
  std::sort(seconds.begin(), seconds.end());
  std::sort(steps.begin(), steps.end());
  const auto at = [&](const std::vector<double>& sorted, double part) {
    return sorted[static_cast<std::size_t>(part * static_cast<double>(sorted.size() - 1))];
  };
  const double worst_processor = *std::max_element(processor.begin(), processor.end());
  std::cout << fmt::format(
                   "| {} | {:.2f} | {:.2f} | {:.2f} | {:.2f} | {:.0f} | {:.0f} | {} | {} | {} |\n",
                   problem.name, 1e3 * at(seconds, 0.5), 1e3 * at(seconds, 0.99),
                   1e3 * at(seconds, 1), 1e3 * worst_processor, at(steps, 0.5), at(steps, 1), cut,
                   feasible, optimal)
            << std::flush;
}

}  // namespace

int main(int argc, char** argv) {
  const Request request = request_of(argc, argv);
  std::cout
      << "| problem | median, ms | 99 %, ms | worst, ms | worst, ms of processor | steps, median "
         "| most | cut | feasible | optimal |\n|---|---|---|---|---|---|---|---|---|---|\n";
  for (const std::string& file : request.problems) run(file, request);
  return EXIT_SUCCESS;
}
