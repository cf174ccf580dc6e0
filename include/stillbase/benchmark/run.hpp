// One optimizer on one benchmark program until its budget is spent.
#pragma once

#include <stillbase/benchmark/program.hpp>
#include <stillbase/benchmark/record.hpp>
#include <stillbase/core/interrupt.hpp>

namespace stillbase {

/// Runs the optimizer from the first start point of the seed, and from the next one whenever it
/// ends with budget left: a solver that is done early is not worse for it, and one that can only
/// look around its start gets as many as it can pay. What moves a start onto the constraints counts
/// as evaluations with derivatives. Every better point is recorded.
/// @param same_solution distance on the configuration manifold below which two solutions are one
/// @throws std::invalid_argument for an optimizer that is not in the registry
RunRecord run_benchmark(const BenchmarkInstance& instance, const RunRequest& request,
                        const StopCondition& stop = {}, double same_solution = 1e-4);

/// A record with what is known of a run before it begins.
RunRecord empty_record(const BenchmarkInstance& instance, const RunRequest& request);

/// A run's best point, made exact: moved onto the constraints and down to the local minimum there,
/// with its KKT residual. The record has this point as its only improvement; none when the run's
/// best point violates the constraints by more than kBenchmarkViolation, or stays off them by more
/// than kReferenceViolation.
RunRecord refined(const BenchmarkInstance& instance, const RunRecord& record);

/// Evaluates a point of an instance anew: value and violation of what a record or a file states.
Judged judge_point(const BenchmarkInstance& instance, const std::vector<double>& point);

}  // namespace stillbase
