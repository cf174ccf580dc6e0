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
  Energy,
  Stiffness,        ///< of a revolute joint
  Damping,          ///< of a revolute joint
  LinearStiffness,  ///< of a prismatic joint or a contact
  LinearDamping     ///< of a prismatic joint or a contact
};

/// The dimensions of a value at a revolute and at a prismatic joint, and the name of both in
/// schemas.
struct JointDimension {
  const char* name;
  Dimension revolute, prismatic;
};
inline constexpr JointDimension kJointPosition{"joint_position", Dimension::Angle,
                                               Dimension::Length},
    kJointVelocity{"joint_velocity", Dimension::AngularVelocity, Dimension::Velocity},
    kJointAcceleration{"joint_acceleration", Dimension::AngularAcceleration,
                       Dimension::Acceleration},
    kJointInertia{"joint_inertia", Dimension::Inertia, Dimension::Mass},
    kJointStiffness{"joint_stiffness", Dimension::Stiffness, Dimension::LinearStiffness},
    kJointDamping{"joint_damping", Dimension::Damping, Dimension::LinearDamping};

/// "angle": name of a dimension in schemas.
std::string name_of(Dimension dimension);

/// Factor that takes a number in this unit to SI, when the unit has the dimension.
std::optional<double> unit_factor(std::string_view unit, Dimension dimension);

/// Dimension of a unit of which files may use others; None where there is no other.
Dimension dimension_of_unit(std::string_view unit);

/// True when the unit exists, whatever its dimension.
bool is_unit(std::string_view unit);

/// "deg, rad": the units of a dimension, for messages.
std::string units_of(Dimension dimension);

}  // namespace stillbase::io
