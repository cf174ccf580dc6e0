// Joint trajectories as CSV and as ROS message, read back.
#include <catch2/catch.hpp>

#include <cmath>
#include <sstream>

#include <stillbase/export/export.hpp>

#include "export/support.hpp"
#include "io/document.hpp"

using namespace stillbase;
using namespace stillbase::export_test;

namespace {

std::vector<std::vector<std::string>> csv_lines(const std::string& text) {
  std::vector<std::vector<std::string>> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) {
    lines.emplace_back();
    std::istringstream fields(line);
    for (std::string field; std::getline(fields, field, ',');) lines.back().push_back(field);
  }
  return lines;
}

}  // namespace

TEST_CASE("the CSV has joints, base and target at every sample, units and frames in its header") {
  const Plan& plan = floating_plan();
  const auto lines = csv_lines(trajectory_csv(plan));
  const std::vector<std::string>& header = lines.front();
  const int n = plan.problem.robot.n();
  REQUIRE(header.size() == static_cast<std::size_t>(1 + 4 * n + 13 + 13));
  CHECK(header[0] == "time_s");
  CHECK(header[1] == "joint_1_position_rad");
  CHECK(header[static_cast<std::size_t>(1 + n)] == "joint_1_velocity_rad_per_s");
  CHECK(header[static_cast<std::size_t>(1 + 2 * n)] == "joint_1_acceleration_rad_per_s2");
  CHECK(header[static_cast<std::size_t>(1 + 3 * n)] == "joint_1_torque_N_m");
  CHECK(header[static_cast<std::size_t>(1 + 4 * n)] == "base_position_x_in_N_m");
  CHECK(header.back() == "target_angular_velocity_z_in_N_rad_per_s");
  REQUIRE(lines.size() == plan.approach.times.size() + 1);
  const std::vector<TrajectorySample> samples = approach_samples(plan);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const std::vector<std::string>& row = lines[i + 1];
    REQUIRE(row.size() == header.size());
    CHECK(std::stod(row[0]) == samples[i].time);
    for (int k = 0; k < n; ++k) {
      const auto at = [&](int block) {
        return std::stod(row[static_cast<std::size_t>(1 + block * n + k)]);
      };
      CHECK(at(0) == samples[i].phi[k]);
      CHECK(at(1) == samples[i].phidot[k]);
      CHECK(at(3) == samples[i].tau[k]);
    }
    const std::size_t base = static_cast<std::size_t>(1 + 4 * n);
    CHECK(std::stod(row[base + 3]) == samples[i].base.orientation.w());
    CHECK(std::stod(row[base + 13]) == samples[i].target->pose.position.x());
  }
}

TEST_CASE("a name of a joint with a comma is one field of the CSV") {
  Plan plan = client_plan();
  plan.problem.robot.joints[0].name = "a,\"b\"";
  const std::string text = trajectory_csv(plan);
  CHECK(text.find(",\"a,\"\"b\"\"_position_rad\",") != std::string::npos);
}

TEST_CASE("the ROS message is YAML with the samples of the joints and times since the first one") {
  const Plan& plan = client_plan();
  const std::string text = ros_trajectory(plan);
  CHECK(text.find("# positions rad") != std::string::npos);
  io::ReadContext context{.source = "trajectory", .findings = {}, .known_keys = {}};
  const io::Node root = io::parse_document(text, context);
  CHECK(context.findings.empty());
  std::vector<std::string> names;
  for (const io::Node& name : root.find("joint_names")->items) names.push_back(name.text);
  CHECK(names == std::vector<std::string>{"joint_1", "joint_2", "joint_3"});
  const io::Node& points = *root.find("points");
  REQUIRE(points.items.size() == plan.approach.times.size());
  for (std::size_t i = 0; i < points.items.size(); ++i) {
    const io::Node& point = points.items[i];
    const auto check_list = [&](const char* key, const JointVectord& wanted) {
      const io::Node& list = *point.find(key);
      REQUIRE(list.items.size() == static_cast<std::size_t>(wanted.size()));
      for (std::size_t k = 0; k < list.items.size(); ++k) {
        const std::string& number = list.items[k].text;
        // A whole number, or 1e-05, is no float for some readers of YAML.
        CHECK(number.find('.') != std::string::npos);
        CHECK(std::stod(number) == wanted[static_cast<Eigen::Index>(k)]);
      }
    };
    check_list("positions", plan.approach.joint_positions[i]);
    check_list("velocities", plan.approach.joint_velocities[i]);
    check_list("accelerations", plan.approach.joint_accelerations[i]);
    check_list("effort", plan.approach.joint_torques[i]);
    const io::Node& time = *point.find("time_from_start");
    const long nanoseconds = std::stol(time.find("nanosec")->text);
    CHECK(nanoseconds >= 0);
    CHECK(nanoseconds < 1'000'000'000);
    CHECK(std::stod(time.find("sec")->text) + 1e-9 * static_cast<double>(nanoseconds) ==
          Approx(plan.approach.times[i] - plan.approach.times[0]).margin(1e-9).epsilon(0));
  }
}
