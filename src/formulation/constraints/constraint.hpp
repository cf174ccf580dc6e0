// One constraint of the nonlinear program, and the set of those that a problem asks for.
//
// Each constraint is one file of this folder: a function that adds it to the set where the problem
// asks for it, with name, unit, bounds, and one generic lambda that gives value and gradient for
// any number type. registry.cpp lists these functions.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/tangent.hpp"
#include "formulation/capture_model.hpp"

namespace stillbase {

template <class S>
struct ConstraintPoint;

/// Origin of a shape whose distances are bounded, in the frame of its body; of the target's, from
/// the hand in contact axes.
struct ShapeOrigin {
  int body;  ///< index, kBase or kTargetBody
  Vector3d p;

  /// In B.
  Vector3d at(const ConstraintPoint<double>& point) const;
};

/// Origins of all shapes of distances at one point, in B: many pairs ask for each.
class ShapeOrigins {
 public:
  ShapeOrigins(const std::vector<ShapeOrigin>& shapes, const ConstraintPoint<double>& point) {
    origins_.resize(shapes.size());
    for (std::size_t i = 0; i < shapes.size(); ++i) origins_[i] = shapes[i].at(point);
  }
  const Vector3d& operator[](std::size_t shape) const { return origins_[shape]; }

 private:
  InPlaceArray<Vector3d, 64> origins_;
};

/// Spheres about the two shapes of a distance, which is no less than that of their origins without
/// `reach`.
struct ShapeSpheres {
  std::size_t first, second;  ///< numbers of the shapes
  double reach;               ///< both radii, m

  /// Whether the distance is surely more. @param enough not negative, m
  bool are_apart(const ShapeOrigins& origins, double enough) const {
    constexpr double kRounding = 1e-9;  // m
    const double apart = reach + enough + kRounding;
    return (origins[first] - origins[second]).squaredNorm() > apart * apart;
  }
};

/// What constraints are functions of.
template <class S>
struct ConstraintPoint {
  const CaptureModel& model;
  const Placement<S>& placement;
  const PostureImpact<S>& posture;  ///< set as far as the constraints need it
  const ScenarioImpact<S>& impact;  ///< nominal; set as far as the constraints need it
};

using GradientRow = Eigen::Ref<Eigen::RowVectorXd, 0, Eigen::InnerStride<>>;

/// The limit of the problem behind a constraint that bounds a function of what is limited.
struct StatedLimit {
  std::string name;
  std::string unit;
  double most;                 ///< that the problem allows
  double (*quantity)(double);  ///< what is limited, from the value of the constraint
  double slope;                ///< of the constraint's bound, per unit of `most`
};

/// What a constraint states.
struct ConstraintLabel {
  std::string name;
  std::string unit;
  double lower, upper;
  bool needs_inertia = false;    ///< more of the posture than kinematics and Jacobian
  bool needs_encounter = false;  ///< the impact's encounter and its rates
  bool needs_impact = false;     ///< the whole impact, and so all of the posture
  /// An equation of the impact case: presolve asks whether others imply it.
  bool is_of_case = false;
  /// A limit on rates, singular values or distances, which no enclosure of solutions counts.
  bool is_limit = false;
  /// A distance, whose gradient jumps: where it is flat at some points it may change at others.
  bool has_kinks = false;
  /// One of several functions of which another row of this name is the least: not reported.
  bool is_part = false;
  /// Reported also where no variable changes it.
  bool is_always_reported = false;
  /// Without one the bounds themselves are those of the problem.
  std::optional<StatedLimit> stated = std::nullopt;
};

/// lower <= value <= upper.
class Constraint : public ConstraintLabel {
 public:
  explicit Constraint(ConstraintLabel label) : ConstraintLabel(std::move(label)) {}
  virtual ~Constraint() = default;

  bool is_equation() const { return lower == upper; }

