// Which margins a problem asks for: joint rates, singular values, clearances.
#include <cmath>

#include <stillbase/core/error.hpp>
#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/core/random.hpp>

#include <stillbase/dynamics/inertia.hpp>

#include "formulation/formulation_parts.hpp"

namespace stillbase {

namespace {

/// Largest rank of a matrix over some postures: its rank almost everywhere.
template <class MatrixAt>
int generic_rank(int n, const MatrixAt& matrix_at) {
  Random random(0);
  int rank = 0;
  for (int sample = 0; sample < 8; ++sample) {
    JointVectord phi(n);
    for (int k = 0; k < n; ++k) phi[k] = random.uniform(-3, 3);
    rank = std::max(rank, numerical_rank(singular_values(matrix_at(phi)), 1e-9));
  }
  return rank;
}

}  // namespace

void Formulation::Parts::add_margin_rows() {
  const ConstraintSpec& wanted = problem.constraints;
  for (int k = 0; k < n(); ++k) {
    const Joint& joint = problem.robot.joints[static_cast<std::size_t>(k)];
    double limit = kInfinity;
    if (wanted.joint_rate_scale) limit = *wanted.joint_rate_scale * joint.max_velocity;
    if (wanted.joint_rate_max.size() == n()) limit = wanted.joint_rate_max[k];
    if (!std::isfinite(limit)) continue;
    rows.push_back({RowKind::JointRate, k, "joint_rate_" + joint.name, -limit, limit});
  }
  const auto at = [this](const JointVectord& phi) {
    return evaluate_posture<double>(problem.robot, resistance, phi);
  };
  if (wanted.coupling_singular_value_min > 0) {
    coupling_rank = generic_rank(n(), [&](const JointVectord& phi) {
      return Eigen::MatrixXd(at(phi).tilde.Htilde_omegaphi);
    });
    if (coupling_rank > 0) {
      rows.push_back({RowKind::CouplingMargin, 0, "coupling_singular_value",
                      wanted.coupling_singular_value_min, kInfinity});
    }
  }
  if (wanted.jacobian_singular_value_min > 0) {
    jacobian_rank = generic_rank(n(), [&](const JointVectord& phi) {
      const auto posture = at(phi);
      Eigen::MatrixXd A = compute_hat_inertia<double>(posture.inertia, posture.jacobian).Jhat_phi;
      A.bottomRows(3) *= wanted.jacobian_length;
      return A;
    });
    if (jacobian_rank > 0) {
      rows.push_back({RowKind::JacobianMargin, 0, "jacobian_singular_value",
                      wanted.jacobian_singular_value_min, kInfinity});
    }
  }
}

void Formulation::Parts::add_clearance_rows() {
  if (!problem.constraints.clearance) return;
  const auto refuse = [this](const std::string& message) {
    throw InputError(
        {Finding{problem.source, 0, "clearance", "constraints.clearance: " + message}});
  };
  clearances = clearance_pairs(problem);
  const bool has_target = problem.target && !problem.target->shapes.empty();
  if (has_target && model.follows_target() && model.hand_point) {
    refuse("the target lies with its contact feature at the hand; leave hand.position out");
  }
  if (has_target && model.frame == ContactFrame::Base && layout.attitude_size > 0) {
    refuse("with a direction stated in the base frame the attitude of the base must be fixed");
  }
  if (has_target) target = target_placement(problem, model);
  for (std::size_t i = 0; i < clearances.size(); ++i) {
    rows.push_back({RowKind::Clearance, static_cast<int>(i), clearances[i].name,
                    *problem.constraints.clearance, kInfinity});
  }
}

}  // namespace stillbase
