// The catalogue of objective quantities: one row each, from which names, units, schemas and
// documentation come, and the map from the response to an impulse, from which value, gradient,
// packs and enclosures come.
//
// Every quantity is the length |y| of a vector y that is linear in the response: its value is a
// root, what is minimised is 1/2 |y|^2. A new quantity is an enumerator, a row of the table in
// src/plan/quantities.cpp, and the verifier's own formula.
#pragma once

#include <string>
#include <vector>

#include <stillbase/impact/response_parts.hpp>
#include <stillbase/robot/robot_model.hpp>

namespace stillbase {

enum class ObjectiveQuantity {
  BaseAngularMomentum,
  BaseAngularVelocity,
  TotalAngularMomentum,
  BaseMomentum,
  ImpulseMagnitude,
  JointRateNorm,
  AttitudeTurned
};

/// One of several quantities that are made small together: sum (|y_i| / size_i)^2.
struct ObjectiveTerm {
  ObjectiveQuantity quantity = ObjectiveQuantity::BaseAngularMomentum;
  double size = 1;    ///< value that counts as one, in the unit of the quantity
  double length = 1;  ///< BaseMomentum: m that turn angular into linear momentum
  double after = 0;   ///< AttitudeTurned: s after the impact, under the first controller
};

/// Components map * part / divisor of y, below those of other blocks. Of JointRates and Impulse
/// only map(0, 0) counts.
struct QuantityBlock {
  ResponsePart part;
  Matrix3d map = Matrix3d::Identity();
  double divisor = 1;
};

struct QuantityRow {
  ObjectiveQuantity quantity;
  std::string name;      ///< in files and output
  std::string unit;      ///< SI, of the value
  std::string sentence;  ///< what it is
  bool needs_length;     ///< a term states `length`
  bool needs_time;       ///< a term states `after`, and the problem a controller
  /// y per unit of impulse; empty where y is no function of the response alone but simulated.
  std::vector<QuantityBlock> (*blocks)(const ObjectiveTerm& term, const RobotModel& robot);

  bool is_simulated() const { return blocks == nullptr; }
};

/// All quantities.
const std::vector<QuantityRow>& quantities();
const QuantityRow& row_of(ObjectiveQuantity quantity);
/// Null for an unknown name.
const QuantityRow* quantity_of_name(const std::string& name);

}  // namespace stillbase
