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

/// Another program as it is; derived classes change a part of it.
class ForwardingProgram : public nlp::Problem {
 public:
  int num_variables() const override { return inner().num_variables(); }
  int num_constraints() const override { return inner().num_constraints(); }
  Eigen::VectorXd lower() const override { return inner().lower(); }
  Eigen::VectorXd upper() const override { return inner().upper(); }
  Eigen::VectorXd constraint_lower() const override { return inner().constraint_lower(); }
  Eigen::VectorXd constraint_upper() const override { return inner().constraint_upper(); }
  bool may_have_kinks(int i) const override { return inner().may_have_kinks(i); }
  void evaluate(const Eigen::VectorXd& x, nlp::Evaluation& out) const override {
    inner().evaluate(x, out);
  }
  void evaluate_value(const Eigen::VectorXd& x, nlp::Evaluation& out) const override {
    inner().evaluate_value(x, out);
  }
  bool has_hessian() const override { return inner().has_hessian(); }
  void lagrangian_hessian(const Eigen::VectorXd& x, double sigma,
                          const Eigen::VectorXd& multipliers, Eigen::MatrixXd& out) const override {
    inner().lagrangian_hessian(x, sigma, multipliers, out);
  }

 protected:
  virtual const nlp::Problem& inner() const = 0;
};

/// How a random posture is moved onto the constraints, as in the planner's search: one that cannot
/// be is replaced by another one.
struct StartOptions {
  int draws = 9;                 ///< postures tried for one start
  int steps = 15;                ///< of Newton's method
  double on_constraints = 1e-3;  ///< violation that is small enough to begin a local solve
};

/// Every optimizer gets the same program: the same starts, scaling and bounds. Continuous joints
/// are bounded to one revolution, since global methods need a box.
class BenchmarkProgram final : public ForwardingProgram {
 public:
  /// @throws InputError as Formulation
  explicit BenchmarkProgram(const BenchmarkInstance& instance);
  ~BenchmarkProgram() override;

  Eigen::VectorXd lower() const override;
  Eigen::VectorXd upper() const override;

  /// Variables and equations of the capture problem, without helpers such as the epigraph's s.
  int free_variables() const;
  int equations() const;

  /// Start point number `index` (from 0) of the sequence that `seed` keys, moved onto the
  /// constraints as the planner's search does (of a case problem the hand's alone).
  Eigen::VectorXd start(int index, std::uint64_t seed, const StartOptions& options = {}) const;
  /// A point moved onto the constraints by Newton's method, as start() does.
  Eigen::VectorXd on_constraints(const Eigen::VectorXd& x, const StartOptions& options = {}) const;
  /// Evaluations of the model so far, those for start points included.
  long model_evaluations() const;
  /// @param at_x evaluation of this program at x
  Judged judge(const Eigen::VectorXd& x, const nlp::Evaluation& at_x) const;
  /// Distance of two points on the configuration manifold.
  double distance(const Eigen::VectorXd& a, const Eigen::VectorXd& b) const;

 protected:
  const nlp::Problem& inner() const override;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace stillbase
