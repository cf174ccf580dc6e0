// The lever arm against which the momenta of an impact are measured.
#pragma once

#include <stillbase/core/types.hpp>

namespace stillbase {

/// Whether hand and system centroid coincide, to the tolerance of the cases. Then an impulse at the
/// hand changes no total momentum whatever its direction, and relative to |f| |r_gh| the total is
/// rounding.
/// @param r_bh, r_bg hand and system centroid, from the base centroid, in B, m
inline bool is_at_centroid(const Vector3d& r_bh, const Vector3d& r_bg) {
  constexpr double kCoincident = 1e-6;  // of what r_gh is the difference of
  return (r_bh - r_bg).norm() <= kCoincident * (r_bh.norm() + r_bg.norm());
}

/// |r_gh|, or |r_bh| + |r_bg| where hand and centroid coincide: there the total vanishes, while
/// base part and coupling part are opposite and do not.
inline double case_lever(const Vector3d& r_bh, const Vector3d& r_bg) {
  return is_at_centroid(r_bh, r_bg) ? r_bh.norm() + r_bg.norm() : (r_bh - r_bg).norm();
}

}  // namespace stillbase
