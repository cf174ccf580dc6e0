// The lines of inertia_kernel.hpp in wide registers.
#pragma once

#include "dynamics/wide_kinematics.hpp"

namespace stillbase {

namespace {

/// Mass in the last lane of h.
struct WideComposite {
  V h;
  Wide3x3 I;
};
[[gnu::always_inline]] inline void add(WideComposite& a, const WideComposite& b) {
  a.h += b.h;
  a.I.c0 += b.I.c0;
  a.I.c1 += b.I.c1;
  a.I.c2 += b.I.c2;
}
/// m, h, I; see store_row().
[[gnu::always_inline]] inline void store(double* p, const WideComposite& a, bool next) {
  store_row(p, lanes<3, 0, 1, 2>(a.h), true);
  store3x3(p + 4, a.I, next);
}

/// c with 1 in the last lane as the composite of a mass m at c.
[[gnu::always_inline]] inline WideComposite point_mass(double m, const V& c) {
  const V h = c * all(m);
  // -m skew(c)^2
  const V square = h * c;
  const V diagonal = lanes<1, 0, 0, 3>(square) + lanes<2, 2, 1, 3>(square);
  const V off = -lanes<0, 0, 1, 3>(h) * lanes<1, 2, 2, 3>(c);  // xy, xz, yz
  return {h,
          {lanes<0, 5, 6, 3>(diagonal, lanes<3, 0, 1, 3>(off)),
           lanes<4, 1, 6, 3>(diagonal, lanes<0, 3, 2, 3>(off)),
           lanes<4, 5, 2, 3>(diagonal, lanes<1, 2, 3, 3>(off))}};
}

/// What the inertia matrix is made of.
struct WideArm {
  V v[kWideRoom], w[kWideRoom];  ///< twists of unit rates about the base centroid
  V p[kWideRoom], L[kWideRoom];  ///< momenta of the subtrees under them
  WideComposite subtrees[kWideBodies], total;
  bool is_chain = true;

  /// @param pose_of(k) @param take_inertia(k, I) of body k about its own centroid
  template <class PoseOf, class TakeInertia>
  [[gnu::always_inline]] WideArm(const RobotModel& robot, const PoseOf& pose_of,
                                 const TakeInertia& take_inertia) {
    const Joint* const joints = &robot.joints[0];
    const Body* const bodies = &robot.bodies[0];
    const auto n = static_cast<int>(robot.bodies.size());
    total = {V{0, 0, 0, robot.base.mass}, load3x3(numbers(robot.base.inertia))};
    for (int k = 0; k < n; ++k) {
      const WidePose& pose = pose_of(k);
      const double* const own = numbers(bodies[k].inertia);
      const Wide3x3& R = pose.R;
      const double* const rows = numbers(R.c0);
      const Wide3x3 RI = {times(R, own), times(R, own + 3), times(R, own + 6)};
      const Wide3x3 I = {times(RI, rows, 4), times(RI, rows + 1, 4), times(RI, rows + 2, 4)};
      take_inertia(k, I);
      subtrees[k] = point_mass(bodies[k].mass, lanes<0, 1, 2, 7>(pose.c, all(1)));
      subtrees[k].I.c0 += I.c0;
      subtrees[k].I.c1 += I.c1;
      subtrees[k].I.c2 += I.c2;
      if (joints[k].type == JointType::Prismatic) {
        v[k] = R.c2;
        w[k] = all(0);
      } else {
        v[k] = cross(pose.o, R.c2);
        w[k] = R.c2;
      }
    }
    for (int k = n - 1; k >= 0; --k) {
      const WideComposite& subtree = subtrees[k];
      p[k] = v[k] * all_of<3>(subtree.h) + cross(w[k], subtree.h);
      L[k] = cross(subtree.h, v[k]) + times(subtree.I, numbers(w[k]));
      const int parent = joints[k].parent;
      add(parent == kBase ? total : subtrees[parent], subtree);
      is_chain = is_chain && parent == k - 1;
    }
  }
};

/// The robot as one body, about its centroid.
struct WideWhole {
  V r_bg;  ///< the centroid
  double inverse_mass;
  Wide3x3 Htilde_omega;

