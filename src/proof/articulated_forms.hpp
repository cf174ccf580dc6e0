// Articulated bodies over a whole box of postures, for number types that are sets.
//
// The recursion of <stillbase/dynamics/articulated_body.hpp>, with every body's inertia in the
// frame of the body itself. There it depends on the joints beyond it alone. In base axes the angles
// of the joints before it would be in all entries, and sets become wide where one number occurs
// often.
//
// Why there are two solutions for one arm. Bounds of a minimum come from wide boxes, for which
// these forms are narrow, and ask for quotients (magnitude of the impulse, velocities). The
// equations of a case problem (case_rows.hpp) end in boxes of 1e-8 rad, where both are equally
// narrow; written with the planner's matrices and one elimination (elimination.hpp) they need no
// quotient of impulse quantities and are momenta, as the planner's rows are.
//
// With [f; m] about the joint's origin, s the unit twist of joint k and I the articulated inertia
//   U = I s,  D = s' U + added inertia,  I <- I - U U' / D  (a locked joint: I),
// then to the parent's frame: rotated about the axis by phi, rotated by a constant, shifted. The
// composite inertia, of which the joints are held, follows the same steps.
//
// Featherstone, Rigid Body Dynamics Algorithms, 2008, chapter 7.
#pragma once

#include <vector>

#include <stillbase/core/rotation.hpp>
#include <stillbase/robot/robot_model.hpp>

#include "dynamics/rigid_inertia.hpp"
#include "proof/taylor.hpp"

namespace stillbase::proof {

/// R x. Most entries of a joint's R are zeros and ones.
template <class S>
Vector3<S> rotated(const Matrix3d& R, const Vector3<S>& x) {
  Vector3<S> out;
  for (int i = 0; i < 3; ++i) {
    out[i] = S(0.0);
    for (int k = 0; k < 3; ++k) {
      if (R(i, k) == 1) {
        out[i] += x[k];
      } else if (R(i, k) != 0 && !x[k].is_zero()) {
        out[i] += x[k] * S(R(i, k));
      }
    }
  }
  return out;
}

/// Momentum [p; L] of a twist [v; omega]: [M H; H' J], M and J symmetric.
template <class S>
struct BodyInertia {
  Matrix3<S> M, H, J;

  /// Of a rigid body about the origin of its frame. In S: what is rounded counts.
  explicit BodyInertia(const Body& body) {
    const S m(body.mass);
    const Vector3<S> c = body.centroid.template cast<S>();
    M = Matrix3<S>::Identity() * m;
    H = -skew<S>(c * m);
    J = body.inertia.template cast<S>() + parallel_axis<S>(m, c);
  }

  BodyInertia& operator+=(const BodyInertia& o) {
    M += o.M;
    H += o.H;
    J += o.J;
    return *this;
  }

  /// Momentum of the unit twist along (0 to 2) or about (3 to 5) an axis.
  Vector6<S> column(int i) const {
    Vector6<S> out;
    if (i < 3) {
      out << M.col(i), H.row(i).transpose();
    } else {
      out << H.col(i - 3), J.col(i - 3);
    }
    return out;
  }

  /// I - U U' / D for U = I s, s the unit twist i, D = U_i + added.
  void release(int i, const Vector6<S>& U, const S& added, const S& D, const S& inverse_D) {
    // Row and column i are left with U_i added / D: written so, nothing cancels.
    std::array<S, 6> share;
    for (int a = 0; a < 6; ++a) share[a] = quotient(U[a], D, inverse_D);
    const auto less = [&](S& entry, int a, int b) {
      if (a == i) {
        entry = share[b] * added;
      } else if (b == i) {
        entry = share[a] * added;
      } else if (a == b) {
        entry -= square(U[a]) * inverse_D;
      } else if (!U[a].is_zero() && !U[b].is_zero()) {
        entry -= U[a] * share[b];
      }
    };
    for (int a = 0; a < 3; ++a) {
      for (int b = 0; b < 3; ++b) less(H(a, b), a, b + 3);
      for (int b = 0; b <= a; ++b) {
        less(M(a, b), a, b);
        less(J(a, b), a + 3, b + 3);
      }
    }
    mirror();
  }

