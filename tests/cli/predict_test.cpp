// The target's motion over time, and the contact windows of check.
#include <catch2/catch.hpp>
#include <cmath>
#include <iomanip>
#include <sstream>

#include <nlohmann/json.hpp>

#include "cli/tool.hpp"

using namespace stillbase::cli_test;
using nlohmann::json;

namespace {

const std::string kClient = "'" + source_path("problems/iiwa_client_50.yaml") + "'";

/// With standard deviations of the estimate.
const std::string kKnown = "'" + source_path("problems/ets7_client.yaml") + "'";

double at(const json& numbers, int i) { return numbers.at(static_cast<std::size_t>(i)); }

}  // namespace

TEST_CASE("predict moves the centroid straight and turns the features with the target") {
  const Workshop shop;
  const Outcome outcome = shop.run("predict " + kClient + " --from 0 --to 72 --step 36 --json");
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const json prediction = json::parse(outcome.out);
  CHECK(prediction.at("format") == "stillbase.prediction");
  const json& instants = prediction.at("instants");
  REQUIRE(instants.size() == 3);
  for (const json& instant : instants) {
    const double t = instant.at("time");
    CHECK(at(instant.at("position"), 0) == Approx(4.9 - 0.05 * t));
    for (const json& feature : instant.at("features")) {
      double closing = 0;
      for (int i = 0; i < 3; ++i) {
        closing += at(feature.at("normal"), i) * at(feature.at("velocity"), i);
      }
      CHECK(std::abs(feature.at("closing_speed").get<double>() - closing) < 1e-12);
      CHECK_FALSE(feature.contains("covariance"));
    }
  }
  // A revolution of 72 s about a principal direction of a body with equal moments is the identity.
  const json &first = instants[0].at("orientation"), &last = instants[2].at("orientation");
  double dot = 0;
  for (const char* part : {"w", "x", "y", "z"}) {
    dot += first.at(part).get<double>() * last.at(part).get<double>();
  }
  CHECK(std::abs(dot) == Approx(1).epsilon(1e-3));
}

TEST_CASE("predict takes times with units") {
  const Workshop shop;
  const Outcome seconds =
      shop.run("predict " + kClient + " --from -60 --to 72.5 --step 0.5 --json");
  REQUIRE(seconds.code == 0);
  const Outcome units =
      shop.run("predict " + kClient + " --from -1min --to '72.5 s' --step 500ms --json");
  CHECK(units.out == seconds.out);
}

TEST_CASE("predict says which errors of the target are not known") {
  const Workshop shop;
  const std::string range = " --from 0 --to 1 --step 1";
  const Outcome known = shop.run("predict " + kKnown + range);
  CHECK(known.out.find("root mean square errors: point m") != std::string::npos);
  CHECK(known.err.empty());
  const Outcome nominal = shop.run("predict " + kClient + range);
  CHECK(nominal.out.find("root mean square") == std::string::npos);
  CHECK(nominal.says("target.state.covariance is not stated"));
  CHECK(nominal.says("their standard deviations are not known"));
  CHECK(shop.run("predict targets/client_50.yaml" + range).says("a target alone has no estimate"));
  shop.write_changed("part.yaml", "problems/ets7_client.yaml", "      orientation: 2 deg\n", "");
  CHECK(shop.run("predict part.yaml" + range)
            .says("covariance states no error of orientation: they count as exact"));
}

TEST_CASE("predict states the covariance of features where the estimate has one") {
  const Workshop shop;
  const std::string command = "predict " + kKnown + " --from 0 --to 10 --step 10";
  const json prediction = json::parse(shop.run(command + " --json").out);
  const json& instants = prediction.at("instants");
  const auto trace = [](const json& covariance) {
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) sum += covariance.at(i).at(i).get<double>();
    return sum;
  };
  for (std::size_t i = 0; i < instants[0].at("features").size(); ++i) {
    const json& before = instants[0].at("features")[i].at("covariance");
    const json& after = instants[1].at("features")[i].at("covariance");
    REQUIRE(before.size() == 9);
    REQUIRE(before[0].size() == 9);
    CHECK(trace(before) > 0);
    CHECK(trace(after) > trace(before));  // velocities are uncertain too
  }
  REQUIRE(shop.run(command + " -o rows.csv").code == 0);
  const std::string csv = shop.text("rows.csv");
  const auto commas = [](const std::string& line) {
    return std::count(line.begin(), line.end(), ',');
  };
  std::istringstream lines(csv);
  std::string head, line;
  std::getline(lines, head);
  int count = 0;
  for (; std::getline(lines, line); ++count) CHECK(commas(line) == commas(head));
  CHECK(count == 2 * (1 + static_cast<int>(instants[0].at("features").size())));
  // A table has room for one number of a point: the root of the trace, which says so.
  const std::string table = shop.run(command).out;
  CHECK(table.find("root mean square errors: point m, normal deg, velocity m/s") !=
        std::string::npos);
  CHECK(table.find("standard deviation") == std::string::npos);
  const json& first = instants[0].at("features")[0].at("covariance");
  std::ostringstream root;
  root << std::setprecision(3) << std::sqrt(trace(first));
  CHECK(table.find("   " + root.str() + " ") != std::string::npos);
}

