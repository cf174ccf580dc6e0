// Curves of solutions, against Newton's method from postures all over the place.
#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>

#include <stillbase/core/random.hpp>
#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/search/search.hpp>

#include "formulation/projection.hpp"
#include "search/solution_curve.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

/// Three joints and the two equations of case C2 in the plane; the hand may be anywhere.
CaptureProblem three_link_c2() {
  CaptureProblem problem = test::shipped("planar_three_link_null");
  problem.hand.constraint = HandConstraint::None;
  problem.variables.base_position = PositionFreedom::Free;
  problem.constraints.impact_case = CaseConstraint::C2;
  problem.measure.kind = RiskMeasure::Nominal;
  return problem;
}

SearchResult solutions_of(const CaptureProblem& problem, const Formulation& formulation,
                          std::function<bool(const Configuration&)> is_free = {}) {
  SearchOptions options;
  options.max_candidates = 200;
  options.is_free = std::move(is_free);
  return search(problem, formulation, options);
}

/// One curve for each continuum of a result.
std::vector<SolutionCurve> curves_of(const Formulation& formulation, const SearchResult& result) {
  std::vector<SolutionCurve> curves(result.families.size());
  for (std::size_t i = 0; i < result.candidates.size(); ++i) {
    const int family = result.candidates[i].family;
    if (family < 0 || !curves[static_cast<std::size_t>(family)].points.empty()) continue;
    const auto curve = trace_curve(formulation, result.points[i], {});
    REQUIRE(curve);
    curves[static_cast<std::size_t>(family)] = *curve;
  }
  return curves;
}

/// Solutions that Newton's method finds from `count` postures of a sequence of its own.
std::vector<Eigen::VectorXd> solutions_elsewhere(const Formulation& formulation, int count) {
  std::vector<Eigen::VectorXd> found;
  for (int i = 0; i < count; ++i) {
    const Eigen::VectorXd start =
        formulation.start_point(low_discrepancy_point(i, formulation.num_variables(), 99));
    const ProjectionResult there = project_onto_constraints(formulation, start, true, 60);
    if (there.violation <= 1e-12) found.push_back(there.x);
  }
  return found;
}

}  // namespace

TEST_CASE("C2 postures of a planar arm of three links: every one is on a curve that was followed") {
  const CaptureProblem problem = three_link_c2();
  const Formulation formulation(problem);
  const SearchResult result = solutions_of(problem, formulation);
  REQUIRE(result.families.size() >= 2);
  for (const SolutionFamily& family : result.families) CHECK(family.is_complete);
  const std::vector<SolutionCurve> curves = curves_of(formulation, result);
  const std::vector<Eigen::VectorXd> elsewhere = solutions_elsewhere(formulation, 300);
  REQUIRE(elsewhere.size() > 200);
  for (const Eigen::VectorXd& x : elsewhere) {
    const auto on = std::count_if(curves.begin(), curves.end(), [&](const SolutionCurve& curve) {
      return place_on(formulation, curve, x).has_value();
    });
    CHECK(on == 1);
  }
}

TEST_CASE("the best candidate of the curves has the smallest worst case of all their postures") {
  const CaptureProblem problem = three_link_c2();
  const Formulation formulation(problem);
  const SearchResult result = solutions_of(problem, formulation);
  const double best = result.candidates.front().worst_case;
  double least = kInfinity;
  for (const Eigen::VectorXd& x : solutions_elsewhere(formulation, 300)) {
    least = std::min(least, worst_case(problem, formulation, formulation.configuration(x)).value);
  }
  for (const SolutionCurve& curve : curves_of(formulation, result)) {
    for (int i = 0; i <= 1000; ++i) {
      const Eigen::VectorXd x = point_at(formulation, curve, curve.length * i / 1000);
      least = std::min(least, worst_case(problem, formulation, formulation.configuration(x)).value);
    }
  }
  CHECK(best <= least * (1 + 1e-9));
  CHECK(best >= least * (1 - 1e-3));
}

