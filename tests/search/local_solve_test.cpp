// One evaluation and one local solve of the nominal problem.
#include <catch2/catch.hpp>

#include <stillbase/io/problem_file.hpp>
#include <stillbase/nlp/optimizer.hpp>

#include "formulation/projection.hpp"
#include "support/capture_problems.hpp"

namespace stillbase {

TEST_CASE("the nominal encounter is evaluated like one scenario of several") {
  Random random(38);
  const CaptureProblem problem = tumbling_problem(random, random_robot(random, 7, false));
  const Formulation formulation(problem);
  const Eigen::VectorXd x =
      formulation.start_point(low_discrepancy_point(3, formulation.num_variables(), 9));
  nlp::Evaluation alone;
  formulation.evaluate(x, alone);
  ScenarioEvaluation given;
  formulation.evaluate_scenarios(x, {formulation.nominal_scenario()}, true, given);
  CHECK(alone.objective == given.values[0]);
  CHECK(alone.gradient.transpose() == given.gradients.row(0));
  CHECK(alone.constraints == given.constraints);
  CHECK(alone.jacobian == given.jacobian);
}

namespace {

/// What solves from starts near the constraints of a shipped problem came to.
struct Solves {
  int starts = 0;
  int again = 0;  ///< that ran a second time
};

bool is_again(const nlp::OptimizeResult& found) {
  return found.message.find("started again") != std::string::npos;
}

/// @param off violation at which a start counts
template <class Judge>
Solves solves_of(const std::string& optimizer, const std::string& problem, int draws,
                 std::uint64_t seed, double off, Judge judge) {
  const CaptureProblem read =
      read_problem(std::string(STILLBASE_SOURCE_DIR) + "/problems/" + problem + ".yaml");
  const Formulation formulation(read);
  const auto solver = nlp::make_optimizer(optimizer);
  Solves out;
  for (int draw = 0; draw < draws; ++draw) {
    const ProjectionResult start = project_onto_constraints(
        formulation,
        formulation.start_point(low_discrepancy_point(draw, formulation.num_variables(), seed)),
        false, 15);
    if (start.violation > off) continue;
    ++out.starts;
    const nlp::OptimizeResult found = solver->minimize(formulation, start.x);
    INFO("draw " << draw << ", " << found.evaluations << " evaluations");
    judge(found);
    out.again += is_again(found) ? 1 : 0;
  }
  return out;
}

}  // namespace

TEST_CASE("the local solver ends at a minimum from every start, also from one that is too steep") {
  for (const std::string optimizer : {"sqp", "nlopt-slsqp"}) {
    INFO(optimizer);
    const int most = optimizer == "sqp" ? 200 : 150;
    const auto judge = [most](const auto& found) {
      CHECK(found.status == nlp::Status::Optimal);
      CHECK(found.evaluations <= most);
    };
    const Solves solves = solves_of(optimizer, "iiwa_cone", 256, 1, 1e-3, judge);
    CHECK(solves.starts > 40);
    CHECK(solves.again >= 1);
  }
}

TEST_CASE("a solve that ends at a violated point is made again with a short first step") {
  for (const char* optimizer : {"sqp", "nlopt-slsqp"}) {
    Solves all;
    int far = 0;  // from any minimum
    // Where they end is decided by rounding: of so many starts some end violated in any build.
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
      INFO(optimizer << ", seed " << seed);
      const Solves solves =
          solves_of(optimizer, "deos_latch", 64, seed, 1e-9, [&far](const auto& found) {
            CHECK(found.feasible);
            const bool is_near = found.certificate.kkt_residual < 0.01;
            if (is_again(found)) CHECK(is_near);
            far += is_near ? 0 : 1;
          });
      all.starts += solves.starts;
      all.again += solves.again;
    }
    CHECK(all.starts > 200);
    // Of 80 seeds nlopt-slsqp leaves 13 of 1896, none that was made again, sqp one.
    const bool is_own = optimizer == std::string("sqp");
    CHECK(far <= all.starts / (is_own ? 200 : 50));
    if (!is_own) CHECK(all.again >= 1);
  }
}

}  // namespace stillbase
