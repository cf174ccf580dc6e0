// The direction cone of a problem that states how well its target is known.
#pragma once

#include <optional>
#include <string>

#include <stillbase/plan/problem.hpp>
#include <stillbase/target/prediction.hpp>

namespace stillbase {

/// Largest rotation of a target over which its covariance is propagated, rad: beyond it the
/// direction is a guess, and the integration takes seconds.
inline constexpr double kMaxPredictedRotation = 300;

/// Upper bound (rad) of the rotation of the target over `duration` (s), deviations of the estimate
/// counted in.
double rotation_bound(const TargetEstimate& estimate, const EstimateDeviations& deviations,
                      double duration);

/// Parts of the window of contact times, whose ends direction_cone() looks at.
inline constexpr int kConeIntervals = 8;

/// Probability of a cone where none is stated.
inline constexpr double kDefaultConeConfidence = 0.95;

struct DirectionCone {
  double half_angle = 0;     ///< rad
  ContactPrediction widest;  ///< the contact at which it is reached
};

/// The smallest cone (with `cone_plane_normal` the smallest wedge) about the nominal normal that
/// holds the true one with a probability whenever the contact is within the window: the largest of
/// the half-angles at instants spread evenly over the window. A plane's normal is rotated to N by
/// the stated base pose.
/// @param probability in (0, 1)
/// @pre the problem has a target with its feature, a motion and deviations of it
/// @throws std::invalid_argument when the target rotates by more than 300 rad until then or the
///   deviations allow for it
DirectionCone direction_cone(const CaptureProblem& problem, double probability);

/// Radius (m) of the smallest ball about the nominal contact point that holds the true one with a
/// probability whenever the contact is within the window: of the instants of direction_cone() the
/// largest. Errors of the point are taken as Gaussian of mean zero.
/// @param probability in (0, 1)
/// @pre as direction_cone()
/// @throws std::invalid_argument as direction_cone()
double contact_radius(const CaptureProblem& problem, double probability);

/// A stated cone, or none, in a problem whose target is known less well.
struct NarrowCone {
  double stated = 0;       ///< half-angle, rad; 0: the direction counts as exactly known
  double implied = 0;      ///< that of direction_cone() at the probability, rad
  double probability = 0;  ///< kDefaultConeConfidence
  bool is_wedge = false;   ///< both are angles in a plane
};
inline constexpr const char* kNarrowConeRule = "narrow-cone";
std::string to_string(const NarrowCone& cone);

/// Empty where the cone holds 95 % of the directions that the covariance of the target's estimate
/// gives, where no covariance is stated, and where the contact has no cone: it sticks or latches,
/// or the problem states a residual velocity. A target whose contact cannot be predicted has an
/// implied angle of pi.
/// @pre the problem is consistent
std::optional<NarrowCone> narrow_cone(const CaptureProblem& problem);

}  // namespace stillbase
