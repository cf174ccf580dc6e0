// When contact features face the base and close in.
#include <catch2/catch.hpp>
#include <cmath>

#include <stillbase/encounter/contact_window.hpp>

#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

/// A ball-like target 2.5 m from the base that spins about z and comes in along -x: its only
/// feature is at its centroid but for its normal, so the closing speed is v cos(omega t).
CaptureProblem spinning_problem() {
  CaptureProblem problem = test::shipped("iiwa_client_50");
  TargetBody& body = *problem.target;
  body.inertia = Vector3d(5, 5, 5).asDiagonal();
  body.features = {{"face", Vector3d::Zero(), -Vector3d::UnitX()}};
  problem.variables.feature = "face";
  TargetState& state = problem.target_state;
  state = {};
  state.pose.position = Vector3d(2.5, 0, 0);
  state.linear_velocity = Vector3d(-0.05, 0, 0);
  state.angular_velocity = Vector3d(0, 0, 0.1);
  problem.base = {};
  problem.variables.contact_time_lower = problem.variables.contact_time_upper = 10;
  problem.constraints.closing_speed_min = 0.03;
  return problem;
}

}  // namespace

TEST_CASE("a contact window opens and closes where the closing speed passes its least value") {
  const CaptureProblem problem = spinning_problem();
  const WindowSurvey survey = survey_contact_windows(problem);
  CHECK(survey.from == 0);  // not before the estimate
  CHECK(survey.to == Approx(10 + 2 * kPi / 0.1));
  REQUIRE(survey.features.size() == 1);
  const FeatureWindows& face = survey.features.front();
  REQUIRE(face.windows.size() == 1);
  CHECK(face.windows[0].from == 0);
  // v cos(omega t) = 0.03; the next revolution comes when the target has passed the base.
  CHECK(std::abs(face.windows[0].to - std::acos(0.6) / 0.1) < 1e-8);
  for (const FeatureView& view : face.views) {
    CHECK(std::abs(view.closing_speed - 0.05 * std::cos(0.1 * view.time)) < 1e-12);
    CHECK(std::abs(view.distance - std::abs(2.5 - 0.05 * view.time)) < 1e-12);
  }
}

TEST_CASE("a contact window states the least and the largest closing speed within it") {
  CaptureProblem problem = spinning_problem();
  problem.target_state.pose.position.x() = 5;  // in front of the base for a whole revolution
  const WindowSurvey survey = survey_contact_windows(problem);
  const std::vector<ContactWindow>& windows = survey.features.front().windows;
  REQUIRE(windows.size() == 2);
  // v cos(omega t) is largest at the survey's begin, and again inside the second window.
  CHECK(windows[1].from < 2 * kPi / 0.1);
  CHECK(windows[1].to > 2 * kPi / 0.1);
  for (const ContactWindow& window : windows) {
    CHECK(std::abs(window.least_closing_speed - 0.03) < 1e-10);
    CHECK(std::abs(window.largest_closing_speed - 0.05) < 1e-12);
  }
}

TEST_CASE("a feature that points away from the base has no contact window though it closes in") {
  CaptureProblem problem = spinning_problem();
  problem.base.position = Vector3d(40, 0, 0);  // behind the target
  const WindowSurvey survey = survey_contact_windows(problem);
  for (const ContactWindow& window : survey.features.front().windows) {
    CHECK(window.from > kPi / 2 / 0.1 * 0.99);
  }
}

TEST_CASE("the shipped client's window holds the contact times that its problem searches") {
  const WindowSurvey survey = survey_contact_windows(test::shipped("iiwa_client_50"));
  bool holds = false;
  for (const FeatureWindows& feature : survey.features) {
    for (const ContactWindow& window : feature.windows) {
      holds = holds || (feature.feature == "plus_x" && window.from <= 69 && window.to >= 75);
    }
  }
  CHECK(holds);
}

TEST_CASE("a stated direction of the impulse has no contact windows") {
  CHECK(survey_contact_windows(test::shipped("planar_two_link_c2_a")).features.empty());
}

}  // namespace stillbase
