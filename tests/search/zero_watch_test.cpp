// Zeros of the objective that local solves come close to.
#include <catch2/catch.hpp>

#include <algorithm>

#include <stillbase/core/random.hpp>
#include <stillbase/nlp/certificate.hpp>

#include "formulation/projection.hpp"
#include "search/zero_watch.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

/// Postures that satisfy the constraints.
std::vector<Eigen::VectorXd> starts_of(const Formulation& formulation, int count) {
  std::vector<Eigen::VectorXd> out;
  for (int i = 0; static_cast<int>(out.size()) < count; ++i) {
    const Eigen::VectorXd u = low_discrepancy_point(i, formulation.num_variables(), 3);
    const ProjectionResult end =
        project_onto_constraints(formulation, formulation.start_point(u), false, 15);
    if (end.violation <= 1e-9) out.push_back(end.x);
  }
  return out;
}

}  // namespace

TEST_CASE("solves after a latch end as they do, in fewer evaluations where they end at a zero") {
  const Formulation formulation(test::without_path("deos_latch"));
  const auto optimizer = nlp::make_optimizer("nlopt-slsqp");
  int zeros_alone = 0, zeros = 0;
  long alone = 0, watched = 0;
  for (const Eigen::VectorXd& from : starts_of(formulation, 32)) {
    const long before = formulation.evaluations();
    const nlp::OptimizeResult first = optimizer->minimize(formulation, from);
    const long between = formulation.evaluations();
    const Eigen::VectorXd x = minimize_to_zero(*optimizer, formulation, from, {}).x;
    if (first.objective < 1e-14) {
      alone += between - before;
      watched += formulation.evaluations() - between;
    }
    const nlp::Certificate certificate = nlp::certify(formulation, x);
    CHECK(certificate.max_violation <= 1e-9);
    CHECK(certificate.kkt_residual <= std::max(1e-6, first.certificate.kkt_residual));
    nlp::Evaluation here;
    formulation.evaluate(x, here);
    zeros_alone += first.objective < 1e-14;
    zeros += here.objective < 1e-14;
  }
  CAPTURE(zeros_alone, zeros, alone, watched);
  CHECK(zeros >= 8);
  CHECK(zeros >= zeros_alone);
  CHECK(static_cast<double>(watched) < 0.8 * static_cast<double>(alone));
}

TEST_CASE("a zero is found with inequalities active, and none where there is none") {
  const Formulation formulation(test::without_path("deos_latch"));
  const auto optimizer = nlp::make_optimizer("nlopt-slsqp");
  int found = 0, at_limits = 0;
  for (const Eigen::VectorXd& from : starts_of(formulation, 16)) {
    nlp::OptimizeOptions some;
    some.max_evaluations = 80;
    const auto zero = zero_near(formulation, optimizer->minimize(formulation, from, some).x);
    if (!zero) continue;
    ++found;
    nlp::Evaluation here;
    formulation.evaluate(*zero, here);
    CHECK(here.objective <= 1e-20);
    const Eigen::VectorXd lower = formulation.constraint_lower();
    const Eigen::VectorXd upper = formulation.constraint_upper();
    CHECK(nlp::signed_violation(here.constraints, lower, upper).lpNorm<Eigen::Infinity>() <= 1e-9);
    CHECK((zero->array() >= formulation.lower().array()).all());
    CHECK((zero->array() <= formulation.upper().array()).all());
    for (Eigen::Index i = 0; i < lower.size(); ++i) {
      at_limits += lower[i] != upper[i] && here.constraints[i] - lower[i] < 1e-9;
    }
  }
  CHECK(found >= 3);
  CHECK(at_limits >= 1);

  // The base keeps some of the momentum in every posture.
  CaptureProblem without = test::without_path("iiwa_client_50");
  without.impulse.contact = ContactLaw::Latch;
  without.impulse.restitution = 0;
  without.uncertainty.cone_half_angle = 0;
  without.measure.kind = RiskMeasure::Nominal;
  const Formulation other(without);
  for (const Eigen::VectorXd& from : starts_of(other, 4)) CHECK_FALSE(zero_near(other, from));
}

}  // namespace stillbase
