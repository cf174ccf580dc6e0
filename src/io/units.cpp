#include "io/units.hpp"

#include <array>

#include <stillbase/core/constants.hpp>

namespace stillbase::io {

namespace {

struct Unit {
  std::string_view name = {};
  double factor = 0;  ///< to SI
};

struct Row {
  const char* name;
  std::array<Unit, 5> units;  ///< the SI unit first; those without a name are none
};

constexpr double kDegree = kPi / 180;

// In the order of the enumeration.
constexpr Row kDimensions[] = {
    {"none", {}},
    {"angle", {Unit{"rad", 1}, {"deg", kDegree}}},
    {"angular_velocity", {Unit{"rad/s", 1}, {"deg/s", kDegree}}},
    {"angular_acceleration", {Unit{"rad/s^2", 1}, {"deg/s^2", kDegree}}},
    {"length", {Unit{"m", 1}, {"cm", 0.01}, {"mm", 0.001}}},
    {"velocity", {Unit{"m/s", 1}, {"cm/s", 0.01}, {"mm/s", 0.001}}},
    {"acceleration", {Unit{"m/s^2", 1}, {"mm/s^2", 0.001}}},
    {"joint_position", {Unit{"rad", 1}, {"deg", kDegree}, {"m", 1}, {"cm", 0.01}, {"mm", 0.001}}},
    {"mass", {Unit{"kg", 1}, {"g", 0.001}}},
    {"inertia", {Unit{"kg m^2", 1}}},
    {"time", {Unit{"s", 1}, {"ms", 0.001}, {"min", 60}, {"h", 3600}}},
    {"rate", {Unit{"1/s", 1}}},
    {"force", {Unit{"N", 1}}},
    {"moment", {Unit{"N m", 1}}},
    {"impulse", {Unit{"N s", 1}, {"kg m/s", 1}}},
    {"angular_impulse", {Unit{"N m s", 1}, {"kg m^2/s", 1}}},
    {"energy", {Unit{"J", 1}}},
    {"stiffness", {Unit{"N m/rad", 1}}},
    {"damping", {Unit{"N m s/rad", 1}}},
    {"linear_stiffness", {Unit{"N/m", 1}}},
    {"linear_damping", {Unit{"N s/m", 1}}}};

const Row& row_of(Dimension dimension) { return kDimensions[static_cast<std::size_t>(dimension)]; }

}  // namespace

std::optional<double> unit_factor(std::string_view unit, Dimension dimension) {
  for (const Unit& candidate : row_of(dimension).units) {
    if (!unit.empty() && candidate.name == unit) return candidate.factor;
  }
  return std::nullopt;
}

Dimension dimension_of_unit(std::string_view unit) {
  for (std::size_t i = 0; i < std::size(kDimensions); ++i) {
    if (unit_factor(unit, static_cast<Dimension>(i))) return static_cast<Dimension>(i);
  }
  return Dimension::None;
}

bool is_unit(std::string_view unit) { return dimension_of_unit(unit) != Dimension::None; }

std::string name_of(Dimension dimension) { return row_of(dimension).name; }

std::string units_of(Dimension dimension) {
  std::string list;
  for (const Unit& unit : row_of(dimension).units) {
    if (!list.empty() && !unit.name.empty()) list += ", ";
    list += unit.name;
  }
  return list;
}

}  // namespace stillbase::io
