// Pages as Markdown, HTML and CSV; logs for Planner Arena.
#include <catch2/catch.hpp>

#include <sstream>

#include <stillbase/report/page.hpp>
#include <stillbase/report/planner_log.hpp>
#include <stillbase/report/plot.hpp>

namespace stillbase {
namespace {

Page example() {
  PlotPanel panel;
  panel.x = {0, 1};
  panel.series = {{"a", {0, 1}}};
  PageSection section;
  section.heading = "Results <b>";
  section.paragraphs = {"a < b & c"};
  section.table.header = {"name", "n"};
  section.table.rows = {{"x|y", "1"}, {"é, \"q\"", "22"}};
  section.figures = {{"f.svg", "a figure", panel}};
  return {"Title", {section}};
}

int count(const std::string& text, const std::string& part) {
  int found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) {
    ++found;
  }
  return found;
}

}  // namespace

TEST_CASE("a page as Markdown has aligned tables and links to its figures") {
  const std::string text = page_to_markdown(example());
  CHECK(text.find("# Title\n\n## Results <b>\n") == 0);
  CHECK(text.find("| name   | n  |\n|--------|----|\n| x\\|y   | 1  |\n| é, \"q\" | 22 |\n") !=
        std::string::npos);
  CHECK(text.find("![a figure](f.svg)") != std::string::npos);
}

TEST_CASE("an HTML page is one file whose data are text, with nothing from outside") {
  const std::string data = R"({"documents":[],"name":"</script><script>alert(1)</script><!--"})";
  const std::string html = page_html(data);
  CHECK(html.find("<!DOCTYPE html>") == 0);
  CHECK(html.find("default-src 'none'; script-src 'sha256-") != std::string::npos);
  CHECK(html.find("unsafe") == std::string::npos);
  CHECK(html.find("alert(1)") != std::string::npos);
  CHECK(html.find("<script>alert(1)") == std::string::npos);
  CHECK(count(html, "<script") == 2);
  CHECK(count(html, "</script") == 2);
  CHECK(html.find(R"("name":"\u003c/script>\u003cscript>alert(1))") != std::string::npos);
  CHECK(html.find("@DATA@") == std::string::npos);
  for (const char* outside : {"<link", "<img", "<iframe", "@import", "<script src"}) {
    CAPTURE(outside);
    CHECK(html.find(outside) == std::string::npos);
  }
}

TEST_CASE("comma-separated values quote what needs it") {
  CHECK(table_to_csv(example().sections[0].table) == "name,n\nx|y,1\n\"é, \"\"q\"\"\",22\n");
}

TEST_CASE("a planner log has the lines that OMPL's reader counts off") {
  PlannerLog log;
  log.experiment = "arm";
  log.setup = "two\nlines";
  log.host = "somewhere";
  log.started = "today";
  log.runs_per_planner = 2;
  log.seconds_limit = 60;
  log.outcomes = {"found", "timeout"};
  PlannerLogRun good, crashed;
  good.solved = true;
  good.status = PlannerLogStatus::ExactSolution;
  good.outcome = 0;
  good.seconds = 0.5;
  good.length = 2.25;
  crashed.status = PlannerLogStatus::Crash;
  log.planners = {{"rrt_connect", {good, crashed}}, {"kpiece", {good, good}}};
  // Read as ompl_benchmark_statistics.py does.
  std::istringstream text(planner_log_to_text(log));
  std::string line;
  const auto next = [&] {
    REQUIRE(std::getline(text, line));
    return line;
  };
  const auto number = [&] { return std::stoi(next()); };
  CHECK(next().rfind("OMPL version ", 0) == 0);
  CHECK(next() == "Experiment arm");
  CHECK(number() == 0);
  CHECK(next() == "Running on somewhere");
  CHECK(next() == "Starting at today");
  for (int part = 0; part < 2; ++part) {
    CHECK(next() == "<<<|");
    while (next() != "|>>>") {
    }
  }
  CHECK(number() == 1);   // seed
  CHECK(number() == 60);  // seconds
  next();                 // memory
  CHECK(number() == 2);
  CHECK(std::stod(next()) == 1.5);  // seconds spent
  const int enums = number();
  CHECK(enums == 2);
  CHECK(next().rfind("status|", 0) == 0);
  CHECK(next() == "outcome|found|timeout");
  REQUIRE(number() == 2);
  for (const PlannerLogPlanner& planner : log.planners) {
    CHECK(next() == "geometric_" + planner.name);
    CHECK(number() == 0);
    const int properties = number();
    for (int i = 0; i < properties; ++i) {
      const std::string type = next().substr(line.rfind(' ') + 1);
      CHECK((type == "REAL" || type == "INTEGER" || type == "BOOLEAN" || type == "ENUM"));
    }
    REQUIRE(number() == 2);
    for (int run = 0; run < 2; ++run) CHECK(count(next(), "; ") == properties);
    CHECK(next() == ".");
  }
  CHECK_FALSE(std::getline(text, line));
}

}  // namespace stillbase
