#include "io/units.hpp"

#include <array>

#include <stillbase/core/constants.hpp>

namespace stillbase::io {

namespace {

struct Unit {
  std::string_view name;
  Dimension dimension;
  double factor;
};

constexpr double kDegree = kPi / 180;

// The SI unit comes first in each dimension.
constexpr std::array kUnits{
    Unit{"rad", Dimension::Angle, 1},
    Unit{"deg", Dimension::Angle, kDegree},
    Unit{"rad/s", Dimension::AngularVelocity, 1},
    Unit{"deg/s", Dimension::AngularVelocity, kDegree},
    Unit{"rad/s^2", Dimension::AngularAcceleration, 1},
    Unit{"deg/s^2", Dimension::AngularAcceleration, kDegree},
    Unit{"m", Dimension::Length, 1},
    Unit{"cm", Dimension::Length, 0.01},
    Unit{"mm", Dimension::Length, 0.001},
    Unit{"m/s", Dimension::Velocity, 1},
    Unit{"cm/s", Dimension::Velocity, 0.01},
    Unit{"mm/s", Dimension::Velocity, 0.001},
    Unit{"m/s^2", Dimension::Acceleration, 1},
    Unit{"mm/s^2", Dimension::Acceleration, 0.001},
    Unit{"kg", Dimension::Mass, 1},
    Unit{"g", Dimension::Mass, 0.001},
    Unit{"kg m^2", Dimension::Inertia, 1},
    Unit{"s", Dimension::Time, 1},
    Unit{"ms", Dimension::Time, 0.001},
    Unit{"min", Dimension::Time, 60},
    Unit{"h", Dimension::Time, 3600},
    Unit{"1/s", Dimension::Rate, 1},
    Unit{"N", Dimension::Force, 1},
    Unit{"N m", Dimension::Moment, 1},
    Unit{"N s", Dimension::Impulse, 1},
    Unit{"kg m/s", Dimension::Impulse, 1},
    Unit{"N m s", Dimension::AngularImpulse, 1},
    Unit{"kg m^2/s", Dimension::AngularImpulse, 1},
    Unit{"N m/rad", Dimension::Stiffness, 1},
    Unit{"N/m", Dimension::LinearStiffness, 1},
    Unit{"N m s/rad", Dimension::Damping, 1},
    Unit{"N s/m", Dimension::LinearDamping, 1},
};

bool fits(Dimension of_unit, Dimension wanted) {
  if (wanted == Dimension::JointPosition) {
    return of_unit == Dimension::Angle || of_unit == Dimension::Length;
  }
  return of_unit == wanted;
}

}  // namespace

std::optional<double> unit_factor(std::string_view unit, Dimension dimension) {
  for (const Unit& candidate : kUnits) {
    if (candidate.name == unit && fits(candidate.dimension, dimension)) return candidate.factor;
  }
  return std::nullopt;
}

Dimension dimension_of_unit(std::string_view unit) {
  for (const Unit& candidate : kUnits) {
    if (candidate.name == unit) return candidate.dimension;
  }
  return Dimension::None;
}

bool is_unit(std::string_view unit) {
  for (const Unit& candidate : kUnits) {
    if (candidate.name == unit) return true;
  }
  return false;
}

std::string name_of(Dimension dimension) {
  // In the order of the enumeration.
  static const char* const kNames[] = {"none",
                                       "angle",
                                       "angular_velocity",
                                       "angular_acceleration",
                                       "length",
                                       "velocity",
                                       "acceleration",
                                       "joint_position",
                                       "mass",
                                       "inertia",
                                       "time",
                                       "rate",
                                       "force",
                                       "moment",
                                       "impulse",
                                       "angular_impulse",
                                       "stiffness",
                                       "damping",
                                       "linear_stiffness",
                                       "linear_damping"};
  return kNames[static_cast<std::size_t>(dimension)];
}

std::string units_of(Dimension dimension) {
  std::string list;
  for (const Unit& candidate : kUnits) {
    if (!fits(candidate.dimension, dimension)) continue;
    if (!list.empty()) list += ", ";
    list += candidate.name;
  }
  return list;
}

}  // namespace stillbase::io