  [[gnu::always_inline]] explicit WideWhole(const WideComposite& total) {
    const double mass = total.h[3];
    inverse_mass = 1 / mass;
    r_bg = total.h * all(inverse_mass);
    const Wide3x3 of_mass = point_mass(mass, r_bg).I;
    Htilde_omega = {total.I.c0 - of_mass.c0, total.I.c1 - of_mass.c1, total.I.c2 - of_mass.c2};
  }
  /// Velocity of the base centroid. @param p linear momentum that the robot gets by its base
  [[gnu::always_inline]] V base_velocity(const V& p, const V& omega) const {
    return p * all(inverse_mass) - cross(omega, r_bg);
  }
};

/// As Joint::reflected_inertia(), which is not for this file.
[[gnu::always_inline]] inline double reflected(const Joint& joint) {
  return joint.gear_ratio * joint.gear_ratio * joint.rotor_inertia;
}

/// A symmetric matrix of the joints, column by column.
struct WideMatrix {
  alignas(V) double columns[kWideRoom][kWideRoom];

  V& rows(int j, int from) { return reinterpret_cast<V&>(columns[j][from]); }
};

/// H_phi - p' p / m, p the linear momenta of unit rates; the entries from n on are of no use.
/// @param inverse_mass 1 / m; 0: H_phi
[[gnu::always_inline]] inline void fill(const RobotModel& robot, const WideArm& arm,
                                        double inverse_mass, WideMatrix& H) {
  const Joint* const joints = &robot.joints[0];
  const auto n = static_cast<int>(robot.bodies.size());
  V p[kWideRoom], L[kWideRoom];  // the rows of four columns
  for (int k = 0; k < n; k += 4) {
    for (int i = k; i < k + 4; ++i) {
      p[i] = i < n ? arm.p[i] : all(0);
      L[i] = i < n ? arm.L[i] : all(0);
    }
    transpose(p + k);
    transpose(L + k);
  }
  for (int j = 0; j < n; j += 4) {
    for (int k = j; k < n; k += 4) {
      V block[4], transposed[4];
      for (int i = 0; i < 4; ++i) {
        const int column = std::min(j + i, n - 1);
        const V v = arm.v[column] - arm.p[column] * all(inverse_mass);
        const double* const w = numbers(arm.w[column]);
        block[i] = (all_of<0>(v) * p[k] + (all_of<1>(v) * p[k + 1] + all_of<2>(v) * p[k + 2])) +
                   (all(w[0]) * L[k] + (all(w[1]) * L[k + 1] + all(w[2]) * L[k + 2]));
        transposed[i] = block[i];
      }
      transpose(transposed);
      if (k == j) {  // what is above the diagonal is that below it
        block[1] = lanes<4, 1, 2, 3>(block[1], transposed[1]);
        block[2] = lanes<4, 5, 2, 3>(block[2], transposed[2]);
        block[3] = lanes<4, 5, 6, 3>(block[3], transposed[3]);
      } else {
        for (int i = 0; i < 4; ++i) H.rows(k + i, j) = transposed[i];
      }
      for (int i = 0; i < 4; ++i) H.rows(j + i, k) = block[i];
    }
  }
  // Of joints in different branches H_phi has nothing.
  for (int k = 0; k < n && !arm.is_chain; ++k) {
    int ancestor = joints[k].parent;
    for (int j = k - 1; j >= 0; --j) {
      if (j == ancestor) {
        ancestor = joints[j].parent;
      } else {
        H.columns[j][k] = H.columns[k][j] = 0 - inverse_mass * sum(arm.p[j] * arm.p[k]);
      }
    }
  }
  for (int j = 0; j < n; ++j) {
    const Joint& joint = joints[j];
    if (joint.rotor_inertia != 0) H.columns[j][j] += reflected(joint);
  }
}

void wide_inertia(const RobotModel& robot, const KnownWidePoses& poses, const WideInertia& out) {
  const auto n = static_cast<int>(robot.bodies.size());
  WidePose pose;
  const WideArm arm(
      robot,
      [&](int k) -> const WidePose& {
        pose = {load3x3(poses.R + 9 * k), load3(poses.o + 3 * k), load3(poses.c + 3 * k)};
        return pose;
      },
      [&](int k, const Wide3x3& I) { store3x3(out.I + 9 * k, I, k + 1 < n); });
  for (int k = 0; k < n; ++k) {
    const bool next = k + 1 < n;
    store_row(out.H_bphi + 6 * k, arm.p[k], true);
    store_row(out.H_bphi + 6 * k + 3, arm.L[k], next);
    store(out.subtree + 13 * k, arm.subtrees[k], next);
  }
  store(out.total, arm.total, false);
  WideMatrix H;
  fill(robot, arm, 0, H);
  // As in store_row().
  for (int j = 0; j < n; ++j) {
    for (int k = 0; k < n; k += 4) {
      const int at = n * j + k;
      store_some(out.H_phi + at, H.rows(j, k), n * n - at);
    }
  }
}

}  // namespace

}  // namespace stillbase
