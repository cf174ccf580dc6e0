// The ten seconds after an impact, without control and under two controllers of the paper.
//
//   none           base rate 0.0160 deg/s after 10 s, attitude change at most 0.0641 deg
//   rns_damped     base rate 0.0000 deg/s after 10 s, attitude change at most 0.0021 deg
//
// Run from the root of the repository.
#include <cstdio>

#include <stillbase/stillbase.hpp>

int main() {
  using namespace stillbase;
  const CaptureProblem problem = read_problem("problems/planar_three_link_client.yaml");
  const Plan plan = make_plan(problem);

  double residual = 1;  // deg/s, of the last controller
  for (const char* controller : {"none", "joint_damping", "rns_damped"}) {
    const AfterContact run =
        simulate_post_impact(problem, plan.configuration, plan.impact, controller);
    const SimulationSummary& summary = run.simulation.summary;
    residual = summary.residual_base_rate * 180 / M_PI;
    std::printf("%-14s base rate %.4f deg/s after %.0f s, attitude change at most %.4f deg\n",
                controller, residual, problem.post_impact.horizon,
                summary.attitude_turned * 180 / M_PI);
  }
  // The motion itself is run.simulation.trace: pose, rates, momenta and torques over time.
  return residual < 0.01 ? 0 : 1;
}
