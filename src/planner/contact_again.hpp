// The contact solved anew where path and configuration depend on each other: for other base poses
// (a base that starts where it stands ends where the path leaves it), and near other postures (a
// path within the reaction null space reaches few of them easily).
#pragma once

#include <utility>
#include <vector>

#include <stillbase/approach/approach.hpp>
#include <stillbase/core/interrupt.hpp>
#include <stillbase/formulation/formulation.hpp>

#include "formulation/projection.hpp"
#include "planner/resolved.hpp"

namespace stillbase {

class ContactAgain {
 public:
  /// @param x variables of the candidate that it begins with
  /// @param candidate, certificate what the search says about it
  ContactAgain(const CaptureProblem& problem, const Eigen::VectorXd& x, const Candidate& candidate,
               const Certificate& certificate, const StopCondition& stop);

  /// For plan_approach; refers to this object.
  ContactSolver solver();

  /// A configuration that was returned, with all that a plan says about it.
  /// @param phi its posture, to the last bit; @param base T_NB where the path really leaves the
  /// base
  Resolved resolve(const JointVectord& phi, const Pose& base) const;

  long optimizer_calls() const { return optimizer_calls_; }

 private:
  /// Variables of the best configuration for a base pose.
  struct Known {
    Pose base;
    Eigen::VectorXd x;
  };

  std::optional<Configuration> at_base(const Pose& base, ContactSolve how);
  std::optional<Configuration> near_posture(const JointVectord& phi, ContactSolve how);
  /// The problem's optimizer from x, then Newton steps onto the constraints.
  ProjectionResult optimum(const CaptureProblem& problem, const Formulation& formulation,
                           const Eigen::VectorXd& x);
  CaptureProblem stated_at(const Pose& base) const;
  Eigen::VectorXd best_near(const Pose& base) const;

  const CaptureProblem& problem_;
  Candidate candidate_;
  Certificate certificate_;
  StopCondition stop_;
  Formulation formulation_;
  std::vector<Known> best_;
  std::vector<std::pair<JointVectord, Eigen::VectorXd>> returned_;
  long optimizer_calls_ = 0;
};

}  // namespace stillbase
