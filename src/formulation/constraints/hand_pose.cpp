// All three axes r_i of the hand along the wanted ones d_i.
#include "formulation/constraints/constraint.hpp"

namespace stillbase {

namespace {

/// Component i of 1/2 sum r_k x d_k of two sets of axes (columns): sin(angle) times the axis that
/// turns R to D.
template <class S>
S rotation_error(const Matrix3<S>& R, const Matrix3<S>& D, int i) {
  const int j = (i + 1) % 3, k = (i + 2) % 3;
  return (R.row(j).dot(D.row(k)) - R.row(k).dot(D.row(j))) / S(2);
}

/// sum r_k . d_k.
template <class S>
S alignment(const Matrix3<S>& R, const Matrix3<S>& D) {
  return R.cwiseProduct(D).sum();
}

/// d rotation_error_i / d(rotation of R): row i of 1/2 (R D' - (sum r_k . d_k) E).
template <class S>
Vector3<S> rotation_error_gradient(const Matrix3<S>& R, const Matrix3<S>& D, int i) {
  Vector3<S> out = D * R.row(i).transpose();
  out[i] -= alignment<S>(R, D);
  return out / S(2);
}

template <class S>
Matrix3<S> wanted_axes_at(const ConstraintPoint<S>& at) {
  return wanted_hand_axes<S>(at.model.encounter, at.placement.R_NB, at.placement.contact.R_EB);
}

/// @param g_R, g_D derivatives with respect to rotations in B of the hand and of the wanted axes
template <class S>
void add_hand_rotation_gradient(const ConstraintPoint<S>& at, const Vector3<S>& g_R,
                                const Vector3<S>& g_D, ScalarGradient<S>& gradient) {
  for (int k = 0; k < at.model.n(); ++k) {
    const Vector3<S> turn = at.posture.jacobian.J_phi.template block<3, 1>(3, k);
    gradient.phi[k] = turn.dot(g_R);
  }
  // A rotation of B relative to the wanted axes rotates them backwards in B.
  if (!at.model.encounter.stated_hand_axes) {
    at.model.template add_contact_turn<S>(at.placement.rates, -g_D, gradient);
  } else if (at.model.encounter.hand_frame == Frame::Inertial) {
    gradient.theta -= g_D;
  }
}

}  // namespace

void add_hand_pose(const CaptureModel& model, ConstraintSet& out) {
  if (model.problem.hand.constraint != HandConstraint::Pose) return;
  for (int i = 0; i < 3; ++i) {
    // Component i in B of the rotation error 1/2 sum r_k x d_k.
    const auto component = [i]<class S>(const ConstraintPoint<S>& at,
                                        ScalarGradient<S>* gradient) -> S {
      const Matrix3<S>& R = at.posture.kinematics.R_hand;
      const Matrix3<S> D = wanted_axes_at<S>(at);
      if (gradient != nullptr) {
        add_hand_rotation_gradient<S>(at, rotation_error_gradient<S>(R, D, i),
                                      -rotation_error_gradient<S>(D, R, i), *gradient);
      }
      return rotation_error<S>(R, D, i);
    };
    add_constraint(out.rows, {std::string("hand_rotation_") + kAxisNames[i], "1", 0, 0}, component);
  }
  // sum r_k . d_k excludes the opposite orientations.
  add_constraint(out.rows, {"hand_facing", "1", 0, kInfinity},
                 []<class S>(const ConstraintPoint<S>& at, ScalarGradient<S>* gradient) -> S {
                   const Matrix3<S>& R = at.posture.kinematics.R_hand;
                   const Matrix3<S> D = wanted_axes_at<S>(at);
                   if (gradient != nullptr) {
                     Vector3<S> g_R;
                     for (int i = 0; i < 3; ++i) g_R[i] = rotation_error<S>(R, D, i) * S(2);
                     add_hand_rotation_gradient<S>(at, g_R, -g_R, *gradient);
                   }
                   return alignment<S>(R, D);
                 });
}

}  // namespace stillbase