  /// Rotates it about z by the angle whose cosine and sine, and those of twice it, are given.
  void rotate_about_z(const S& c, const S& s, const S& c2, const S& s2) {
    const auto rotate = [](S& x, S& y, const S& cosine, const S& sine) {
      if (x.is_zero() && y.is_zero()) return;
      const S old = x;
      x = old * cosine - y * sine;
      y = old * sine + y * cosine;
    };
    const S half(0.5);
    for (Matrix3<S>* block : {&M, &J}) {
      Matrix3<S>& X = *block;
      rotate(X(2, 0), X(2, 1), c, s);
      const S mean = (X(0, 0) + X(1, 1)) * half;
      S along = (X(0, 0) - X(1, 1)) * half;
      rotate(along, X(1, 0), c2, s2);
      X(0, 0) = mean + along;
      X(1, 1) = mean - along;
    }
    rotate(H(0, 2), H(1, 2), c, s);
    rotate(H(2, 0), H(2, 1), c, s);
    // Of the plane's four entries trace and skew part stay, the others rotate by twice the angle.
    const S mean = (H(0, 0) + H(1, 1)) * half, twist = (H(0, 1) - H(1, 0)) * half;
    S along = (H(0, 0) - H(1, 1)) * half, across = (H(0, 1) + H(1, 0)) * half;
    rotate(along, across, c2, s2);
    H(0, 0) = mean + along;
    H(1, 1) = mean - along;
    H(0, 1) = across + twist;
    H(1, 0) = across - twist;
    mirror();
  }

  /// Into the axes of the columns of R'.
  void rotate(const Matrix3d& R) {
    if (R == Matrix3d::Identity()) return;
    for (Matrix3<S>* block : {&M, &H, &J}) {
      // R X R' = R (R X')'
      const Matrix3<S> RXt = product(R, Matrix3<S>(block->transpose()));
      *block = product(R, Matrix3<S>(RXt.transpose()));
    }
    mirror();
  }

  /// About the origin from where this one's is at p: H - M P and J + P H - (H - M P)' P with
  /// P = skew(p).
  void shift(const Vector3<S>& p) {
    for (int i = 0; i < 3; ++i) {
      const int k = (i + 1) % 3, l = (i + 2) % 3;
      for (int j = 0; j <= i; ++j) {
        add(J(i, j), p[k], H(l, j));
        add(J(i, j), -p[l], H(k, j));
      }
    }
    for (int j = 0; j < 3; ++j) {
      const int k = (j + 1) % 3, l = (j + 2) % 3;
      for (int i = 0; i < 3; ++i) {
        add(H(i, j), -p[l], M(i, k));
        add(H(i, j), p[k], M(i, l));
      }
    }
    for (int j = 0; j < 3; ++j) {
      const int k = (j + 1) % 3, l = (j + 2) % 3;
      for (int i = j; i < 3; ++i) {
        add(J(i, j), -p[l], H(k, i));
        add(J(i, j), p[k], H(l, i));
      }
    }
    mirror();
  }

 private:
  static void add(S& to, const S& a, const S& b) {
    if (!a.is_zero() && !b.is_zero()) to += a * b;
  }

  static Matrix3<S> product(const Matrix3d& R, const Matrix3<S>& X) {
    Matrix3<S> out;
    for (int j = 0; j < 3; ++j) out.col(j) = rotated<S>(R, X.col(j));
    return out;
  }

  /// M and J are symmetric.
  void mirror() {
    for (Matrix3<S>* X : {&M, &J}) {
      for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < i; ++j) (*X)(j, i) = (*X)(i, j);
      }
    }
  }
};

/// The robot over a box of postures, joints free or locked. Everything of joint k is about the
/// origin of body k and in its axes.
template <class S>
struct ArticulatedForms {
  const RobotModel& robot;
  PerBody<S, S> cosine, sine;  ///< of the joint angles; of prismatic joints 1 and 0
  PerBody<Vector3<S>, S> p;    ///< origin of joint frame k in the parent's frame, m
  PerBody<Vector6<S>, S> U;    ///< momentum of the articulated body k moved along joint k
  PerBody<S, S> D, inverse_D;  ///< undefined for locked joints
  BodyInertia<S> articulated;  ///< of the whole about the base centroid, joints free, in B
  BodyInertia<S> composite;    ///< the same, joints held; where it is wanted
  std::vector<bool> moves;     ///< n, joint k is not locked