TEST_CASE("points of a curve are solutions, close to each other, and the curve is found again") {
  const CaptureProblem problem = three_link_c2();
  const Formulation formulation(problem);
  const SearchResult result = solutions_of(problem, formulation);
  for (const SolutionCurve& curve : curves_of(formulation, result)) {
    nlp::Evaluation at_x;
    double step = 0, violation = 0;
    for (std::size_t i = 0; i < curve.points.size(); ++i) {
      const CurvePoint& point = curve.points[i];
      formulation.evaluate_value(point.x, at_x);
      for (const ConstraintValue& value : formulation.report(point.x)) {
        violation = std::max(violation, value.violation);
      }
      if (i > 0) step = std::max(step, (point.x - curve.points[i - 1].x).norm());
    }
    CHECK(violation <= 1e-11);
    CHECK(step <= 0.055);
    if (curve.is_closed) {
      const Eigen::VectorXd back = curve.points.front().x - curve.points.back().x;
      CHECK(formulation.normalised(back).norm() <= 0.055);
    }
    // From another point of it: as long, and the first one is on it.
    const Eigen::VectorXd other = point_at(formulation, curve, 0.4321 * curve.length);
    const auto again = trace_curve(formulation, other, {});
    REQUIRE(again);
    CHECK(again->is_closed == curve.is_closed);
    CHECK(again->length == Approx(curve.length).epsilon(2e-3));
    CHECK(place_on(formulation, *again, curve.points.front().x).has_value());
  }
}

TEST_CASE("a curve ends where a joint reaches its limit") {
  CaptureProblem problem = three_link_c2();
  for (Joint& joint : problem.robot.joints) {
    joint.type = JointType::Revolute;
    joint.lower = -1.2;
    joint.upper = 1.4;
  }
  const Formulation formulation(problem);
  const SearchResult result = solutions_of(problem, formulation);
  REQUIRE(!result.families.empty());
  bool has_open_one = false;
  for (const SolutionCurve& curve : curves_of(formulation, result)) {
    CHECK(curve.is_complete);
    if (curve.is_closed) continue;
    has_open_one = true;
    for (const Eigen::VectorXd& end : {curve.points.front().x, curve.points.back().x}) {
      const double slack = std::min((end.array() + 1.2).minCoeff(), (1.4 - end.array()).minCoeff());
      CHECK(slack >= -1e-12);
      CHECK(slack <= 1e-6);
      CHECK(place_on(formulation, curve, end).has_value());
    }
    CHECK(place_on(formulation, curve, curve.points.back().x).value() == Approx(curve.length));
  }
  CHECK(has_open_one);
}

TEST_CASE("of the part of a curve that touches nothing the best is listed") {
  const CaptureProblem problem = three_link_c2();
  const Formulation formulation(problem);
  const SearchResult all = solutions_of(problem, formulation);
  const Candidate best = all.candidates.front();
  // Mirrored postures are equally good but for rounding.
  const auto is_free = [&](const Configuration& at) {
    return std::none_of(all.candidates.begin(), all.candidates.end(), [&](const Candidate& one) {
      return one.worst_case < 1.001 * best.worst_case &&
             (at.phi - one.configuration.phi).norm() <= 0.5;
    });
  };
  const SearchResult result = solutions_of(problem, formulation, is_free);
  double listed = kInfinity, least = kInfinity;
  for (const Candidate& candidate : result.candidates) {
    if (is_free(candidate.configuration)) listed = std::min(listed, candidate.worst_case);
  }
  for (const SolutionCurve& curve : curves_of(formulation, result)) {
    for (int i = 0; i <= 1000; ++i) {
      const Configuration at = formulation.configuration(
          formulation.normalised(point_at(formulation, curve, curve.length * i / 1000)));
      if (is_free(at)) least = std::min(least, worst_case(problem, formulation, at).value);
    }
  }
  CHECK(result.candidates.front().worst_case == Approx(best.worst_case));
  CHECK(listed > 1.001 * best.worst_case);
  CHECK(listed <= least * 1.1);  // the samples of a curve are 0.05 apart
}

