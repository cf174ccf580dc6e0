// Numbers, vectors and names as a first problem writes them.
#pragma once

#include <string>

#include <Eigen/Geometry>

#include <stillbase/core/types.hpp>

namespace stillbase::app {

inline constexpr double kDensity = 200;  ///< kg/m^3, of satellites

/// To the nearest multiple of `step`, at least that.
double rounded_to(double x, double step);

/// To two digits.
double rounded_mass(double x);

std::string vector_text(const Vector3d& v);

std::string quaternion_text(const Eigen::Quaterniond& q);

/// A name or path in YAML: in quotes where it would not be read as a text without.
std::string yaml_word(const std::string& text);

}  // namespace stillbase::app
