#include <stillbase/benchmark/run.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <stdexcept>

#include <stillbase/nlp/certificate.hpp>
#include <stillbase/nlp/optimizer.hpp>

namespace stillbase {

namespace {

using Clock = std::chrono::steady_clock;

/// The point of the last improvement; x is empty before the first.
struct BestPoint {
  Judged judged;
  Eigen::VectorXd x;
};

/// Counts what passes through and keeps every point better than all before it.
class RecordingProgram final : public ForwardingProgram {
 public:
  RecordingProgram(const BenchmarkProgram& program, RunRecord& record, BestPoint& best)
      : program_(program), record_(record), best_(best) {}

  void evaluate(const Eigen::VectorXd& x, nlp::Evaluation& out) const override {
    program_.evaluate(x, out);
    ++record_.gradients;
    keep(x, out);
  }
  void evaluate_value(const Eigen::VectorXd& x, nlp::Evaluation& out) const override {
    program_.evaluate_value(x, out);
    keep(x, out);
  }
  void lagrangian_hessian(const Eigen::VectorXd& x, double sigma,
                          const Eigen::VectorXd& multipliers, Eigen::MatrixXd& out) const override {
    ++record_.hessians;
    program_.lagrangian_hessian(x, sigma, multipliers, out);
  }

 protected:
  const nlp::Problem& inner() const override { return program_; }

 private:
  void keep(const Eigen::VectorXd& x, const nlp::Evaluation& at_x) const {
    ++record_.evaluations;
    const Judged here = program_.judge(x, at_x);
    const bool feasible = here.violation <= kBenchmarkViolation;
    const bool was_feasible = best_.judged.violation <= kBenchmarkViolation;
    const bool better = feasible != was_feasible ? feasible
                        : feasible               ? here.value < best_.judged.value
                                                 : here.violation < best_.judged.violation;
    if (!better) return;
    best_ = {here, x};
    record_.improvements.push_back({record_.evaluations, record_.gradients, here.value,
                                    here.violation,
                                    std::chrono::duration<double>(Clock::now() - begin_).count()});
  }

  const BenchmarkProgram& program_;
  RunRecord& record_;
  BestPoint& best_;
  Clock::time_point begin_ = Clock::now();
};

RunRecord empty_record_of(const BenchmarkProgram& program, const BenchmarkInstance& instance,
                          const RunRequest& request) {
  RunRecord record;
  record.request = request;
  record.family = instance.family;
  record.goal = to_string(instance.goal);
  record.variables = program.free_variables();
  record.equations = program.equations();
  if (const auto optimizer = nlp::make_optimizer(request.optimizer)) {
    record.library = optimizer->info().library;
    record.options = request.library_defaults ? "" : optimizer->info().tuning;
  }
  return record;
}

}  // namespace

std::string label_of(const RunRequest& request) {
  return request.optimizer + (request.library_defaults ? ":defaults" : "");
}

RunRecord empty_record(const BenchmarkInstance& instance, const RunRequest& request) {
  return empty_record_of(BenchmarkProgram(instance), instance, request);
}

Judged judge_point(const BenchmarkInstance& instance, const std::vector<double>& point) {
  const BenchmarkProgram program(instance);
  if (static_cast<int>(point.size()) != program.num_variables()) return {};
  const Eigen::VectorXd x =
      Eigen::Map<const Eigen::VectorXd>(point.data(), program.num_variables());
  nlp::Evaluation at_x;
  program.evaluate_value(x, at_x);
  return program.judge(x, at_x);
}

RunRecord refined(const BenchmarkInstance& instance, const RunRecord& record) {
  RunRecord out = record;
  out.improvements.clear();
  if (record.improvements.empty()) return out;
  const Improvement found = record.improvements.back();
  if (!(found.violation <= kBenchmarkViolation)) return out;
  const BenchmarkProgram program(instance);
  Judged best;
  Eigen::VectorXd best_x;
  const auto consider = [&](const Eigen::VectorXd& x) {
    nlp::Evaluation at_x;
    program.evaluate_value(x, at_x);
    const Judged here = program.judge(x, at_x);
    if (!(here.violation <= kReferenceViolation && here.value < best.value)) return;
    best = here;
    best_x = x;
  };
  const Eigen::VectorXd x0 =
      Eigen::Map<const Eigen::VectorXd>(record.best_point.data(), program.num_variables());
  consider(x0);
  Eigen::VectorXd x = program.on_constraints(x0);
  consider(x);
  x = nlp::make_optimizer("sqp")->minimize(program, x, {}).x;
  consider(x);
  consider(program.on_constraints(x));
  if (best_x.size() == 0) return out;
  out.improvements = {found};
  out.improvements.back().value = best.value;
  out.improvements.back().violation = best.violation;
  out.best_point.assign(best_x.data(), best_x.data() + best_x.size());
  const double kkt = nlp::certify(program, best_x).kkt_residual;
  out.best_kkt_residual = std::isfinite(kkt) ? kkt : -1;
  return out;
}

RunRecord run_benchmark(const BenchmarkInstance& instance, const RunRequest& request,
                        const StopCondition& stop, double same_solution) {
  const auto optimizer = nlp::make_optimizer(request.optimizer);
  if (!optimizer) throw std::invalid_argument("no optimizer named " + request.optimizer);
  const auto begin = Clock::now();
  const BenchmarkProgram program(instance);
  RunRecord record = empty_record_of(program, instance, request);

  BestPoint best;
  const RecordingProgram recorded(program, record, best);
  std::vector<Eigen::VectorXd> solutions;
  for (int start = 0; record.evaluations < request.budget && !stop.reached(); ++start) {
    const long before_start = program.model_evaluations();
    const Eigen::VectorXd x0 = program.start(start, request.seed);
    // What the budget no longer covers is not charged: the run was over before.
    const long spent =
        std::min(program.model_evaluations() - before_start, request.budget - record.evaluations);
    record.evaluations += spent;
    record.gradients += spent;
    if (record.evaluations >= request.budget) break;
    nlp::OptimizeOptions optimize;
    optimize.max_evaluations = static_cast<int>(request.budget - record.evaluations);
    optimize.stop = stop;
    optimize.seed = request.seed + 1000003ull * static_cast<std::uint64_t>(start);
    optimize.explain_infeasibility = false;  // the next start is the better use of the budget
    optimize.library_defaults = request.library_defaults;
    const long before = record.evaluations;
    const nlp::OptimizeResult result = optimizer->minimize(recorded, x0, optimize);
    ++record.starts;
    record.stop_reason = nlp::to_string(result.stop);
    record.message = result.message;
    if (result.status == nlp::Status::Optimal) {
      bool known = false;
      for (const Eigen::VectorXd& x : solutions) {
        known = known || program.distance(x, result.x) < same_solution;
      }
      if (!known) solutions.push_back(result.x);
    }
    if (result.stop == nlp::StopReason::Refused || record.evaluations == before) break;
  }
  record.distinct_solutions = static_cast<long>(solutions.size());
  if (best.x.size() > 0) {
    const Eigen::VectorXd& x = best.x;
    nlp::Evaluation at_x;
    program.evaluate(x, at_x);
    const double residual = nlp::certify(program, x, at_x).kkt_residual;
    record.best_point.assign(x.data(), x.data() + x.size());
    if (std::isfinite(residual)) record.best_kkt_residual = residual;
  }
  record.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  return record;
}

}  // namespace stillbase
