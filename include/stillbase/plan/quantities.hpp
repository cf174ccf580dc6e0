// The catalogue of objective quantities: one row each, from which names, units, schemas and
// documentation come, and the map from the response to an impulse, from which value, gradient,
// packs and enclosures come.
//
// Every quantity is |y| or |y|^2, y a vector that is linear in the response (Power). What is
// minimised is 1/2 |y|^2. A new quantity is an enumerator, a row of the table in
// src/plan/quantities.cpp, and the verifier's own formula.
#pragma once

#include <cmath>
#include <optional>
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
  BaseEnergy,
  AttitudeTurned
};

/// How the value of a quantity follows from |y|. Searches, measures and proofs compute with |y|;
/// plans, bounds and gaps state values.
struct Power {
  int exponent = 1;  ///< 1: a length, such as that of a momentum; 2: a square, such as an energy

  double value(double length) const { return exponent == 1 ? length : length * std::abs(length); }
  double length(double value) const { return exponent == 1 ? value : std::sqrt(value); }
};

/// One of several quantities that are made small together: the sum of (|y_i| / |y_i|(size_i))^2,
/// that is (value / size)^2 of a length and value / size of a square.
struct ObjectiveTerm {
  ObjectiveQuantity quantity = ObjectiveQuantity::BaseAngularMomentum;
  double size = 1;    ///< value that counts as one, in the unit of the quantity
  double length = 1;  ///< BaseMomentum: m that turn angular into linear momentum
  double after = 0;   ///< AttitudeTurned: s after the impact, under the first controller
};

/// Components map * part / divisor of y, below those of other blocks. Of JointRates only
/// map(0, 0) counts.
struct QuantityBlock {
  ResponsePart part;
  Matrix3d map = Matrix3d::Identity();
  double divisor = 1;
};

struct QuantityRow {
  ObjectiveQuantity quantity;
  std::string name;           ///< in files and output
  std::string unit;           ///< SI, of the value
  std::string sentence;       ///< what it is
  bool needs_length = false;  ///< a term states `length`
  bool needs_time = false;    ///< a term states `after`, and the problem a controller
  Power power = {};
  /// Angular momentum that vanishes exactly where y does; empty: there is none.
  std::optional<ResponsePart> zero_momentum = {};
  /// y per unit of impulse; empty where y is no function of the response alone but simulated.
  std::vector<QuantityBlock> (*blocks)(const ObjectiveTerm& term,
                                       const RobotModel& robot) = nullptr;

  bool is_simulated() const { return blocks == nullptr; }
};

/// All quantities.
const std::vector<QuantityRow>& quantities();
const QuantityRow& row_of(ObjectiveQuantity quantity);
/// Null for an unknown name.
const QuantityRow* quantity_of_name(const std::string& name);

}  // namespace stillbase
