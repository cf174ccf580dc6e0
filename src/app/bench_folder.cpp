#include "app/bench_folder.hpp"

#include <filesystem>
#include <stdexcept>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/io/benchmark_file.hpp>

#include "app/bench_page.hpp"
#include "io/json.hpp"

namespace stillbase::app {

namespace {

using io::Json;

constexpr std::size_t kMaxRecordBytes = std::size_t{4} << 30;

std::string in(const std::string& folder, const std::string& name) {
  return (std::filesystem::path(folder) / name).string();
}

}  // namespace

BenchFolder read_bench_folder(const std::string& folder) {
  BenchFolder out;
  const std::string path = in(folder, "bench.json");
  const std::string text = read_text_file(path);
  try {
    const Json json = Json::parse(text);
    if (json.at("format") != "stillbase.bench") throw std::invalid_argument("wrong format");
    json.at("gradient_cost").get_to(out.gradient_cost);
    for (const auto& [instance, value] : json.at("references").items()) {
      out.references[instance] = value.get<double>();
    }
  } catch (const std::exception& error) {
    throw InputError({{path, 0, "not-a-benchmark", error.what()}});
  }
  const std::string records = in(folder, "records.jsonl");
  out.records = read_records(read_text_file(records, kMaxRecordBytes), records);
  return out;
}

void write_bench_folder(const std::string& folder, const BenchFolder& content,
                        const std::vector<std::string>& record_texts) {
  const auto write = [&folder](const std::string& name, const std::string& text) {
    write_file_atomically(in(folder, name), text, true);
  };
  Json references = Json::object();
  for (const auto& [instance, value] : content.references) {
    references[instance] = value;
  }
  write("bench.json", io::pretty({{"format", "stillbase.bench"},
                                  {"version", 1},
                                  {"gradient_cost", content.gradient_cost},
                                  {"references", references}}));
  std::string lines;
  for (const std::string& text : record_texts) lines += text + "\n";
  write("records.jsonl", lines);
  write("runs.csv",
        table_to_csv(bench_table(content.records, content.references, content.gradient_cost)));
  const BenchmarkAnalysis analysis =
      analyze_benchmark(content.records, content.references, content.gradient_cost);
  const Page page = bench_page(analysis, content.gradient_cost);
  for (const PageSection& section : page.sections) {
    for (const PageFigure& figure : section.figures) write(figure.file, figure.svg);
  }
  write("report.md", page_to_markdown(page));
  write("times.md", page_to_markdown(bench_times_page(analysis)));
}

Page bench_folder_page(const BenchFolder& content) {
  const BenchmarkAnalysis analysis =
      analyze_benchmark(content.records, content.references, content.gradient_cost);
  Page page = bench_page(analysis, content.gradient_cost);
  for (PageSection& section : bench_times_page(analysis).sections) {
    page.sections.push_back(std::move(section));
  }
  return page;
}

}  // namespace stillbase::app
