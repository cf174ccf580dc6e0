#include "app/bench_folder.hpp"

#include <filesystem>

#include <stillbase/core/file.hpp>

#include "app/bench_page.hpp"

namespace stillbase::app {

namespace {

constexpr std::size_t kMaxRecordBytes = std::size_t{4} << 30;

std::string in(const std::string& folder, const std::string& name) {
  return (std::filesystem::path(folder) / name).string();
}

BenchmarkAnalysis analysis_of(const BenchFolder& content) {
  return analyze_benchmark(content.records, content.references.values,
                           content.references.gradient_cost);
}

}  // namespace

BenchFolder read_bench_folder(const std::string& folder) {
  const std::string path = in(folder, "bench.json"), records = in(folder, "records.jsonl");
  return {read_bench_references(read_text_file(path), path),
          read_records(read_text_file(records, kMaxRecordBytes), records)};
}

void write_bench_folder(const std::string& folder, const BenchFolder& content,
                        const std::string& record_lines) {
  const auto write = [&folder](const std::string& name, const std::string& text) {
    write_file_atomically(in(folder, name), text, true);
  };
  const auto& [references, records] = content;
  write("bench.json", bench_references_to_json(references));
  write("records.jsonl", record_lines);
  write("runs.csv",
        table_to_csv(bench_table(records, references.values, references.gradient_cost)));
  const BenchmarkAnalysis analysis = analysis_of(content);
  const Page page = bench_page(analysis, references.gradient_cost);
  for (const PageSection& section : page.sections) {
    for (const PageFigure& figure : section.figures) write(figure.file, figure.svg);
  }
  write("report.md", page_to_markdown(page));
  write("times.md", page_to_markdown(bench_times_page(analysis)));
}

Page bench_folder_page(const BenchFolder& content) {
  const BenchmarkAnalysis analysis = analysis_of(content);
  Page page = bench_page(analysis, content.references.gradient_cost);
  for (PageSection& section : bench_times_page(analysis).sections) {
    page.sections.push_back(std::move(section));
  }
  return page;
}

}  // namespace stillbase::app
