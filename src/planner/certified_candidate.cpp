#include "planner/certified_candidate.hpp"

#include <algorithm>

#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/nlp/certificate.hpp>

#include "formulation/measures/measure.hpp"

namespace stillbase {

CertifiedCandidate certify_candidate(const CaptureProblem& problem, const Eigen::VectorXd& x,
                                     const Candidate& candidate, const Certificate& certificate) {
  const Formulation formulation(problem);
  Measure measure(problem, formulation);
  CertifiedCandidate out{candidate, certificate, formulation.report(x)};
  out.candidate.configuration = formulation.configuration(x);
  out.candidate.objective = nominal_value(problem, formulation, out.candidate.configuration);
  out.candidate.worst_case = worst_case(problem, formulation, out.candidate.configuration).value;
  out.candidate.value = measure.reported(x);
  out.candidate.max_violation = 0;
  for (const ConstraintValue& value : out.constraints) {
    out.candidate.max_violation = std::max(out.candidate.max_violation, value.violation);
  }
  out.certificate.max_violation = out.candidate.max_violation;
  const nlp::Certificate kkt = measure.certify(x);
  out.certificate.kkt_residual = kkt.kkt_residual;
  out.certificate.reduced_hessian_min_eigenvalue = kkt.reduced_hessian_min_eigenvalue;
  return out;
}

}  // namespace stillbase
