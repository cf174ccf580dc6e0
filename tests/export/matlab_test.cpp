#include <catch2/catch.hpp>

#include <cstdlib>
#include <iostream>
#include <regex>

#include <stillbase/core/file.hpp>
#include <stillbase/export/export.hpp>

#include "export/mat_reader.hpp"
#include "export/mat_writer.hpp"
#include "export/support.hpp"
#include "support/temporary_folder.hpp"

using namespace stillbase;
using namespace stillbase::export_test;

namespace {

bool is_field_name(const std::string& name) {
  return std::regex_match(name, std::regex("[A-Za-z][A-Za-z0-9_]{0,62}"));
}

void check_names(const MatVariable& variable) {
  for (const auto& structure : variable.structures) {
    for (const auto& [key, field] : structure) {
      INFO(key);
      CHECK(is_field_name(key));
      check_names(field);
    }
  }
  for (const MatVariable& cell : variable.cells) check_names(cell);
}

}  // namespace

TEST_CASE("a MAT-file of a plan holds its arrays, its texts and the samples as matrices") {
  const Plan& plan = floating_plan();
  const auto variables = MatReader(matlab_file(plan)).read();
  const MatVariable& file = variables.at("plan");
  check_names(file);
  const Approach& approach = plan.approach;
  const auto k = static_cast<Eigen::Index>(approach.times.size());
  const int n = plan.problem.robot.n();

  CHECK(file.at("status").ascii() == to_string(plan.status));
  CHECK(file.at("robot").at("urdf").text.size() == plan.problem.urdf.size());
  CHECK(file.at("configuration").at("joint_positions").values == plan.configuration.phi);
  CHECK(file.at("candidates").structures.size() == plan.candidates.size());
  CHECK(file.at("candidates").structures[1].at("objective").values(0, 0) ==
        plan.candidates[1].objective);
  CHECK(file.at("objective").at("judged").is_logical);
  CHECK(file.at("constraints").structures[0].at("name").ascii() == plan.constraints[0].name);
  const Eigen::MatrixXd& positions = file.at("approach").at("joint_positions").values;
  REQUIRE(positions.rows() == k);
  REQUIRE(positions.cols() == n);
  CHECK(file.at("solver_calls").at("sqp").values(0, 0) ==
        static_cast<double>(plan.solver_calls.at("sqp")));

  const MatVariable& trajectory = variables.at("trajectory");
  REQUIRE(trajectory.at("time").values.rows() == k);
  CHECK(trajectory.at("time_unit").ascii() == "s");
  CHECK(trajectory.at("base_position_unit").ascii() == "m, in N");
  REQUIRE(trajectory.at("target_position").values.cols() == 3);
  const std::vector<TrajectorySample> samples = approach_samples(plan);
  for (Eigen::Index i = 0; i < k; ++i) {
    const TrajectorySample& sample = samples[static_cast<std::size_t>(i)];
    CHECK(positions.row(i) == sample.phi.transpose());
    CHECK(trajectory.at("joint_torque").values.row(i) == sample.tau.transpose());
    CHECK(trajectory.at("base_position").values.row(i) == sample.base.position.transpose());
    CHECK(trajectory.at("base_quaternion").values(i, 0) == sample.base.orientation.w());
    CHECK(trajectory.at("target_position").values.row(i) ==
          sample.target->pose.position.transpose());
  }

  // Every member says its unit.
  const MatVariable& members = variables.at("members");
  REQUIRE(members.structures.size() > 100);
  bool has_torques = false;
  for (const auto& member : members.structures) {
    if (member.at("path").ascii() != "approach.joint_torques") continue;
    has_torques = true;
    CHECK(member.at("unit").ascii() == "N m (N)");
    CHECK(member.at("shape").ascii() == "k x n");
  }
  CHECK(has_torques);
  CHECK(variables.at("about").ascii().find("SI units") != std::string::npos);
}

TEST_CASE("the same plan gives the same bytes, and a plan without a path has no trajectory") {
  Plan plan = client_plan();
  CHECK(matlab_file(plan) == matlab_file(plan));
  plan.approach = {};
  const auto variables = MatReader(matlab_file(plan)).read();
  CHECK(variables.count("trajectory") == 0);
  CHECK(variables.at("plan").at("approach").at("times").values.size() == 0);
}

TEST_CASE("texts of a MAT-file are UTF-16, names of fields are those of MATLAB") {
  const auto read_text = [](const std::string& text) {
    return MatReader(mat::file("MATLAB 5.0 MAT-file", {mat::text_row(text, "x")})).read().at("x");
  };
  CHECK(read_text("a\xc3\xa4\xe2\x82\xac\xf0\x9f\x9b\xb0").text == u"a\u00e4\u20ac\U0001f6f0");
  CHECK(read_text("\xff").text == u"\ufffd");
  CHECK(read_text("").rows == 0);
  CHECK(mat::field_name("nlopt-slsqp") == "nlopt_slsqp");
  CHECK(mat::field_name("1st joint") == "x1st_joint");
  CHECK(mat::field_name("_a") == "x_a");
  CHECK(mat::field_name("") == "x");
  CHECK(mat::field_name(std::string(100, 'a')).size() == 63);
}

TEST_CASE("scipy reads the MAT-file") {
  if (std::system("python3 -c 'import scipy.io' 2>/dev/null") != 0) {
    std::cout << "skipped: python3 has no scipy\n";
    return;
  }
  const Plan& plan = client_plan();
  const TemporaryFolder folder;
  write_file_atomically(folder.path("plan.mat"), matlab_file(plan), false);
  const std::string check =
      "import scipy.io\n"
      "f = scipy.io.loadmat('" +
      folder.path("plan.mat") +
      "', squeeze_me=True, struct_as_record=False)\n"
      "assert f['plan'].status == 'optimal', f['plan'].status\n"
      "assert f['plan'].approach.joint_positions.shape == f['trajectory'].joint_position.shape\n"
      "assert (f['plan'].approach.times == f['trajectory'].time).all()\n"
      "assert any(m.path == 'approach.times' and m.unit == 's' for m in f['members'])\n";
  CHECK(std::system(("python3 " + folder.write("check.py", check)).c_str()) == 0);
}
