#include "planner/completeness.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/rotation.hpp>
#include <stillbase/plan/turns.hpp>

#include "formulation/projection.hpp"
#include "plan/proof_words.hpp"

namespace stillbase {

namespace {

/// Distance of a candidate from the solution that it is taken for: a tolerance of 1e-9 leaves a
/// double one an extent of its root.
constexpr double kSolvedNearby = 1e-4;

double middle_of(const Ends& ends) { return (ends.lower + ends.upper) / 2; }

/// Angle about the attitude's axis from the stated attitude.
double base_angle(const CaptureProblem& problem, const Configuration& at) {
  return rotation_log(at.base.orientation * problem.base.orientation.conjugate())
      .dot(problem.variables.base_attitude_axis);
}

bool is_near(const CaptureProblem& problem, const JointBox& box, const Configuration& at,
             const EnclosureOptions& options) {
  for (int k = 0; k < problem.robot.n(); ++k) {
    const double middle = (box.lower[k] + box.upper[k]) / 2;
    double apart = at.phi[k] - middle;
    const auto index = static_cast<std::size_t>(k);
    const bool is_every_angle = problem.robot.joints[index].type == JointType::Continuous;
    if (is_every_angle || has_whole_turns(problem, k)) apart = wrap_angle(apart);
    if (std::abs(apart) > (box.upper[k] - box.lower[k]) / 2 + options.near) return false;
  }
  if (box.base_angle) {
    const double apart = wrap_angle(base_angle(problem, at) - middle_of(*box.base_angle));
    const double half = (box.base_angle->upper - box.base_angle->lower) / 2;
    if (std::abs(apart) > half + options.near) return false;
  }
  if (box.contact_time) {
    const double apart = at.contact_time - middle_of(*box.contact_time);
    const double half = (box.contact_time->upper - box.contact_time->lower) / 2;
    if (std::abs(apart) > half + options.near_time) return false;
  }
  return true;
}

std::string counted(long count, const std::string& what) {
  return std::to_string(count) + " " + what;
}

/// The middle of an enclosed solution as a point of the formulation.
Eigen::VectorXd middle_of(const CaptureProblem& problem, const JointBox& box) {
  std::vector<double> x;
  for (int k = 0; k < problem.robot.n(); ++k) {
    if (!problem.variables.joints[static_cast<std::size_t>(k)]) continue;
    x.push_back((box.lower[k] + box.upper[k]) / 2);
  }
  if (box.base_angle) x.push_back(wrap_angle(middle_of(*box.base_angle)));
  if (box.contact_time) x.push_back(middle_of(*box.contact_time));
  return Eigen::Map<Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
}

/// The planner's own evaluation in the middle of a box.
WithinLimits judge(const CaptureProblem& problem, const Formulation& formulation,
                   const JointBox& box, double margin) {
  WithinLimits out = WithinLimits::Yes;
  for (const ConstraintValue& limit : formulation.report_limits(middle_of(problem, box))) {
    if (limit.violation > margin) return WithinLimits::No;
    const double room = std::min(limit.value - limit.lower, limit.upper - limit.value);
    if (!(room > margin)) out = WithinLimits::Undecided;
  }
  return out;
}

}  // namespace

Proof prove_solutions(const Prover* prover, const CaptureProblem& problem,
                      const Formulation& formulation, const StopCondition& stop,
                      const EnclosureOptions& enclosure) {
  if (!prover) {
    Proof out;
    out.statement = std::string(kNothingProven) + ", the program has no prover (stillbase::proof)";
    return out;
  }
  ProofOptions options;
  options.stop = stop;
  options.judge = [&](const JointBox& box) {
    return judge(problem, formulation, box, enclosure.margin);
  };
  return prover->prove(problem, options);
}

void match_candidates(const CaptureProblem& problem, const SearchResult& found, Proof& proof,
                      const EnclosureOptions& options) {
  proof.candidates.assign(proof.solutions.size(), -1);
  const auto match = [&](const auto& configuration_of) {
    for (std::size_t s = 0; s < proof.solutions.size(); ++s) {
      for (std::size_t c = 0; c < found.candidates.size() && proof.candidates[s] < 0; ++c) {
        const bool solved = status_of(found.certificates[c]) != PlanStatus::Infeasible;
        if (solved && is_near(problem, proof.solutions[s], configuration_of(c), options)) {
          proof.candidates[s] = static_cast<int>(c);
        }
      }
    }
  };
  match([&](std::size_t c) { return found.candidates[c].configuration; });
  if (!has_missing_solutions(proof)) return;
  // Nearly double solutions are known less exactly than their residual: what Newton's method makes
  // of the candidates.
  const Formulation formulation(problem);
  const bool are_zeros = proof.lower_bound == 0.0;
  std::vector<Configuration> exact;
  for (const Eigen::VectorXd& x : found.points) {
    const Eigen::VectorXd moved = project_onto_constraints(formulation, x, are_zeros, 20).x;
    const bool is_same = formulation.distance(moved, x) <= kSolvedNearby;
    exact.push_back(formulation.configuration(is_same ? moved : x));
  }
  match([&](std::size_t c) { return exact[c]; });
}

bool has_missing_solutions(const Proof& proof) {
  return std::any_of(proof.candidates.begin(), proof.candidates.end(),
                     [](int candidate) { return candidate < 0; });
}

std::vector<Eigen::VectorXd> enclosed_points(const CaptureProblem& problem, const Proof& proof) {
  std::vector<Eigen::VectorXd> points;
  for (const JointBox& box : proof.solutions) points.push_back(middle_of(problem, box));
  return points;
}

void state_what_was_missed(Proof& proof) {
  if (proof.solutions.empty()) return;
  const long listed =
      std::count_if(proof.candidates.begin(), proof.candidates.end(), [](int c) { return c >= 0; });
  const long total = static_cast<long>(proof.solutions.size());
  if (listed < total) {
    proof.statement += ", " + counted(total - listed, "of them not among the candidates kept");
  } else if (proof.found_by_search < total) {
    proof.statement +=
        ", " + counted(total - proof.found_by_search, "of them missed by the search and added");
  } else {
    const bool is_complete = proof.status == ProofStatus::Complete;
    proof.statement += is_complete ? ", none missed" : ", none of these missed";
  }
}

}  // namespace stillbase
