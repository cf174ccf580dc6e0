#include <catch2/catch.hpp>

#include <cmath>
#include <stdexcept>

#include <stillbase/report/plot.hpp>

namespace stillbase {
namespace {

PlotPanel panel() {
  PlotPanel p;
  p.title = "momenta <& parts>";
  p.x_label = "direction [deg]";
  p.y_label = "N m s";
  p.x = {0, 90, 180, 270, 360};
  p.series = {{"base", {-10, 0, 10, 0, -10}}, {"total", {5, 5, 5, 5, 5}}};
  p.marks = {{90, "G2"}};
  return p;
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t n = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++n;
  return n;
}

}  // namespace

TEST_CASE("a plot has one line per series, a zero line and its marks, and escapes its texts") {
  const std::string svg = plot_svg({panel(), panel()});
  CHECK(count(svg, "<polyline") == 4);
  CHECK(count(svg, "class=\"zero\"") == 2);
  CHECK(count(svg, "class=\"mark\"") == 2);
  CHECK(svg.find("momenta &lt;&amp; parts&gt;") != std::string::npos);
  CHECK(svg.find("<& parts>") == std::string::npos);
  CHECK(svg == plot_svg({panel(), panel()}));
}

TEST_CASE("a larger value stands higher") {
  PlotPanel p = panel();
  p.series = {{"a", {0, 1, 2, 3, 4}}};
  const std::string svg = plot_svg({p});
  const std::size_t at = svg.find("points=\"") + 8;
  double x0 = 0, y0 = 0, x1 = 0, y1 = 0;
  REQUIRE(std::sscanf(svg.c_str() + at, "%lf,%lf %lf,%lf", &x0, &y0, &x1, &y1) == 4);
  CHECK(x1 > x0);
  CHECK(y1 < y0);
}

TEST_CASE("a band is drawn below the lines, and belongs to the range of the axis") {
  PlotPanel p = panel();
  const std::string without = plot_svg({p});
  p.series[0].low = {-20, -10, 0, -10, -20};
  p.series[0].high = {0, 10, 40, 10, 0};
  const std::string svg = plot_svg({p});
  CHECK(count(svg, "<polygon class=\"band\"") == 1);
  CHECK(svg.find("<polygon") < svg.find("<polyline"));
  CHECK(count(svg, ">40<") == 1);
  CHECK(count(without, ">40<") == 0);
  p.series[0].high.pop_back();
  CHECK_THROWS_AS(plot_svg({p}), std::invalid_argument);
}

TEST_CASE("series that do not fit their axis are refused") {
  PlotPanel p = panel();
  p.series[0].y.pop_back();
  CHECK_THROWS_AS(plot_svg({p}), std::invalid_argument);
  p = panel();
  p.series[0].y[2] = std::nan("");
  CHECK_THROWS_AS(plot_svg({p}), std::invalid_argument);
  p = panel();
  p.series.clear();
  CHECK_THROWS_AS(plot_svg({p}), std::invalid_argument);
}

}  // namespace stillbase
