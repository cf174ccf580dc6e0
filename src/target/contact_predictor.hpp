// predict_contact() of one body and one feature, for estimates that follow each other.
#pragma once

#include <vector>

#include <stillbase/target/estimate.hpp>
#include <stillbase/target/prediction.hpp>

#include "target/motion_table.hpp"

namespace stillbase {

/// Keeps the tables of motion: predictions do not allocate.
class ContactPredictor {
 public:
  /// @param body_errors of mass and moments, which estimates of the state say nothing of; all else
  ///   in it does not count
  /// @param most_rotation rad between an estimate and an instant
  ContactPredictor(const TargetBody& body, const ContactFeature& feature, double most_rotation,
                   const EstimateDeviations& body_errors = {});

  /// As predict_contact() with the covariance of the state and these errors of the body, one
  /// element of `out` for each of the times that they name.
  /// @return false: the covariance is not finite, symmetric and positive semidefinite, or the
  ///   target may rotate too far
  [[nodiscard]] bool predict(const TargetState& estimate, const StateCovariance& covariance,
                             std::vector<ContactPrediction>& out);

 private:
  /// What an error of the body leaves of it.
  struct OtherBody {
    double mass;
    Matrix3d inertia;
  };
  bool fits(const MotionTable& table, const TargetState& estimate, double horizon) const;
  bool add_point(const TargetState& state, double horizon, std::vector<ContactPrediction>& out);

  ContactFeature feature_;
  double most_rotation_;
  MotionTable motion_, point_;
  std::vector<OtherBody> others_;
};

}  // namespace stillbase
