#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>

#include "verification/example_plans.hpp"
#include "verification/target_prediction.hpp"

using namespace stillbase;
using namespace stillbase::verification;

namespace {

TargetBody tumbling_body() {
  TargetBody body;
  body.mass = 80;
  body.inertia << 7, 0.3, -0.2, 0.3, 9, 0.4, -0.2, 0.4, 12;
  body.features = {{"ring", {0.4, 0.1, -0.2}, Vector3d(1, 0.1, 0).normalized()}};
  return body;
}

TargetState estimate() {
  TargetState state;
  state.time = 5;
  state.pose = {{3, -1, 0.5}, rotation_exp({0.3, -0.8, 0.5})};
  state.linear_velocity = {-0.02, 0.01, 0.005};
  state.angular_velocity = {0.03, 0.08, -0.05};
  return state;
}

double largest(const TargetBody& body, const TargetState& state, const TargetMotion& motion) {
  const auto found = prediction_difference(body, state, motion, {-40, 5, 100}, {});
  CHECK(found.complete);
  CHECK(found.growth < 1e-11);
  return found.largest;
}

}  // namespace

TEST_CASE("a prediction agrees with its second integration, and a wrong one does not") {
  const TargetBody body = tumbling_body();
  const TargetState state = estimate();
  CHECK(largest(body, state, TargetMotion(body, state, 200)) < 1e-13);

  TargetBody other = body;
  other.inertia(0, 0) *= 1 + 1e-6;
  CHECK(largest(body, state, TargetMotion(other, state, 200)) > 1e-9);
  TargetState wrong = state;
  wrong.angular_velocity.y() *= 1 + 1e-7;
  CHECK(largest(body, state, TargetMotion(body, wrong, 200)) > 1e-9);
  wrong = state;
  wrong.linear_velocity.z() += 1e-8;
  CHECK(largest(body, state, TargetMotion(body, wrong, 200)) > 1e-9);
  wrong = state;
  wrong.pose.position.x() += 1e-6;
  CHECK(largest(body, state, TargetMotion(body, wrong, 200)) > 1e-9);
}

TEST_CASE("where rounding decides how a target tumbles, its prediction is not verified") {
  TargetBody body = tumbling_body();
  body.inertia = Vector3d(1, 2, 3).asDiagonal();
  TargetState state = estimate();
  state.pose.orientation.setIdentity();
  state.angular_velocity = {0, 0.5, 0};
  const TargetMotion motion(body, state, 300);
  CHECK(prediction_difference(body, state, motion, {200}, {}).growth > 1e-9);
  state.angular_velocity = {0, 0, 0.5};
  CHECK(prediction_difference(body, state, TargetMotion(body, state, 300), {200}, {}).growth <
        1e-11);
}

TEST_CASE("plans of rotating targets state a prediction that is verified") {
  const auto claims_of = [](const Plan& plan) {
    ClaimList claims;
    (void)check_plan(plan, {}, [&](const Context& context, ClaimList&) {
      check_target_prediction(context, claims);
    });
    return claims.claims();
  };
  Plan plan = verification_test::arm_plan();
  REQUIRE(claims_of(plan).size() == 1);
  CHECK(claims_of(plan).front().pass);
  CHECK(*claims_of(plan).front().value < 1e-12);

  plan.problem.target_state.angular_velocity.setZero();
  CHECK(claims_of(plan).empty());
  CHECK(claims_of(verification_test::straight_plan()).empty());  // along a stated direction
}
