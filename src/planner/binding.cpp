#include "planner/binding.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/core/constants.hpp>

#include "formulation/formulation_parts.hpp"
#include "formulation/measures/measure.hpp"

namespace stillbase {

namespace {

constexpr double kLeastMultiplier = 1e-6;  ///< of the value, per unit of the limit

/// Name and unit of a variable that has ends of its own; empty: a rotation vector, whose ends are
/// no limits.
std::pair<std::string, std::string> variable_label(const CaptureModel& model, Eigen::Index i) {
  const VariableLayout& layout = model.layout;
  if (i < static_cast<Eigen::Index>(layout.joints.size())) {
    const auto k = static_cast<std::size_t>(layout.joints[static_cast<std::size_t>(i)]);
    const Joint& joint = model.problem.robot.joints[k];
    return {joint.name, joint.is_prismatic() ? "m" : "rad"};
  }
  if (i == layout.time) return {"contact_time", "s"};
  if (i == layout.attitude && layout.attitude_size == 1) return {"base_attitude", "rad"};
  return {};
}

}  // namespace

std::vector<BindingLimit> binding_limits(const CaptureProblem& problem,
                                         const Formulation& formulation, const Eigen::VectorXd& x) {
  Measure measure(problem, formulation);
  const double f = measure.value(x);
  const double unit = formulation.objective_unit();
  if (!(f > kZeroObjective * kZeroObjective / 2)) return {};
  const nlp::Certificate certificate = measure.certify(x);
  if (!std::isfinite(certificate.kkt_residual)) return {};
  // The certificate of a measure over directions or samples is that of f / f(x).
  const double scale = measure.is_nominal() ? 1 : f;
  // d value / d f by the chain of length and value.
  const Power power = formulation.objective_power();
  const double length = unit * std::sqrt(2 * f);
  const double per_length = power.exponent == 1 ? 1 : 2 * length;
  const double per_f = per_length * unit * unit / length;
  const double value = power.value(length);

  std::vector<BindingLimit> out;
  const auto add = [&](const std::string& name, const std::string& of_unit, double at, double lower,
                       double upper, double multiplier) {
    if (name.empty() || lower == upper) return;
    const double saving = std::abs(multiplier) * scale * per_f;
    if (!(saving > kLeastMultiplier * value)) return;
    const bool is_upper = multiplier > 0;
    const double limit = is_upper ? upper : lower;
    if (!std::isfinite(limit)) return;
    // All parts of a limit move with it.
    const auto known = std::find_if(out.begin(), out.end(), [&](const BindingLimit& other) {
      return other.name == name && other.is_upper == is_upper;
    });
    if (known != out.end()) {
      known->multiplier += saving;
      return;
    }
    out.push_back({name, is_upper, limit, is_upper ? limit - at : at - limit, saving, of_unit});
  };
  const CaptureModel& model = formulation.parts().model;
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const auto [name, of_unit] = variable_label(model, i);
    add(name, of_unit, x[i], model.layout.lower[i], model.layout.upper[i],
        certificate.bound_multipliers[i]);
  }
  nlp::Evaluation here;
  formulation.evaluate_value(x, here);
  const auto& rows = formulation.parts().rows.kept;
  for (std::size_t k = 0; k < rows.size(); ++k) {
    const auto i = static_cast<Eigen::Index>(k);
    const double at = here.constraints[i], multiplier = certificate.multipliers[i];
    if (const auto& stated = rows[k]->stated) {
      add(stated->name, stated->unit, stated->quantity(at), -kInfinity, stated->most,
          stated->slope * multiplier);
    } else {
      add(rows[k]->name, rows[k]->unit, at, rows[k]->lower, rows[k]->upper, multiplier);
    }
  }
  std::stable_sort(out.begin(), out.end(), [](const BindingLimit& a, const BindingLimit& b) {
    return a.multiplier > b.multiplier;
  });
  return out;
}

}  // namespace stillbase