TEST_CASE("where no direction is uncertain a curve is one candidate for each part that is free") {
  CaptureProblem problem = three_link_c2();
  problem.uncertainty = {};
  const Formulation formulation(problem);
  const SearchResult result = solutions_of(problem, formulation);
  REQUIRE(result.families.size() >= 2);
  CHECK(result.candidates.size() == result.families.size());
  int starts = 0;
  for (const Candidate& candidate : result.candidates) starts += candidate.starts_reached;
  CHECK(starts == result.starts);

  const auto is_free = [](const Configuration& at) { return at.phi[1] > 0.5; };
  const SearchResult partly = solutions_of(problem, formulation, is_free);
  int parts = 0;
  for (std::size_t i = 0; i < partly.families.size(); ++i) {
    const SolutionCurve curve = curves_of(formulation, partly)[i];
    bool has_free = false;
    for (const CurvePoint& point : curve.points) {
      has_free = has_free || is_free(formulation.configuration(formulation.normalised(point.x)));
    }
    const auto listed = std::count_if(
        partly.candidates.begin(), partly.candidates.end(), [&](const Candidate& candidate) {
          return candidate.family == static_cast<int>(i) && is_free(candidate.configuration);
        });
    CHECK((listed > 0) == has_free);
    parts += static_cast<int>(listed);
  }
  CHECK(parts > 0);
}

TEST_CASE("after a stop no more points of a curve are rated, and what was found is kept") {
  const CaptureProblem problem = three_link_c2();
  const Formulation formulation(problem);
  std::atomic<bool> flag = false;
  int calls = 0;
  SearchOptions options;
  options.stop.interrupted = &flag;
  options.is_free = [&](const Configuration&) {
    ++calls;
    flag = true;
    return true;
  };
  const SearchResult result = search(problem, formulation, options);
  CHECK(calls == 1);
  CHECK(result.status == PlanStatus::Limit);
  CHECK(result.families.size() >= 2);
  REQUIRE_FALSE(result.candidates.empty());
  for (const Candidate& candidate : result.candidates) CHECK(candidate.max_violation <= 1e-9);
}

TEST_CASE("isolated solutions belong to no curve") {
  const CaptureProblem problem = test::shipped("planar_three_link_null");
  const Formulation formulation(problem);
  const SearchResult result = solutions_of(problem, formulation);
  CHECK(result.families.empty());
  for (const Candidate& candidate : result.candidates) CHECK(candidate.family == -1);
  CHECK(!trace_curve(formulation, result.points.front(), {}));
}

TEST_CASE("a curve along a bound ends where another limit is, and not before") {
  CaptureProblem problem = test::shipped("spart_3dof_point");
  const auto lengths = [](const CaptureProblem& of) {
    std::vector<double> out;
    const SearchResult result = solutions_of(of, Formulation(of));
    for (const SolutionFamily& family : result.families) {
      CHECK(family.is_complete);
      out.push_back(family.length);
    }
    std::sort(out.begin(), out.end());
    return out;
  };
  const SearchResult free = solutions_of(problem, Formulation(problem));
  const std::vector<double> wanted = lengths(problem);
  REQUIRE(wanted.size() >= 4);
  // Along these curves joint 2 keeps its angle: its largest becomes a bound.
  double largest = 0;
  for (const SolutionFamily& family : free.families) {
    largest = std::max(largest, family.points.front().phi.cwiseAbs()[1]);
  }
  for (const double off : {0.0, 1e-10, 1e-8, 1e-6, 1e-4}) {
    INFO("off by " << off);
    Joint& joint = problem.robot.joints[1];
    joint.upper = largest + problem.constraints.joint_limit_margin + off;
    joint.lower = -joint.upper;
    const std::vector<double> found = lengths(problem);
    REQUIRE(found.size() == wanted.size());
    for (std::size_t i = 0; i < found.size(); ++i) CHECK(std::abs(found[i] - wanted[i]) < 1e-8);
  }
}

}  // namespace stillbase
