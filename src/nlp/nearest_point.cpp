#include "nlp/nearest_point.hpp"

namespace stillbase::nlp {
namespace {

class ViolationProblem final : public Problem {
 public:
  explicit ViolationProblem(const Problem& problem)
      : problem_(problem),
        constraint_lower_(problem.constraint_lower()),
        constraint_upper_(problem.constraint_upper()) {}

  int num_variables() const override { return problem_.num_variables(); }
  int num_constraints() const override { return 0; }
  Eigen::VectorXd lower() const override { return problem_.lower(); }
  Eigen::VectorXd upper() const override { return problem_.upper(); }
  Eigen::VectorXd constraint_lower() const override { return {}; }
  Eigen::VectorXd constraint_upper() const override { return {}; }

  void evaluate(const Eigen::VectorXd& x, Evaluation& out) const override {
    auto& inner = out.workspace_as<Evaluation>();
    problem_.evaluate(x, inner);
    const Eigen::VectorXd violation =
        signed_violation(inner.constraints, constraint_lower_, constraint_upper_);
    out.objective = 0.5 * violation.squaredNorm();
    // A NaN compares false with both bounds and would look like no violation.
    if (!inner.constraints.allFinite()) out.objective = kInfinity;
    out.gradient.noalias() = inner.jacobian.transpose() * violation;
    out.constraints.resize(0);
    out.jacobian.resize(0, x.size());
  }

 private:
  const Problem& problem_;
  const Eigen::VectorXd constraint_lower_, constraint_upper_;
};

}  // namespace

NearestPoint nearest_point(const Problem& problem, const Eigen::VectorXd& x0, int max_evaluations,
                           const OptimizeOptions& options) {
  OptimizeOptions inner = options;
  inner.max_evaluations = max_evaluations;
  inner.explain_infeasibility = false;
  const ViolationProblem violation(problem);
  const OptimizeResult found = make_optimizer("nlopt-slsqp")->minimize(violation, x0, inner);
  return {found.x, found.evaluations};
}

}  // namespace stillbase::nlp
