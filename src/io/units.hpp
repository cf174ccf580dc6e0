// Units of numbers in files.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace stillbase::io {

enum class Dimension {
  None,
  Angle,
  AngularVelocity,
  AngularAcceleration,
  Length,
  Velocity,
  Acceleration,
  JointPosition,  ///< an angle or a length: of a joint of either kind
  Mass,
  Inertia,
  Time,
  Rate,
  Force,
  Moment,
  Impulse,
  AngularImpulse,
  Stiffness,        ///< of a revolute joint
  Damping,          ///< of a revolute joint
  LinearStiffness,  ///< of a prismatic joint or a contact
  LinearDamping     ///< of a prismatic joint or a contact
};

/// Factor that takes a number in this unit to SI, when the unit has the dimension.
std::optional<double> unit_factor(std::string_view unit, Dimension dimension);

/// True when the unit exists, whatever its dimension.
bool is_unit(std::string_view unit);

/// "deg, rad": the units of a dimension, for messages.
std::string units_of(Dimension dimension);

}  // namespace stillbase::io
