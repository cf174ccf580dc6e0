// A benchmark instance as a nonlinear program, with a judge of its points.
#pragma once

#include <memory>

#include <stillbase/benchmark/suite.hpp>
#include <stillbase/nlp/problem.hpp>

namespace stillbase {

/// Worth of a point by our own evaluation.
struct Judged {
  double value = nlp::kInfinity;      ///< |y| / unit; Case: norm of the equations
  double violation = nlp::kInfinity;  ///< largest, of the constraints and the box
};

/// Every optimizer gets the same program: the same starts, scaling and bounds. Continuous joints
/// are bounded to one revolution, since global methods need a box.
class BenchmarkProgram final : public nlp::Problem {
 public:
  /// @throws InputError as Formulation
  explicit BenchmarkProgram(const BenchmarkInstance& instance);
  ~BenchmarkProgram() override;

  int num_variables() const override;
  int num_constraints() const override;
  Eigen::VectorXd lower() const override;
  Eigen::VectorXd upper() const override;
  Eigen::VectorXd constraint_lower() const override;
  Eigen::VectorXd constraint_upper() const override;
  void evaluate(const Eigen::VectorXd& x, nlp::Evaluation& out) const override;
  void evaluate_value(const Eigen::VectorXd& x, nlp::Evaluation& out) const override;
  bool has_hessian() const override;
  void lagrangian_hessian(const Eigen::VectorXd& x, double sigma,
                          const Eigen::VectorXd& multipliers, Eigen::MatrixXd& out) const override;

  /// Variables and equations of the capture problem, without helpers such as the epigraph's s.
  int free_variables() const;
  int equations() const;

  /// Start point number `index` (from 0) of the sequence that `seed` keys, moved onto the
  /// constraints as the planner's search does (of a case problem the hand's alone).
  Eigen::VectorXd start(int index, std::uint64_t seed) const;
  /// A point moved onto the constraints by Newton's method, as start() does.
  Eigen::VectorXd on_constraints(const Eigen::VectorXd& x) const;
  /// Evaluations of the model so far, those for start points included.
  long model_evaluations() const;
  /// @param at_x evaluation of this program at x
  Judged judge(const Eigen::VectorXd& x, const nlp::Evaluation& at_x) const;
  /// Distance of two points on the configuration manifold.
  double distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace stillbase
