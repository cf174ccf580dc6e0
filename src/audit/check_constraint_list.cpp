// Does the plan list every constraint that the problem demands, each once?
#include <algorithm>
#include <cmath>
#include <memory>

#include <fmt/format.h>

#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/core/random.hpp>

#include "audit/checks.hpp"
#include "audit/equations.hpp"
#include "verification/known_constraints.hpp"

namespace stillbase::audit {

using namespace verification;

namespace {

/// When a constraint of the problem may be missing in the list, and when two are one.
struct ConstraintListOptions {
  int samples = 8;              ///< configurations at which a constraint may show that it matters
  double idle = 1e-9;           ///< largest change, or violation, of one that does not matter
  double idle_bound = 1e-6;     ///< the same of a bound that is never near
  double never_near = 1e-3;     ///< this far from it, relative; 1000 times what it changes by
  double group_rank = 1e-8;     ///< of a group's values over the samples, relative
  double coupling_rank = 1e-9;  ///< of the coupling matrix, relative
};
constexpr ConstraintListOptions kList;

/// Constraints at evenly spread configurations of the problem.
class Samples {
 public:
  explicit Samples(const CaptureProblem& problem) {
    const FreeVariables variables(problem);
    for (int i = 0; i < kList.samples; ++i) {
      const Eigen::VectorXd u = low_discrepancy_point(i, variables.size(), 2);
      situations_.push_back(
          std::make_unique<Situation>(problem, variables.at(variables.sample(u))));
      known_.push_back(std::make_unique<KnownConstraints>(*situations_.back()));
    }
  }

  /// Whether a constraint holds everywhere and never changes. Angles of a robot file have few
  /// digits: the distance of a link that moves above a flat face changes by their error, far from
  /// its bound.
  bool is_idle(const std::string& name) const {
    const auto first = known_.front()->find(name);
    if (!first || !first->value) return false;
    return std::all_of(known_.begin(), known_.end(), [&](const auto& known) {
      const double value = *known->find(name)->value, size = 1 + std::abs(value);
      const double change = std::abs(value - *first->value);
      const double room = std::min(value - first->lower, first->upper - value);
      return (change <= kList.idle * size && room >= -kList.idle) ||
             (change <= kList.idle_bound * size && room >= kList.never_near * size);
    });
  }

  /// Number of components in which a group's vector varies.
  int rank(const std::string& group) const {
    Eigen::MatrixXd vectors(3, kList.samples);
    for (int i = 0; i < kList.samples; ++i) vectors.col(i) = known_[i]->group(group).vector;
    const Eigen::VectorXd sizes = singular_values(vectors);
    if (!(sizes[0] > kList.idle)) return 0;
    return numerical_rank(sizes, kList.group_rank);
  }

  /// Largest rank of the coupling matrix.
  int coupling_rank() const {
    int rank = 0;
    for (const auto& situation : situations_) {
      const Eigen::VectorXd sizes = singular_values(situation->response.dynamics.Htilde_omegaphi);
      rank = std::max(rank, numerical_rank(sizes, kList.coupling_rank));
    }
    return rank;
  }

 private:
  std::vector<std::unique_ptr<Situation>> situations_;
  std::vector<std::unique_ptr<KnownConstraints>> known_;
};

}  // namespace

void check_constraint_list(const Context& context, ClaimList& claims) {
  const std::vector<ConstraintValue>& list = context.plan.constraints;
  const KnownConstraints known(context.situation);
  const Samples samples(context.problem);
  Objections objections;
  std::string unknown;
  const auto count = [&](const std::string& name) {
    return std::count_if(list.begin(), list.end(),
                         [&](const ConstraintValue& c) { return c.name == name; });
  };
  for (const ConstraintValue& c : list) {
    objections.demand(count(c.name) == 1, c.name + " is listed more than once");
    if (!known.find(c.name)) unknown += " " + c.name;
  }
  for (const std::string& name : known.demanded()) {
    const bool may_miss = !known.find(name)->is_always_listed && samples.is_idle(name);
    objections.demand(count(name) > 0 || may_miss, name + " is missing");
  }
  for (const std::string& group : known.demanded_groups()) {
    const bool is_coupling = group == "case_coupling_";
    const auto listed = std::count_if(list.begin(), list.end(), [&](const ConstraintValue& c) {
      return c.name.rfind(group, 0) == 0;
    });
    int wanted = samples.rank(group);
    if (is_coupling) wanted = std::min(wanted, samples.coupling_rank());
    objections.demand(listed >= wanted,
                      fmt::format("{} of {} equations {}* are listed", listed, wanted, group));
  }
  claims.none_wrong("constraints_complete", objections,
                    "constraints that the problem demands, each listed once");
  if (!unknown.empty()) {
    claims.not_verified("constraints_unknown", "constraints without a known meaning:" + unknown);
  }
}

}  // namespace stillbase::audit
