// Proofs of problems with limits on rates, singular values and clearances: which of the enclosed
// solutions count is judged once by the planner and once by the verification's own search.
#include <catch2/catch.hpp>

#include <algorithm>
#include <functional>
#include <vector>

#include <stillbase/formulation/formulation.hpp>
#include <stillbase/planner/planner.hpp>

#include "support/shipped_problem.hpp"
#include "verification/failed_claims.hpp"

namespace stillbase {
namespace {

CaptureProblem two_link_arm() {
  CaptureProblem problem = test::without_path("planar_two_link_c2_a");
  return problem;
}

/// The eight postures without limits.
const Plan& plan_without_limits() {
  static const Plan plan = make_plan(two_link_arm());
  return plan;
}

struct Limit {
  const char* name;
  std::function<void(CaptureProblem&, double)> set;
  /// Every posture keeps this one.
  double lax;
  /// Of the list of constraints: the value that the limit is about.
  std::function<double(const std::vector<ConstraintValue>&)> value;
};

std::vector<Limit> limits() {
  const auto least_of = [](const std::string& begin) {
    return [begin](const std::vector<ConstraintValue>& list) {
      double least = kInfinity;
      for (const ConstraintValue& one : list) {
        if (one.name.rfind(begin, 0) == 0) least = std::min(least, one.value);
      }
      return least;
    };
  };
  const auto fastest = [](const std::vector<ConstraintValue>& list) {
    double most = 0;
    for (const ConstraintValue& one : list) {
      if (one.name.rfind("joint_rate_", 0) == 0) most = std::max(most, std::abs(one.value));
    }
    return most;
  };
  return {{"rates",
           [](CaptureProblem& problem, double value) {
             problem.constraints.joint_rate_max = JointVectord::Constant(2, value);
           },
           1e3, fastest},
          {"coupling",
           [](CaptureProblem& problem, double value) {
             problem.constraints.coupling_singular_value_min = value;
           },
           1e-9, least_of("coupling_singular_value")},
          {"jacobian",
           [](CaptureProblem& problem, double value) {
             problem.constraints.jacobian_singular_value_min = value;
           },
           1e-9, least_of("jacobian_singular_value")},
          {"clearance",
           [](CaptureProblem& problem, double value) { problem.constraints.clearance = value; },
           -10, least_of("clearance_")}};
}

/// The values of a limit at the eight postures, smallest first.
std::vector<double> values_of(const Limit& limit) {
  CaptureProblem problem = two_link_arm();
  limit.set(problem, limit.lax);
  const Formulation formulation(problem);
  std::vector<double> values;
  for (const Candidate& candidate : plan_without_limits().candidates) {
    values.push_back(
        limit.value(formulation.report(formulation.variables(candidate.configuration))));
  }
  std::sort(values.begin(), values.end());
  return values;
}

/// Between the two neighbours that are furthest apart.
double dividing(const std::vector<double>& values) {
  std::size_t widest = 1;
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] - values[i - 1] > values[widest] - values[widest - 1]) widest = i;
  }
  return (values[widest] + values[widest - 1]) / 2;
}

}  // namespace

TEST_CASE("enclosed solutions within the limits are listed, the others counted") {
  REQUIRE(plan_without_limits().certificate.proof.solutions.size() == 8);
  for (const Limit& limit : limits()) {
    INFO(limit.name);
    const std::vector<double> values = values_of(limit);
    const double at = dividing(values);
    const auto above = static_cast<std::size_t>(
        std::count_if(values.begin(), values.end(), [&](double value) { return value > at; }));
    const std::size_t inside = std::string(limit.name) == "rates" ? 8 - above : above;
    CaptureProblem problem = two_link_arm();
    limit.set(problem, at);
    const Plan plan = make_plan(problem);
    const Proof& proof = plan.certificate.proof;
    CAPTURE(proof.statement);
    CHECK(proof.status == ProofStatus::Complete);
    CHECK(proof.solutions.size() == inside);
    CHECK(inside < 8);
    CHECK(proof.statement.find("(" + std::to_string(8 - inside) + " other") != std::string::npos);
    for (const int c : proof.candidates) CHECK(c >= 0);
    CHECK(failures(plan).find("proof_") == std::string::npos);  // it may touch itself
    REQUIRE(inside > 0);
    // One left out is found by the search of the verification.
    Plan shorter = plan;
    shorter.certificate.proof.solutions.pop_back();
    shorter.certificate.proof.candidates.pop_back();
    CHECK(failures(shorter).find("proof_recount") != std::string::npos);
  }
}

TEST_CASE("a solution at its limit is undecided") {
  const Limit limit = limits()[1];
  const std::vector<double> values = values_of(limit);
  for (const double apart : {-5e-8, 5e-8}) {
    CaptureProblem problem = two_link_arm();
    limit.set(problem, values.front() + apart);
    const Proof proof = make_plan(problem).certificate.proof;
    CAPTURE(proof.statement);
    CHECK(proof.status == ProofStatus::Undecided);
    CHECK(proof.solutions.size() == 7);
    CHECK(proof.undecided.size() == 1);
  }
}

TEST_CASE("a proof states that no solution is within the limits, and how many are beyond") {
  const Limit limit = limits()[1];
  CaptureProblem problem = two_link_arm();
  limit.set(problem, 2 * values_of(limit).back());
  const Plan plan = make_plan(problem);
  const Proof& proof = plan.certificate.proof;
  CHECK(proof.status == ProofStatus::Complete);
  CHECK(proof.solutions.empty());
  CHECK(proof.statement.find("proven: there is no solution") == 0);
  CHECK(proof.statement.find("(8 others beyond the limits") != std::string::npos);
  CHECK(plan.status == PlanStatus::Infeasible);
}

}  // namespace stillbase
