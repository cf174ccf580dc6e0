// The direction cone of a problem that states how well its target is known.
#pragma once

#include <vector>

#include <stillbase/plan/problem.hpp>
#include <stillbase/target/prediction.hpp>

namespace stillbase {

/// The contact feature of a problem at instants spread evenly over the window of contact times,
/// ends included (one when the time is fixed), with the uncertainty of the estimate carried there.
/// @pre the problem has a target with its feature, a motion and deviations of it
/// @throws std::invalid_argument when the target turns by more than 300 rad until then or the
///   deviations allow for it
std::vector<ContactPrediction> predict_contacts(const CaptureProblem& problem);

struct DirectionCone {
  double half_angle = 0;     ///< rad
  ContactPrediction widest;  ///< the contact at which it is reached
};

/// The smallest cone (with `cone_plane_normal` the smallest wedge) about the predicted normal that
/// holds the true one with a probability whenever the contact is within the window: the largest of
/// the half-angles of predict_contacts(). A plane's normal is turned to N by the stated base pose.
/// @param probability in (0, 1)
/// @pre, @throws as predict_contacts()
DirectionCone direction_cone(const CaptureProblem& problem, double probability);

}  // namespace stillbase
