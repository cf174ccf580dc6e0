// Joint rates of a hand that moves before the contact: planner against reference.
#include <catch2/catch.hpp>

#include "formulation/formulation_parts.hpp"
#include "support/shipped_problem.hpp"
#include "verification/recomputation.hpp"

namespace stillbase {

TEST_CASE("joint rates that match a velocity are known beside a singular posture too") {
  CaptureProblem problem = test::without_path("matched_medium");
  problem.hand_motion.rates = GENERATE(ArrivalRates::LeastJointRate, ArrivalRates::LeastBaseRate);
  const Formulation formulation(problem);
  const CaptureModel& model = formulation.parts().model;
  const Eigen::VectorXd u = Eigen::VectorXd::Constant(formulation.num_variables(), 0.4);
  Configuration at = formulation.configuration(formulation.start_point(u));
  // The least singular value of the Jacobian of a stretched arm is about a tenth of its bends.
  for (const double bend : {1e-1, 1e-3, 1e-5}) {
    INFO("bent by " << bend << " rad");
    at.phi << 1.5, bend, bend, bend, bend, 1.9, -2.4;
    const auto place = model.place<double>(formulation.variables(at));
    const auto impact = model.impact(place, model.posture(place), model.nominal);
    const HandMotion<double>& found = impact.rigid.before;
    const verification::Situation situation(problem, at);
    const verification::MotionOfRobot& expected = *situation.response.before;
    const double apart = (found.phidot - expected.phidot).norm() / expected.phidot.norm();
    CHECK(apart < 1e-14 / bend);
    CHECK((found.V - expected.hand).norm() < 1e-14 * expected.phidot.norm());
  }
}

}  // namespace stillbase