  /// @param model outlives this
  ArticulatedForms(const RobotModel& model, const JointVector<S>& phi,
                   const JointVectord& added_inertia, const std::vector<bool>& locked,
                   bool with_composite)
      : robot(model),
        articulated(robot.base),
        composite(robot.base),
        moves(static_cast<std::size_t>(robot.n()), true) {
    std::vector<BodyInertia<S>> outboard(robot.bodies.begin(), robot.bodies.end());
    std::vector<BodyInertia<S>> held;
    if (with_composite) held = outboard;
    for (int k = robot.n() - 1; k >= 0; --k) {
      const Joint& joint = robot.joints[k];
      const bool slides = joint.is_prismatic();
      cosine[k] = slides ? S(1.0) : cos(phi[k]);
      sine[k] = slides ? S(0.0) : sin(phi[k]);
      p[k] = joint.p.template cast<S>();
      if (slides) p[k] += joint.R.matrix().col(2).template cast<S>() * phi[k];
      if (!locked.empty()) moves[k] = !locked[k];
      if (moves[k]) {
        const int i = index(k);
        const S added(added_inertia[k]);
        U[k] = outboard[k].column(i);
        D[k] = U[k][i] + added;
        inverse_D[k] = inverse_of(D[k]);
        outboard[k].release(i, U[k], added, D[k], inverse_D[k]);
      }
      move_to_parent(k, phi[k], outboard[k]);
      const bool is_first = joint.parent == kBase;
      (is_first ? articulated : outboard[joint.parent]) += outboard[k];
      if (!with_composite) continue;
      move_to_parent(k, phi[k], held[k]);
      (is_first ? composite : held[joint.parent]) += held[k];
    }
  }

  /// Of [v; omega] and [f; m] the component along joint k.
  int index(int k) const { return robot.joints[k].is_prismatic() ? 2 : 5; }

  /// The joints between base and hand, outermost first.
  std::vector<int> joints_of_hand() const {
    std::vector<int> out;
    for (int k = robot.hand_body; k != kBase; k = robot.joints[k].parent) out.push_back(k);
    return out;
  }
  /// From the base centroid, in B, m.
  Vector3<S> hand_position() const {
    Vector3<S> r = robot.p_hand.template cast<S>();
    for (const int k : joints_of_hand()) r = outwards(k, r) + p[k];
    return r;
  }
  /// In B.
  Matrix3<S> hand_axes() const {
    Matrix3<S> R = robot.R_hand.template cast<S>();
    for (const int k : joints_of_hand()) {
      for (int i = 0; i < 3; ++i) R.col(i) = outwards(k, R.col(i));
    }
    return R;
  }
  /// A vector in B as one in the axes of the body that carries the hand.
  Vector3<S> in_hand_body(Vector3<S> x) const {
    const std::vector<int> chain = joints_of_hand();
    for (auto k = chain.rbegin(); k != chain.rend(); ++k) x = inwards(*k, x);
    return x;
  }

  /// A wrench on body k as one on its parent.
  Vector6<S> wrench_on_parent(int k, const Vector6<S>& wrench) const {
    Vector6<S> out;
    out << outwards(k, wrench.template head<3>()), outwards(k, wrench.template tail<3>());
    out.template tail<3>() += p[k].cross(Vector3<S>(out.template head<3>()));
    return out;
  }

  /// The twist of body k while joint k stands still, from its parent's.
  Vector6<S> twist_from_parent(int k, const Vector6<S>& twist) const {
    const Vector3<S> omega = twist.template tail<3>();
    Vector6<S> out;
    out << inwards(k, twist.template head<3>() + omega.cross(p[k])), inwards(k, omega);
    return out;
  }

 private:
  void move_to_parent(int k, const S& phi, BodyInertia<S>& inertia) const {
    if (!robot.joints[k].is_prismatic()) {
      const S twice = phi + phi;
      inertia.rotate_about_z(cosine[k], sine[k], cos(twice), sin(twice));
    }
    inertia.rotate(robot.joints[k].R.matrix());
    inertia.shift(p[k]);
  }

  /// Axes of body k to axes of its parent.
  Vector3<S> outwards(int k, const Vector3<S>& x) const {
    const S &c = cosine[k], &s = sine[k];
    const Vector3<S> rotated_about_z(x[0] * c - x[1] * s, x[0] * s + x[1] * c, x[2]);
    return rotated(robot.joints[k].R.matrix(), rotated_about_z);
  }
  Vector3<S> inwards(int k, const Vector3<S>& x) const {
    const S &c = cosine[k], &s = sine[k];
    const Vector3<S> rotated_about_z = rotated(robot.joints[k].R.matrix().transpose(), x);
    return Vector3<S>(rotated_about_z[0] * c + rotated_about_z[1] * s,
                      rotated_about_z[1] * c - rotated_about_z[0] * s, rotated_about_z[2]);
  }
};

extern template struct ArticulatedForms<Form<2>>;
extern template struct ArticulatedForms<Form<3>>;

}  // namespace stillbase::proof
