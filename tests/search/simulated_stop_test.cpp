// A stop while the objective is simulated: counted in evaluations, not in seconds.
#include <catch2/catch.hpp>

#include <algorithm>
#include <atomic>

#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/search/search.hpp>

#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

/// One joint is redundant; the rotation within a short time is minimised.
CaptureProblem turning_problem(RiskMeasure measure) {
  CaptureProblem problem = test::shipped("planar_three_link_null");
  problem.objective = {{ObjectiveQuantity::AttitudeTurned}};
  problem.objective[0].after = 0.02;
  problem.post_impact.controllers = {"joint_damping"};
  problem.measure.kind = measure;
  problem.measure.samples = 8;
  problem.uncertainty.restitution = 0.1;
  return problem;
}

/// Sets a flag at the n-th simulation: a term of the user that weighs nothing is evaluated beside
/// each of them.
struct Counter {
  long calls = 0;
  long stop_at = -1;
  std::atomic<bool> flag = false;

  UserTerm term() {
    return {"counter", "1", 1e9, [this](const Configuration&, const ImpactSummary&) {
              if (++calls == stop_at) flag = true;
              return 0.0;
            }};
  }
};

struct Run {
  SearchResult result;
  long calls = 0, after_stop = 0;
};

Run stopped_run(CaptureProblem problem, long stop_at) {
  Counter counter;
  problem.user.terms = {counter.term()};
  Formulation formulation(problem);
  counter.calls = 0;
  counter.stop_at = stop_at;
  SearchOptions options;
  options.starts = 2;
  options.stop.interrupted = &counter.flag;
  formulation.give_up_simulations_at(options.stop);
  Run run{search(problem, formulation, options), 0, 0};
  run.calls = counter.calls;
  if (counter.flag) run.after_stop = counter.calls - stop_at;
  return run;
}

}  // namespace

TEST_CASE("after a stop a search takes a few simulations more, and says what it did not judge") {
  for (const RiskMeasure measure :
       {RiskMeasure::Nominal, RiskMeasure::WorstCase, RiskMeasure::Expectation}) {
    const CaptureProblem problem = turning_problem(measure);
    const Formulation fresh(problem);
    const long all = stopped_run(problem, -1).calls;
    REQUIRE(all > 300);
    int judged = 0, not_judged = 0;
    for (const long stop_at : {1L, all / 100, all / 10, all / 4, all - 20}) {
      const Run run = stopped_run(problem, stop_at);
      INFO("measure " << static_cast<int>(measure) << ", stopped at " << stop_at << " of " << all
                      << ", " << run.after_stop << " more");
      // The current simulation and a few nominal values, most where few starts have ended; one
      // worst case takes more than fifty, the remaining samples of one gradient as many.
      CHECK(run.after_stop <= 40);
      CHECK(run.result.status == PlanStatus::Limit);
      REQUIRE(run.result.candidates.size() >= 1);
      const Candidate& best = run.result.candidates.front();
      const WorstCase& stated = run.result.worst_cases.front();
      const WorstCase worst = worst_case(problem, fresh, best.configuration);
      CHECK(best.objective ==
            Approx(nominal_value(problem, fresh, best.configuration)).epsilon(1e-9).margin(1e-12));
      CHECK(stated.value == best.worst_case);
      CHECK(stated.is_complete == (best.worst_case == Approx(worst.value).epsilon(1e-9)));
      if (best.is_judged) {
        ++judged;
        CHECK(best.worst_case == Approx(worst.value).epsilon(1e-9));
      } else {
        ++not_judged;
        CHECK(best.worst_case >= best.objective * (1 - 1e-12));
        CHECK(best.worst_case <= worst.value * (1 + 1e-9));
        if (measure == RiskMeasure::Expectation) CHECK(best.value == best.objective);
        CHECK_FALSE(run.result.nominal_optimum);
        CHECK(status_of(run.result.certificates.front()) != PlanStatus::Optimal);
      }
    }
    CHECK(judged > 0);
    CHECK(not_judged > 0);
  }
}

TEST_CASE("of the solutions found before a stop only the one with the best nominal value is kept") {
  const CaptureProblem problem = turning_problem(RiskMeasure::WorstCase);
  constexpr int kStarts = 6;
  SearchOptions options;
  options.starts = kStarts;
  // All solutions of these starts.
  CaptureProblem nominal = problem;
  nominal.measure.kind = RiskMeasure::Nominal;
  const SearchResult all = search(nominal, Formulation(nominal), options);
  REQUIRE(all.candidates.size() >= 2);
  double least = kInfinity, most = 0;
  for (const Candidate& candidate : all.candidates) {
    least = std::min(least, candidate.objective);
    most = std::max(most, candidate.objective);
  }
  REQUIRE(most > 1e3 * least);

  std::atomic<bool> flag = false;
  options.starts = 2 * kStarts;
  options.stop.interrupted = &flag;
  options.on_progress = [&flag](int done, int) { flag = done >= kStarts; };
  Formulation formulation(problem);
  formulation.give_up_simulations_at(options.stop);
  const SearchResult cut = search(problem, formulation, options);
  CHECK(cut.starts == kStarts);
  REQUIRE(cut.candidates.size() == 1);
  CHECK_FALSE(cut.candidates[0].is_judged);
  CHECK(cut.candidates[0].objective < 1.1 * least + 1e-9);
}

TEST_CASE("simulations that are given up leave no number behind") {
  const CaptureProblem problem = turning_problem(RiskMeasure::WorstCase);
  Formulation formulation(problem);
  const Eigen::VectorXd x = formulation.variables({problem.start, problem.base, 0});
  const Configuration at = formulation.configuration(x);
  const double nominal = nominal_value(problem, formulation, at);
  const WorstCase worst = worst_case(problem, formulation, at);
  CHECK(worst.is_complete);
  const std::atomic<bool> flag = true;
  StopCondition stop;
  stop.interrupted = &flag;
  formulation.give_up_simulations_at(stop);
  nlp::Evaluation here;
  formulation.evaluate(x, here);
  CHECK(std::isnan(here.objective));
  CHECK_FALSE(here.gradient.allFinite());
  CHECK(here.constraints.allFinite());
  CHECK(here.jacobian.allFinite());
  CHECK(nominal_value(problem, formulation, at) == nominal);
  const WorstCase cut = worst_case(problem, formulation, at);
  CHECK_FALSE(cut.is_complete);
  CHECK(cut.value == nominal);
  CHECK(cut.value < worst.value);
  CHECK(cut.direction.isApprox(encounter_at(formulation.encounter_model(), at).F.head<3>()));
}

}  // namespace stillbase
