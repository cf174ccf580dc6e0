// Number and matrix types that every other room uses.
#pragma once

#include <cstddef>

#include <Eigen/Core>

#include <stillbase/core/in_place.hpp>

// The alignment and allocation of Eigen's matrices are part of the binary interface. -march=native
// and sanitizers change them, and objects would be freed in another way than they were allocated.
static_assert(EIGEN_MAX_STATIC_ALIGN_BYTES == 16 && EIGEN_MALLOC_ALREADY_ALIGNED == 1,
              "stillbase, OMPL and FCL align Eigen's matrices by 16 bytes and use plain malloc: "
              "compile everything with -D EIGEN_MAX_ALIGN_BYTES=16 "
              "-D EIGEN_MALLOC_ALREADY_ALIGNED=1, which the target stillbase::stillbase brings");

namespace stillbase {

/// Largest number of movable joints; a robot with more joints is refused.
inline constexpr int kMaxJoints = 64;

/// The same for each number type of the kernel: wide numbers take a smaller bound, or their
/// matrices would not fit on the stack.
template <class S>
inline constexpr int kMaxJointsOf = kMaxJoints;

/// Up to this number of joints, what grows with the bodies or with the square of the joints is kept
/// in place, so that nothing below the search allocates. Robots beyond use the heap for it.
template <class S>
inline constexpr int kJointsInPlace = kMaxJointsOf<S> < 20 ? kMaxJointsOf<S> : 20;

template <class S>
using Vector3 = Eigen::Matrix<S, 3, 1>;
template <class S>
using Vector6 = Eigen::Matrix<S, 6, 1>;
template <class S>
using Matrix3 = Eigen::Matrix<S, 3, 3>;
template <class S>
using Matrix6 = Eigen::Matrix<S, 6, 6>;

/// One number per joint (n).
template <class S>
using JointVector = Eigen::Matrix<S, Eigen::Dynamic, 1, Eigen::ColMajor, kMaxJointsOf<S>, 1>;
/// n x n.
template <class S>
using JointMatrix = InPlaceMatrix<S, kJointsInPlace<S>>;
/// 3 x n.
template <class S>
using Matrix3X = Eigen::Matrix<S, 3, Eigen::Dynamic, Eigen::ColMajor, 3, kMaxJointsOf<S>>;
/// 6 x n.
template <class S>
using Matrix6X = Eigen::Matrix<S, 6, Eigen::Dynamic, Eigen::ColMajor, 6, kMaxJointsOf<S>>;

/// One T per body that a joint moves.
template <class T, class S>
using PerBody = InPlaceArray<T, static_cast<std::size_t>(kJointsInPlace<S>)>;

using Vector3d = Vector3<double>;
using Vector6d = Vector6<double>;
using Matrix3d = Matrix3<double>;
using Matrix6d = Matrix6<double>;
using JointVectord = JointVector<double>;
using JointMatrixd = JointMatrix<double>;
using Matrix3Xd = Matrix3X<double>;
using Matrix6Xd = Matrix6X<double>;

}  // namespace stillbase
