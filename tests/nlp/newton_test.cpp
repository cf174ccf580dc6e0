#include "nlp/newton.hpp"

#include <catch2/catch.hpp>

#include "nlp/known_problems.hpp"

namespace stillbase::nlp {
namespace {

KnownProblem plane(KnownProblem::Model model) {
  KnownProblem p;
  p.start = vec({0, 0});
  p.l = vec({-1, -1});
  p.u = vec({1, 1});
  p.model = std::move(model);
  return p;
}

TEST_CASE("Newton's method ends at the minimiser from nearby, with and without a Hessian") {
  for (KnownProblem p : known_problems()) {
    for (const bool has_hessian : {true, false}) {
      if (!has_hessian) p.hessian = {};
      for (const Eigen::VectorXd& minimiser : p.minimisers) {
        CAPTURE(p.name, has_hessian);
        Eigen::VectorXd from = minimiser;
        for (Eigen::Index j = 0; j < from.size(); ++j) from[j] += j % 2 == 0 ? 1e-6 : -2e-6;
        from = from.cwiseMax(p.l).cwiseMin(p.u);
        const Certificate before = certify(p, from);
        const Eigen::VectorXd end = end_by_newton(p, from, from.size());
        const Certificate after = certify(p, end);
        CHECK(before.kkt_residual + before.max_violation > 1e-8);
        CHECK(after.kkt_residual < 1e-9);
        CHECK(after.max_violation < 1e-9);
        CHECK((end - minimiser).norm() < 1e-5);
      }
    }
  }
}

TEST_CASE("Newton's method leaves a point beside a saddle where it is") {
  const KnownProblem p = plane([](const Eigen::VectorXd& x, Evaluation& e) {
    e.objective = x[0] * x[0] - x[1] * x[1];
    e.gradient << 2 * x[0], -2 * x[1];
  });
  const Eigen::VectorXd from = vec({1e-4, 1e-4});
  CHECK(end_by_newton(p, from, 2) == from);
}

TEST_CASE("Newton's method does not move along a valley's floor") {
  const KnownProblem p = plane([](const Eigen::VectorXd& x, Evaluation& e) {
    e.objective = (x[0] + x[1]) * (x[0] + x[1]) / 2;
    e.gradient.setConstant(x[0] + x[1]);
  });
  const Eigen::VectorXd end = end_by_newton(p, vec({0.001, 0.002}), 2);
  CHECK(end[0] + end[1] == Approx(0).margin(1e-12).epsilon(0));
  CHECK(end[1] - end[0] == Approx(0.001).epsilon(1e-9));
}

}  // namespace
}  // namespace stillbase::nlp
