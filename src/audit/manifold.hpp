// The configurations near a plan's own that keep its equations, and what depends on them, by
// `reference`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "audit/checks.hpp"
#include "audit/equations.hpp"

namespace stillbase::audit {

/// Configurations x(u) = x + Z u + (a correction normal to Z) that satisfy the equations on hand
/// and case. Z: orthonormal directions, in rad, m and s, that keep the equations to first order.
class FeasibleManifold {
 public:
  /// @param problem must outlive this object
  FeasibleManifold(const CaptureProblem& problem, const Configuration& at);

  /// Why Z is not known; empty: it is.
  const std::string& objection() const { return objection_; }
  Eigen::Index dimension() const { return Z_.cols(); }
  Eigen::Index variables() const { return Z_.rows(); }
  const Eigen::MatrixXd& directions() const { return Z_; }
  int rotation_vector() const { return variables_.rotation_vector(); }
  /// x(u); empty: the correction does not converge. A base whose position is free stands where the
  /// hand is at its point.
  std::optional<Configuration> at(const Eigen::VectorXd& u) const;
  /// x + w without correction, w over all variables in rad, m and s.
  Configuration beside(const Eigen::VectorXd& w) const;

 private:
  Configuration with_station(Configuration at) const;

  const CaptureProblem& problem_;
  FreeVariables variables_;
  Equations equations_;
  Eigen::VectorXd x_, units_;
  Eigen::MatrixXd Z_, correction_;
  std::string objection_;
};

/// A limit as plans state it.
struct NamedLimit {
  std::string name;       ///< "joint_2", "contact_time", or of a constraint
  std::string unit;       ///< of the limit
  double value = 0;       ///< of the limit, in `unit`
  bool is_upper = false;  ///< the upper end of its range
};

/// Distances from the limits of variables and inequalities, each in its own unit; negative beyond
/// one. The same list at every configuration of a problem, in which the side that the hand's axis
/// points to is missing: it cannot change where the equations hold.
/// @param limits unless null: each limit, of the same length. Several distances of two bodies are
/// one limit, and have one name
std::vector<double> distances_from_limits(const verification::Situation& situation,
                                          std::vector<NamedLimit>* limits = nullptr);

/// Median of |y| over 15 evenly spread configurations, by which the stated curvature is divided.
double typical_objective(const CaptureProblem& problem);

}  // namespace stillbase::audit
