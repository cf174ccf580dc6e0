// The lines of kinematics_kernel.hpp and inertia_kernel.hpp, a vector of three numbers in a
// register of four, for the instruction set that the source file is compiled for.
#pragma once

#include "core/pack.hpp"
#include "dynamics/wide_kernel.hpp"

namespace stillbase {

namespace {

/// In plain vectors: of a class around them the compiler keeps copies in memory.
typedef Pack<4>::Lanes V;

/// Lanes of a by their numbers; 4 to 7: those of b.
template <int i, int j, int k, int l>
[[gnu::always_inline]] inline V lanes(const V& a, const V& b) {
  return __builtin_shufflevector(a, b, i, j, k, l);
}
template <int i, int j, int k, int l>
[[gnu::always_inline]] inline V lanes(const V& a) {
  return lanes<i, j, k, l>(a, a);
}

[[gnu::always_inline]] inline V load3(const double* p, double last = 0) {
  Pack<2>::Lanes low;
  std::memcpy(&low, p, sizeof(low));
  return __builtin_shufflevector(low, Pack<2>::Lanes{p[2], last}, 0, 1, 2, 3);
}
[[gnu::always_inline]] inline void store3(double* p, const V& a) {
  const Pack<2>::Lanes low = __builtin_shufflevector(a, a, 0, 1);
  std::memcpy(p, &low, sizeof(low));
  p[2] = a[2];
}

[[gnu::always_inline]] inline V all(double x) { return V{x, x, x, x}; }
/// The fourth lane is zero.
[[gnu::always_inline]] inline V cross(const V& a, const V& b) {
  const V turned = a * lanes<1, 2, 0, 3>(b) - lanes<1, 2, 0, 3>(a) * b;
  return lanes<1, 2, 0, 3>(turned);
}

/// Columns.
struct Wide3x3 {
  V c0, c1, c2;
};
[[gnu::always_inline]] inline Wide3x3 load3x3(const double* p) {
  return {load3(p), load3(p + 3), load3(p + 6)};
}
[[gnu::always_inline]] inline void store3x3(double* p, const Wide3x3& M) {
  store3(p, M.c0);
  store3(p + 3, M.c1);
  store3(p + 6, M.c2);
}
/// M x. @param stride between the entries of x
[[gnu::always_inline]] inline V times(const Wide3x3& M, const double* x, int stride = 1) {
  return M.c0 * all(x[0]) + (M.c1 * all(x[stride]) + M.c2 * all(x[2 * stride]));
}
/// The rows of four columns.
[[gnu::always_inline]] inline void transpose(V* c) {
  const V low01 = lanes<0, 4, 2, 6>(c[0], c[1]), high01 = lanes<1, 5, 3, 7>(c[0], c[1]);
  const V low23 = lanes<0, 4, 2, 6>(c[2], c[3]), high23 = lanes<1, 5, 3, 7>(c[2], c[3]);
  c[0] = lanes<0, 1, 4, 5>(low01, low23);
  c[1] = lanes<0, 1, 4, 5>(high01, high23);
  c[2] = lanes<2, 3, 6, 7>(low01, low23);
  c[3] = lanes<2, 3, 6, 7>(high01, high23);
}

const double* numbers(const Matrix3d& M) { return reinterpret_cast<const double*>(&M); }
const double* numbers(const Vector3d& v) { return reinterpret_cast<const double*>(&v); }
const double* numbers(const V& v) { return reinterpret_cast<const double*>(&v); }

void wide_kinematics(const RobotModel& robot, const double* positions, const double* sine,
                     const double* cosine, const WidePoses& out) {
  Wide3x3 frames[kWideBodies];
  V origins[kWideBodies];
  const Joint* const joints = &robot.tree()[0];
  const Body* const bodies = &robot.bodies[0];
  const auto n = static_cast<int>(robot.bodies.size());
  for (int k = 0; k < n; ++k) {
    const Joint& joint = joints[k];
    const double* const fixed = numbers(joint.R);
    Wide3x3 A;
    V o;
    if (joint.parent == kBase) {
      A = load3x3(fixed);
      o = load3(numbers(joint.p));
    } else {
      const Wide3x3 parent = frames[joint.parent];
      A = {times(parent, fixed), times(parent, fixed + 3), times(parent, fixed + 6)};
      o = origins[joint.parent] + times(parent, numbers(joint.p));
    }
    if (joint.type == JointType::Prismatic) {
      o += A.c2 * all(positions[k]);
    } else {
      const V c = all(cosine[k]), s = all(sine[k]);
      A = {A.c0 * c + A.c1 * s, A.c1 * c - A.c0 * s, A.c2};
    }
    frames[k] = A;
    origins[k] = o;
    store3x3(out.R + 9 * k, A);
    store3(out.o + 3 * k, o);
    store3(out.c + 3 * k, o + times(A, numbers(bodies[k].centroid)));
  }
}

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
/// m, h, I.
[[gnu::always_inline]] inline void store(double* p, const WideComposite& a) {
  p[0] = a.h[3];
  store3(p + 1, a.h);
  store3x3(p + 4, a.I);
}

/// Of a body about the base centroid. @param I about its own centroid @param c its centroid
[[gnu::always_inline]] inline WideComposite about_base(double m, const Wide3x3& I,
                                                       const double* c) {
  const V c1 = load3(c, 1);
  const V h = c1 * all(m);
  // -m skew(c)^2
  const V square = h * c1;
  const V diagonal = lanes<1, 0, 0, 3>(square) + lanes<2, 2, 1, 3>(square);
  const V off = -lanes<0, 0, 1, 3>(h) * lanes<1, 2, 2, 3>(c1);  // xy, xz, yz
  return {h,
          {I.c0 + lanes<0, 5, 6, 3>(diagonal, lanes<3, 0, 1, 3>(off)),
           I.c1 + lanes<4, 1, 6, 3>(diagonal, lanes<0, 3, 2, 3>(off)),
           I.c2 + lanes<4, 5, 2, 3>(diagonal, lanes<1, 2, 3, 3>(off))}};
}

void wide_inertia(const RobotModel& robot, const KnownWidePoses& poses, const WideInertia& out) {
  constexpr int kRoom = (kWideBodies + 3) / 4 * 4;
  const Joint* const joints = &robot.joints[0];
  const Body* const bodies = &robot.bodies[0];
  const auto n = static_cast<int>(robot.bodies.size());
  WideComposite subtrees[kWideBodies];
  WideComposite total = {V{0, 0, 0, robot.base.mass}, load3x3(numbers(robot.base.inertia))};
  V v[kRoom], w[kRoom];  // twists of unit rates about the base centroid
  V p[kRoom], L[kRoom];  // momenta of the subtrees under them
  for (int k = 0; k < n; ++k) {
    const double* const rows = poses.R + 9 * k;
    const double* const own = numbers(bodies[k].inertia);
    const Wide3x3 R = load3x3(rows);
    const Wide3x3 RI = {times(R, own), times(R, own + 3), times(R, own + 6)};
    const Wide3x3 I = {times(RI, rows, 3), times(RI, rows + 1, 3), times(RI, rows + 2, 3)};
    store3x3(out.I + 9 * k, I);
    subtrees[k] = about_base(bodies[k].mass, I, poses.c + 3 * k);
    if (joints[k].type == JointType::Prismatic) {
      v[k] = R.c2;
      w[k] = all(0);
    } else {
      v[k] = cross(load3(poses.o + 3 * k), R.c2);
      w[k] = R.c2;
    }
  }
  bool is_chain = true;
  for (int k = n - 1; k >= 0; --k) {
    const WideComposite& subtree = subtrees[k];
    p[k] = v[k] * lanes<3, 3, 3, 3>(subtree.h) + cross(w[k], subtree.h);
    L[k] = cross(subtree.h, v[k]) + times(subtree.I, numbers(w[k]));
    store3(out.H_bphi + 6 * k, p[k]);
    store3(out.H_bphi + 6 * k + 3, L[k]);
    store(out.subtree + 13 * k, subtree);
    const int parent = joints[k].parent;
    add(parent == kBase ? total : subtrees[parent], subtree);
    is_chain = is_chain && parent == k - 1;
  }
  store(out.total, total);

  // Column j, four rows at a time. What is above the diagonal is overwritten; beyond the end of a
  // column begins the next one, whose turn comes.
  for (int k = n; k % 4 != 0; ++k) p[k] = L[k] = all(0);
  for (int k = 0; k < n; k += 4) {
    transpose(p + k);
    transpose(L + k);
  }
  for (int j = 0; j < n; ++j) {
    double* const column = out.H_phi + n * j;
    const double *const vj = numbers(v[j]), *const wj = numbers(w[j]);
    for (int k = j & ~3; k < n; k += 4) {
      const V entries = (all(vj[0]) * p[k] + (all(vj[1]) * p[k + 1] + all(vj[2]) * p[k + 2])) +
                        (all(wj[0]) * L[k] + (all(wj[1]) * L[k + 1] + all(wj[2]) * L[k + 2]));
      if (k + 4 <= n || j + 1 < n) {
        std::memcpy(column + k, &entries, sizeof(entries));
      } else {
        for (int i = 0; k + i < n; ++i) column[k + i] = entries[i];
      }
    }
  }
  // Of joints in different branches nothing.
  for (int k = 0; k < n && !is_chain; ++k) {
    int ancestor = joints[k].parent;
    for (int j = k - 1; j >= 0; --j) {
      if (j == ancestor) {
        ancestor = joints[j].parent;
      } else {
        out.H_phi[k + n * j] = 0;
      }
    }
  }
  for (int j = 0; j < n; ++j) {
    const Joint& joint = joints[j];
    if (joint.rotor_inertia != 0) {
      out.H_phi[j + n * j] += joint.gear_ratio * joint.gear_ratio * joint.rotor_inertia;
    }
    for (int k = j + 1; k < n; ++k) out.H_phi[j + n * k] = out.H_phi[k + n * j];
  }
}

}  // namespace

}  // namespace stillbase
