// Contact configurations for paths that decide where the robot ends: at the base pose in which a
// path leaves a floating base with a stated start, or near the posture at which a path within the
// reaction null space ends.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include <stillbase/approach/approach.hpp>
#include <stillbase/core/interrupt.hpp>
#include <stillbase/formulation/formulation.hpp>
#include <stillbase/planner/planner.hpp>

#include "formulation/projection.hpp"
#include "planner/candidates.hpp"

namespace stillbase {

class ContactRefinement {
 public:
  /// @param x variables of the candidate to begin with
  /// @param candidate, certificate of the search
  ContactRefinement(const CaptureProblem& problem, const Eigen::VectorXd& x,
                    const Candidate& candidate, const Certificate& certificate,
                    const StopCondition& stop, const ContactRefinementOptions& options = {});

  /// For plan_approach(); refers to this object.
  ContactSolver solver();

  /// A configuration that the solver returned, certified.
  /// @param phi its posture, bit by bit
  /// @param base T_NB in which the path leaves the base
  CertifiedCandidate certify(const JointVectord& phi, const Pose& base) const;

  long optimizer_calls() const { return optimizer_calls_; }

 private:
  /// Variables of the best configuration for a base pose.
  struct Known {
    Pose base;
    Eigen::VectorXd x;
  };

  std::optional<Configuration> at_base(const Pose& base, ContactSolve how);
  std::optional<Configuration> near_posture(const JointVectord& phi, ContactSolve how);
  /// The problem's optimizer from x, then Newton's steps onto the constraints.
  ProjectionResult optimum(const CaptureProblem& problem, const Formulation& formulation,
                           const Eigen::VectorXd& x);
  CaptureProblem stated_at(const Pose& base) const;
  const Formulation& formulation();
  Eigen::VectorXd best_near(const Pose& base) const;

  const CaptureProblem& problem_;
  Candidate candidate_;
  Certificate certificate_;
  StopCondition stop_;
  ContactRefinementOptions options_;
  std::unique_ptr<Formulation> formulation_;  ///< null before it is asked for: mostly it is not
  std::vector<Known> best_;
  std::vector<std::pair<JointVectord, Eigen::VectorXd>> returned_;
  long optimizer_calls_ = 0;
};

}  // namespace stillbase
