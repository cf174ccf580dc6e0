// One run: budget, improvements, derivatives of the programs, and the example of bench/README.md.
#include <catch2/catch.hpp>

#include <cmath>

#include <stillbase/benchmark/run.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/io/benchmark_file.hpp>
#include <stillbase/nlp/optimizer.hpp>

#include "../../bench/example_optimizer.cpp"

namespace stillbase {
namespace {

const SuiteSpec& suite() {
  static const SuiteSpec spec = read_suite(STILLBASE_SOURCE_DIR "/bench/suite.yaml");
  return spec;
}

BenchmarkInstance instance_of(const std::string& family, BenchmarkGoal goal) {
  for (const FamilySpec& candidate : suite().families) {
    if (candidate.name == family) return make_instance(candidate, goal, 0);
  }
  throw std::invalid_argument(family);
}

RunRequest request_of(const BenchmarkInstance& instance, const std::string& optimizer) {
  return {instance.name, instance_sha256(instance), optimizer, false, 3, 200, 60};
}

/// A record's text without what is measured.
std::string unmeasured(RunRecord record) {
  record.seconds = 0;
  for (Improvement& point : record.improvements) point.seconds = 0;
  return record_to_text(record, "");
}

}  // namespace

TEST_CASE("a run keeps to its budget, repeats, and only ever gets better") {
  for (const auto& [family, goal] :
       {std::pair{"planar_two_link", BenchmarkGoal::Case},
        std::pair{"spart", BenchmarkGoal::WorstCase}, std::pair{"iiwa", BenchmarkGoal::Nominal}}) {
    const BenchmarkInstance instance = instance_of(family, goal);
    for (const char* optimizer : {"sqp", "nlopt-slsqp", "nlopt-isres", "ipopt", "random-search"}) {
      CAPTURE(instance.name, optimizer);
      const RunRequest request = request_of(instance, optimizer);
      const RunRecord record = run_benchmark(instance, request);
      // The start of a last local solve and its certificate are evaluated whatever is left.
      CHECK(record.evaluations <= request.budget + 2);
      CHECK(record.starts >= 1);
      REQUIRE_FALSE(record.improvements.empty());
      for (std::size_t i = 1; i < record.improvements.size(); ++i) {
        const Improvement &a = record.improvements[i - 1], &b = record.improvements[i];
        CHECK(b.evaluations > a.evaluations);
        const bool was = a.violation <= kBenchmarkViolation,
                   is = b.violation <= kBenchmarkViolation;
        CHECK((is ? !was || b.value < a.value : !was && b.violation < a.violation));
      }
      const Judged judged = judge_point(instance, record.best_point);
      CHECK(judged.value == Approx(record.improvements.back().value).epsilon(1e-12));
      CHECK(judged.violation == record.improvements.back().violation);
      CHECK(unmeasured(run_benchmark(instance, request)) == unmeasured(record));
    }
  }
}

TEST_CASE("what others are measured against gains nothing from its violation") {
  const BenchmarkInstance instance = instance_of("ets7", BenchmarkGoal::Nominal);
  RunRequest request = request_of(instance, "nlopt-auglag-lbfgs");
  request.budget = 2000;
  const RunRecord record = run_benchmark(instance, request);
  REQUIRE(record.improvements.back().violation <= kBenchmarkViolation);
  REQUIRE(record.improvements.back().violation > kReferenceViolation);
  const RunRecord exact = refined(instance, record);
  REQUIRE(exact.improvements.size() == 1);
  const Improvement& point = exact.improvements.front();
  const Judged judged = judge_point(instance, exact.best_point);
  CHECK(judged.value == point.value);
  CHECK(judged.violation == point.violation);
  CHECK(point.violation <= kReferenceViolation);
  // The same minimum, but for what the violation had gained.
  CHECK(point.value == Approx(record.improvements.back().value).epsilon(0).margin(1e-3));
  CHECK(exact.best_kkt_residual >= 0);
  CHECK(exact.best_kkt_residual < 1e-6);

  RunRecord off = record;
  off.improvements.back().violation = 1e-3;
  CHECK(refined(instance, off).improvements.empty());
}

TEST_CASE("the programs' derivatives are those of their values") {
  for (const auto& [family, goal] : {std::pair{"planar_two_link", BenchmarkGoal::Case},
                                     std::pair{"iiwa_case", BenchmarkGoal::Case},
                                     std::pair{"planar_three_link", BenchmarkGoal::WorstCase}}) {
    const BenchmarkInstance instance = instance_of(family, goal);
    const BenchmarkProgram program(instance);
    CAPTURE(instance.name);
    const Eigen::VectorXd x = program.start(1, 5);
    nlp::Evaluation at, up, down;
    program.evaluate(x, at);
    Eigen::MatrixXd hessian;
    const Eigen::VectorXd multipliers =
        Eigen::VectorXd::LinSpaced(program.num_constraints(), 0.5, -0.3);
    program.lagrangian_hessian(x, 0.7, multipliers, hessian);
    constexpr double kStep = 1e-6;
    for (int i = 0; i < program.num_variables(); ++i) {
      const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(x.size(), i);
      program.evaluate(x + step, up);
      program.evaluate(x - step, down);
      const double scale = 1 + at.gradient.cwiseAbs().maxCoeff();
      CHECK((up.objective - down.objective) / (2 * kStep) ==
            Approx(at.gradient[i]).epsilon(0).margin(1e-6 * scale));
      const Eigen::VectorXd column = (0.7 * (up.gradient - down.gradient) +
                                      (up.jacobian - down.jacobian).transpose() * multipliers) /
                                     (2 * kStep);
      CHECK((column - hessian.col(i)).cwiseAbs().maxCoeff() <=
            1e-5 * (1 + hessian.cwiseAbs().maxCoeff()));
    }
  }
}

TEST_CASE("the judge looks at the posture: the epigraph's own variable buys nothing") {
  const BenchmarkInstance instance = instance_of("planar_two_link", BenchmarkGoal::WorstCase);
  const BenchmarkProgram program(instance);
  const Eigen::VectorXd x = program.start(0, 1);
  std::vector<double> point(x.data(), x.data() + x.size());
  const Judged honest = judge_point(instance, point);
  point.back() = 0;
  CHECK(judge_point(instance, point).value == Approx(honest.value).epsilon(1e-12));
}

TEST_CASE("all contestants begin at the same points") {
  const BenchmarkInstance instance = instance_of("iiwa", BenchmarkGoal::Nominal);
  const BenchmarkProgram a(instance), b(instance);
  for (int start = 0; start < 5; ++start) CHECK(a.start(start, 7) == b.start(start, 7));
  CHECK(a.start(0, 7) != a.start(0, 8));
}

TEST_CASE("the example of bench/README.md is a working optimizer, and the text is the file's") {
  const std::string code = read_text_file(STILLBASE_SOURCE_DIR "/bench/example_optimizer.cpp");
  const std::string readme = read_text_file(STILLBASE_SOURCE_DIR "/bench/README.md");
  CHECK(readme.find("```cpp\n" + code + "```") != std::string::npos);

  const BenchmarkInstance instance = instance_of("planar_two_link", BenchmarkGoal::Case);
  const BenchmarkProgram program(instance);
  const auto optimizer = std::move(nlp::compass_search().front());
  REQUIRE(optimizer);
  const auto result = optimizer->minimize(program, program.start(0, 1), {});
  CHECK(result.feasible);
  nlp::Evaluation at_start;
  program.evaluate(program.start(0, 1), at_start);
  CHECK(result.objective < 1e-3 * at_start.objective);
}

}  // namespace stillbase