TEST_CASE("predict takes a target alone with its angular velocity") {
  const Workshop shop;
  const std::string target = "predict targets/client_224.yaml --from 0 --to 1 --step 1";
  const Outcome outcome = shop.run(target + " --angular-velocity 0 0 0.5 --json");
  INFO(outcome.err);
  REQUIRE(outcome.code == 0);
  const json rows = json::parse(outcome.out).at("instants");
  CHECK(rows[0].at("orientation").at("w") == 1);
  CHECK(rows[1].at("orientation").at("z").get<double>() == Approx(std::sin(0.25)).epsilon(1e-2));
  CHECK(shop.run("predict " + kClient + " --from 0 --to 1 --step 1 --angular-velocity 0 0 1")
            .says("for target files"));
}

TEST_CASE("predict refuses ranges that are none, too long, or too many rows") {
  const Workshop shop;
  const auto refuses = [&](const std::string& range, const std::string& reason) {
    const Outcome outcome = shop.run("predict " + kClient + " " + range);
    INFO(range << ": " << outcome.err);
    CHECK(outcome.code == 2);
    CHECK(outcome.says(reason));
  };
  refuses("--from 5 --to 1 --step 1", "is before --from");
  refuses("--from nan --to 1 --step 1", "in [-1e+06, 1e+06]");
  refuses("--from 0 --to 1e400 --step 1", "");
  refuses("--from 0 --to 1 --step 0", "> 0");
  refuses("--from 0 --to 1 --step -1", "> 0");
  refuses("--from 0 --to 1e6 --step 0.001", "rows");
  refuses("--from 0 --to 1e300 --step 1e299", "in [-1e+06, 1e+06]");
  refuses("--from '1 deg' --to 1 --step 1", "with one of the units s, ms, min, h");
  refuses("--from 0 --to 9e5 --step 1e5", "rad");
  refuses("--from 0 --to 1", "--step");
  // Without a motion of the target there is nothing to predict.
  const Outcome stated = shop.run("predict '" + source_path("problems/planar_two_link_c2_a.yaml") +
                                  "' --from 0 --to 1 --step 1");
  CHECK(stated.code == 2);
  CHECK(stated.says("impact.direction"));
  // The covariance of an estimate is not carried over any number of revolutions.
  const Outcome known = shop.run("predict " + kKnown + " --from 0 --to 1e6 --step 1e5");
  CHECK(known.code == 2);
  CHECK(known.says("300 rad"));
}

TEST_CASE("check lists the contact windows and writes them as CSV and SVG") {
  const Workshop shop;
  const Outcome listed = shop.run("check " + kClient);
  CHECK(listed.out.find("contact windows from") != std::string::npos);
  CHECK(listed.out.find("plus_x: ") != std::string::npos);
  REQUIRE(shop.run("check " + kClient + " -o windows.csv").code == 0);
  CHECK(shop.text("windows.csv").find("plus_x_closing_m_s") != std::string::npos);
  REQUIRE(shop.run("check " + kClient + " -o windows.svg").code == 0);
  CHECK(shop.text("windows.svg").find("<svg") != std::string::npos);
  const Outcome two = shop.run("check " + kClient + " " + kKnown + " -o both.csv");
  CHECK(two.code == 2);
  CHECK(two.says("one problem"));
  const Outcome stated =
      shop.run("check '" + source_path("problems/planar_two_link_c2_a.yaml") + "' -o none.svg");
  CHECK(stated.code == 2);
  CHECK(stated.says("no contact windows"));
}

TEST_CASE("a plan that finds nothing says when features can be met") {
  const Workshop shop;
  shop.write_changed("problem.yaml", "problems/iiwa_client_50.yaml",
                     "contact_time: {lower: 69 s, upper: 75 s}",
                     "contact_time: {lower: 30 s, upper: 31 s}");
  const Outcome outcome = shop.run("plan problem.yaml --starts 2 -o plan.json");
  INFO(outcome.err);
  CHECK(outcome.code == 4);
  CHECK(outcome.says("contact windows from"));
}