  virtual double value(const ConstraintPoint<double>& at) const = 0;
  virtual Tangent value(const ConstraintPoint<Tangent>& at) const = 0;
  /// @param gradient over the variables (N)
  virtual double value_and_gradient(const ConstraintPoint<double>& at,
                                    GradientRow gradient) const = 0;
  /// out += multiplier * gradient.
  virtual void add_gradient(const ConstraintPoint<Tangent>& at, double multiplier,
                            VectorX<Tangent>& out) const = 0;
  /// Whether the value is known to lie within its bounds without being evaluated; of rows with a
  /// lower bound alone.
  virtual bool surely_holds(const ConstraintPoint<double>&) const { return false; }
  /// Of a distance: a quick way to see that it is far from its bound.
  virtual std::optional<ShapeSpheres> spheres() const { return std::nullopt; }
  /// Whether add_gradient() is exact.
  virtual bool has_hessian() const { return true; }
};

/// A constraint from one generic lambda,
///   []<class S>(const ConstraintPoint<S>&, ScalarGradient<S>* gradient) -> S
/// which returns the value and, unless it is null, fills the gradient, which is zero before. An
/// object in its place may have a surely_holds() as well.
template <class Evaluate>
class ConstraintFrom final : public Constraint {
 public:
  ConstraintFrom(ConstraintLabel label, Evaluate evaluate)
      : Constraint(std::move(label)), evaluate_(std::move(evaluate)) {}

  double value(const ConstraintPoint<double>& at) const override {
    return evaluate_.template operator()<double>(at, nullptr);
  }
  Tangent value(const ConstraintPoint<Tangent>& at) const override {
    return evaluate_.template operator()<Tangent>(at, nullptr);
  }
  double value_and_gradient(const ConstraintPoint<double>& at, GradientRow row) const override {
    ScalarGradient<double> gradient(at.model.n());
    const double value = evaluate_.template operator()<double>(at, &gradient);
    at.model.compress_into(at.placement, gradient, row);
    return value;
  }
  void add_gradient(const ConstraintPoint<Tangent>& at, double multiplier,
                    VectorX<Tangent>& out) const override {
    ScalarGradient<Tangent> gradient(at.model.n());
    evaluate_.template operator()<Tangent>(at, &gradient);
    VectorX<Tangent> row(out.size());
    at.model.compress_into(at.placement, gradient, row);
    out += row * Tangent(multiplier);
  }
  bool surely_holds(const ConstraintPoint<double>& at) const override {
    if constexpr (requires { evaluate_.surely_holds(at); }) {
      return evaluate_.surely_holds(at);
    }
    return false;
  }

  std::optional<ShapeSpheres> spheres() const override {
    if constexpr (requires { evaluate_.spheres(); }) return evaluate_.spheres();
    return std::nullopt;
  }

 private:
  Evaluate evaluate_;
};

using Constraints = std::vector<std::unique_ptr<Constraint>>;

struct ConstraintSet {
  Constraints rows;                 ///< for the optimizers
  Constraints parts;                ///< of rows with kinks: for the optimizers, and not reported
  Constraints implied;              ///< hold where the rows do: reported
  Constraints reported;             ///< change with no variable: reported
  std::vector<ShapeOrigin> shapes;  ///< of distances, as ShapeSpheres number them
};

/// Appends a constraint from a generic lambda.
template <class Evaluate>
void add_constraint(Constraints& to, ConstraintLabel label, Evaluate evaluate) {
  to.push_back(std::make_unique<ConstraintFrom<Evaluate>>(std::move(label), std::move(evaluate)));
}

/// All that the problem asks for, in the order of the registry.
/// @throws InputError for constraints that the problem leaves undefined
ConstraintSet constraints_of(const CaptureModel& model);

/// A constraint from outside the library.
std::unique_ptr<Constraint> user_constraint(UserConstraint constraint);

/// Names of the axes in names of constraints.
inline constexpr const char* kAxisNames[3] = {"x", "y", "z"};

}  // namespace stillbase
