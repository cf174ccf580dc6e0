#include <stillbase/impact/cases.hpp>

namespace stillbase {

std::string to_string(ImpactCase impact_case) {
  switch (impact_case) {
    case ImpactCase::G1:
      return "G1";
    case ImpactCase::G2:
      return "G2";
    case ImpactCase::G3:
      return "G3";
    case ImpactCase::C1:
      return "C1";
    case ImpactCase::C2:
      return "C2";
  }
  return "";
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
