// What a benchmark says, as pages.
#pragma once

#include <stillbase/benchmark/analysis.hpp>
#include <stillbase/report/page.hpp>

namespace stillbase::app {

/// The figures that do not depend on the machine: the same for the same command.
Page bench_page(const BenchmarkAnalysis& analysis, double gradient_cost);

/// The figures in seconds.
Page bench_times_page(const BenchmarkAnalysis& analysis);

/// One row per record.
TextTable bench_table(const std::vector<RunRecord>& records,
                      const std::map<std::string, double>& references, double gradient_cost);

}  // namespace stillbase::app
