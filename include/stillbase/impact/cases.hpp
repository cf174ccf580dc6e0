// The paper's cases of an impact: which of the angular momenta stay unchanged.
#pragma once

#include <string>

#include <stillbase/core/types.hpp>

namespace stillbase {

enum class ImpactCase {
  G1,  ///< total, base part and coupling part all change
  G2,  ///< base part zero: the base does not start to rotate
  G3,  ///< coupling part zero
  C1,  ///< total zero, parts opposite
  C2   ///< all three zero
};

std::string to_string(ImpactCase impact_case);

/// Default of the tolerance below which a momentum counts as zero, relative to |f| |r_gh| + |t|.
inline constexpr double kCaseTolerance = 1e-6;

struct CaseJudgement {
  ImpactCase impact_case = ImpactCase::G1;
  double tolerance = kCaseTolerance;
  double total = 0;     ///< |Delta L_g| / scale
  double base = 0;      ///< |Htilde_omega Delta omega| / scale
  double coupling = 0;  ///< |Htilde_omegaphi Delta phidot| / scale
};

/// Whether hand and system centroid coincide, to the tolerance of the cases. Then an impulse at the
/// hand changes no total momentum whatever its direction, and relative to |f| |r_gh| the total is
/// rounding.
/// @param r_bh, r_bg hand and system centroid, from the base centroid, in B, m
bool is_at_centroid(const Vector3d& r_bh, const Vector3d& r_bg);

/// |r_gh|, or |r_bh| + |r_bg| where hand and centroid coincide: there the total vanishes, while
/// base part and coupling part are opposite and do not.
double case_lever(const Vector3d& r_bh, const Vector3d& r_bg);

/// @param scale |f| |r_gh| + |t|, N m s. Zero scale (no impulse, or at the centroid): all residuals
/// 0.
CaseJudgement judge_case(const Vector3d& total, const Vector3d& base, const Vector3d& coupling,
                         double scale, double tolerance = kCaseTolerance);

}  // namespace stillbase
