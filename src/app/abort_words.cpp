#include "app/abort_words.hpp"

#include <cmath>
#include <optional>

#include <fmt/format.h>

#include <stillbase/dynamics/kinematics.hpp>
#include <stillbase/plan/feature.hpp>
#include <stillbase/target/target.hpp>

namespace stillbase::app {

namespace {

constexpr int kLooks = 1000;        ///< over the time that is looked at
constexpr double kSameTime = 1e-3;  ///< s to which the first contact is found

/// Distance of the hand at rest from the plane of the feature, m.
class Gap {
 public:
  /// @param after s that it is asked for after the end of the path
  Gap(const CaptureProblem& problem, const AbortPath& path, double after)
      : feature_(chosen_feature(problem)),
        motion_(*problem.target, problem.target_state,
                std::abs(path.times.back() - problem.target_state.time) + after + 1) {
    const Pose& base = path.base_poses.back();
    const auto kinematics = compute_kinematics<double>(problem.robot, path.joint_positions.back());
    hand_ = base.position + base.orientation * kinematics.r_bh;
  }
  double at(double time) const {
    const ContactState contact = motion_.contact(feature_, time);
    return contact.normal.dot(hand_ - contact.point);
  }

 private:
  const ContactFeature& feature_;
  TargetMotion motion_;
  Vector3d hand_;
};

/// s after which the feature's plane has reached the hand; empty: not within `most`.
std::optional<double> time_to_contact(const Gap& gap, double from, double most) {
  for (int i = 1; i <= kLooks; ++i) {
    double apart = most * (i - 1) / kLooks, met = most * i / kLooks;
    if (gap.at(from + met) > 0) continue;
    while (met - apart > kSameTime) {
      const double middle = (apart + met) / 2;
      (gap.at(from + middle) > 0 ? apart : met) = middle;
    }
    return met;
  }
  return std::nullopt;
}

}  // namespace

std::string abort_words(const Plan& plan) {
  const AbortPath& path = *plan.approach.abort;
  const CaptureProblem problem = at_feature(plan.problem, plan.configuration.feature);
  const double end = path.times.back(), most = problem.post_impact.horizon;
  const Gap gap(problem, path, most);
  const std::optional<double> time = time_to_contact(gap, end, most);
  return fmt::format(
      "stops within {:.2f} s if the grasp does not close, {:.3g} m from the plane of the feature, "
      "which {}",
      end - path.times.front(), gap.at(end),
      time ? fmt::format("reaches the hand {:.2g} s later: what then has to be done is not planned",
                         *time)
           : fmt::format("does not reach it within the horizon of {:.4g} s", most));
}

}  // namespace stillbase::app
