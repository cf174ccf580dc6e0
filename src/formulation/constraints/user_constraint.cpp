// A constraint from outside the library, with its own gradient or central differences.
#include <stdexcept>

#include "formulation/constraints/constraint.hpp"
#include "formulation/objectives/differenced_terms.hpp"

namespace stillbase {

namespace {

class UserRow final : public Constraint {
 public:
  explicit UserRow(UserConstraint constraint)
      : Constraint({.name = constraint.name,
                    .unit = constraint.unit,
                    .lower = constraint.lower,
                    .upper = constraint.upper,
                    .needs_impact = true}),
        function_(std::move(constraint.value)),
        gradient_(std::move(constraint.gradient)) {}

  double value(const ConstraintPoint<double>& at) const override {
    return function_(at.model.configuration(at.placement.x),
                     summarize_scenario(at.model, at.placement, at.impact, at.model.nominal));
  }
  double value_and_gradient(const ConstraintPoint<double>& at, GradientRow row) const override {
    const Eigen::VectorXd x = at.placement.x;
    if (gradient_) {
      row = users_gradient(name, gradient_, at.model.configuration(x),
                           summarize_scenario(at.model, at.placement, at.impact, at.model.nominal),
                           x.size());
      return value(at);
    }
    const auto value_at = [&](const Eigen::VectorXd& other) {
      const NominalPoint there(at.model, other);
      return value({at.model, there.at, there.posture, there.impact});
    };
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      row[i] = difference_along(at.model.layout, x, i, value_at);
    }
    return value(at);
  }
  bool has_hessian() const override { return false; }
  Tangent value(const ConstraintPoint<Tangent>&) const override { return no_derivative(); }
  void add_gradient(const ConstraintPoint<Tangent>&, double, VectorX<Tangent>&) const override {
    no_derivative();
  }

 private:
  [[noreturn]] Tangent no_derivative() const {
    throw std::logic_error(name + ": a user's constraint has no exact second derivatives");
  }

  UserFunction function_;
  UserGradient gradient_;
};

}  // namespace

std::unique_ptr<Constraint> user_constraint(UserConstraint constraint) {
  return std::make_unique<UserRow>(std::move(constraint));
}

}  // namespace stillbase
