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
  /// @param most_rotation rad between an estimate and an instant
  ContactPredictor(const TargetBody& body, const ContactFeature& feature, double most_rotation);

  /// As predict_contact() with a covariance of the state alone, one element of `out` for each of
  /// the times that they name.
  /// @return false: the covariance is not finite, symmetric and positive semidefinite, or the
  ///   target may rotate too far
  [[nodiscard]] bool predict(const TargetState& estimate, const StateCovariance& covariance,
                             std::vector<ContactPrediction>& out);

 private:
  bool fits(const TargetState& estimate, double horizon) const;

  ContactFeature feature_;
  double most_rotation_;
  MotionTable motion_, point_;
};

}  // namespace stillbase
