// What a benchmark says, as pages, and the folder of its files:
//
//   runs/             journal of the runs (room campaign)
//   bench.json        what the records are measured against
//   records.jsonl     one record per run; what differs from run to run stands under `measured`
//   runs.csv          one row per run
//   report.md, *.svg  the tables and figures
//   times.md          the figures in seconds
#pragma once

#include <string>
#include <vector>

#include <stillbase/benchmark/analysis.hpp>
#include <stillbase/io/benchmark_file.hpp>
#include <stillbase/report/page.hpp>

namespace stillbase::app {

struct BenchFolder {
  BenchReferences references;
  std::vector<RunRecord> records;
};

/// @throws InputError, FileError
BenchFolder read_bench_folder(const std::string& folder);

/// Writes everything but the journal.
/// @param record_lines the text of records.jsonl
/// @throws FileError
void write_bench_folder(const std::string& folder, const BenchFolder& content,
                        const std::string& record_lines);

/// Tables, figures and times of a folder's records, for HTML.
Page bench_folder_page(const BenchFolder& content);

}  // namespace stillbase::app
