// The lever arm against which the momenta of an impact are measured.
#pragma once

#include <stillbase/core/types.hpp>

namespace stillbase {

/// Whether hand and system centroid meet, to the tolerance of the cases: the total that an impulse
/// at the hand changes is zero by that whatever its direction, and relative to |f| |r_gh| it would
/// be rounding.
/// @param r_bh, r_bg hand and system centroid, from the base centroid, in B, m
inline bool is_at_centroid(const Vector3d& r_bh, const Vector3d& r_bg) {
  constexpr double kMeet = 1e-6;  // of what r_gh is the difference of
  return (r_bh - r_bg).norm() <= kMeet * (r_bh.norm() + r_bg.norm());
}

/// |r_gh|; where hand and centroid meet |r_bh| + |r_bg|: the total vanishes there while base part
/// and coupling part, each the other's opposite, do not.
inline double case_lever(const Vector3d& r_bh, const Vector3d& r_bg) {
  return is_at_centroid(r_bh, r_bg) ? r_bh.norm() + r_bg.norm() : (r_bh - r_bg).norm();
}

}  // namespace stillbase
