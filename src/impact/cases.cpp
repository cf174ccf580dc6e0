#include <stillbase/impact/cases.hpp>

namespace stillbase {

std::string to_string(ImpactCase impact_case) {
  constexpr const char* kNames[] = {"G1", "G2", "G3", "C1", "C2"};
  return kNames[static_cast<std::size_t>(impact_case)];
}

bool is_at_centroid(const Vector3d& r_bh, const Vector3d& r_bg) {
  constexpr double kCoincident = 1e-6;  // of what r_gh is the difference of
  return (r_bh - r_bg).norm() <= kCoincident * (r_bh.norm() + r_bg.norm());
}

double case_lever(const Vector3d& r_bh, const Vector3d& r_bg) {
  return is_at_centroid(r_bh, r_bg) ? r_bh.norm() + r_bg.norm() : (r_bh - r_bg).norm();
}

CaseJudgement judge_case(const Vector3d& total, const Vector3d& base, const Vector3d& coupling,
                         double scale, double tolerance) {
  CaseJudgement out;
  out.tolerance = tolerance;
  const double unit = scale > 0 ? scale : 1;
  out.total = total.norm() / unit;
  out.base = base.norm() / unit;
  out.coupling = coupling.norm() / unit;
  const bool zero_total = out.total <= tolerance;
  const bool zero_base = out.base <= tolerance;
  const bool zero_coupling = out.coupling <= tolerance;
  if (zero_base && zero_coupling) {
    out.impact_case = ImpactCase::C2;
  } else if (zero_total) {
    out.impact_case = ImpactCase::C1;
  } else if (zero_base) {
    out.impact_case = ImpactCase::G2;
  } else if (zero_coupling) {
    out.impact_case = ImpactCase::G3;
  }
  return out;
}

}  // namespace stillbase
