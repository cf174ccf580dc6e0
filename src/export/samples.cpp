#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/encounter/target_motion.hpp>
#include <stillbase/export/export.hpp>

namespace stillbase {

std::vector<TrajectorySample> approach_samples(const Plan& plan) {
  const Approach& approach = plan.approach;
  if (approach.times.empty()) {
    throw InputError({{plan.problem.name, 0, "no-approach",
                       "the plan has no approach path (approach.status is " +
                           to_string(approach.status) + ")"}});
  }
  const auto motion = encounter_motion(plan.problem, plan.configuration);
  std::vector<TrajectorySample> samples;
  for (std::size_t i = 0; i < approach.times.size(); ++i) {
    TrajectorySample sample;
    sample.time = approach.times[i];
    sample.phi = approach.joint_positions[i];
    sample.phidot = approach.joint_velocities[i];
    sample.phiddot = approach.joint_accelerations[i];
    sample.tau = approach.joint_torques[i];
    sample.base = approach.base_poses[i];
    sample.Omega = approach.base_velocities[i];
    try {
      if (motion) sample.target = motion->state(sample.time);
    } catch (const std::out_of_range& error) {
      throw InputError({{plan.problem.name, 0, "times",
                         fmt::format("approach.times: at {} s: {}", sample.time, error.what())}});
    }
    samples.push_back(std::move(sample));
  }
  return samples;
}

}  // namespace stillbase
