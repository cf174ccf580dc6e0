// The target's motion towards many configurations of one problem.
#pragma once

#include <stillbase/encounter/target_motion.hpp>

namespace stillbase {

/// encounter_motion() of one configuration after the other. Where it is the motion of the estimate
/// its table is made once: that takes longer than asking it some hundred times.
class EncounterMotions {
 public:
  /// @param problem outlives this
  /// @param known of its estimate, if there is one already
  explicit EncounterMotions(const CaptureProblem& problem,
                            const std::optional<TargetMotion>& known = {})
      : problem_(problem), of_estimate_(known) {
    if (problem.impulse.direction || known) return;
    of_estimate_ = encounter_motion(problem, Vector3d::Zero(), problem.base.orientation, 0);
  }

  std::optional<TargetMotion> towards(const Configuration& configuration) const {
    return of_estimate_ ? of_estimate_ : encounter_motion(problem_, configuration);
  }

 private:
  const CaptureProblem& problem_;
  std::optional<TargetMotion> of_estimate_;
};

}  // namespace stillbase
