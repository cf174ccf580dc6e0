// The approach: path, time law and motion of the floating base to the chosen posture.
//
//   15.0 s of motion, clearance 0.040 m
//   attitude change of the base at most 30.6 deg
//
// Run from the root of the repository; writes approach.csv beside it where a path is given.
#include <cstdio>
#include <fstream>

#include <stillbase/stillbase.hpp>

int main(int argc, char** argv) {
  using namespace stillbase;
  const CaptureProblem problem = read_problem("problems/iiwa_client_50.yaml");
  const Plan plan = make_plan(problem);
  const Approach& approach = plan.approach;
  if (approach.status != ApproachStatus::Found) {
    std::printf("no approach: %s\n", approach.detail.c_str());
    return 1;
  }
  std::printf("%.1f s of motion, clearance %.3f m\n", approach.duration, approach.min_clearance);
  std::printf("attitude change of the base at most %.1f deg\n",
              approach.attitude_excursion * 180 / M_PI);

  // Samples of a piecewise cubic: time, joint positions and rates, pose and velocity of the base.
  if (argc < 2) return 0;
  std::ofstream table(argv[1]);
  for (std::size_t i = 0; i < approach.times.size(); ++i) {
    table << approach.times[i];
    for (const double phi : approach.joint_positions[i]) table << ',' << phi;
    table << '\n';
  }
  return table ? 0 : 1;
}
