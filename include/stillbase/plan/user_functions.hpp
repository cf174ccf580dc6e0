// Objective terms and constraints from outside the library.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include <Eigen/Core>

namespace stillbase {

struct Configuration;
struct ImpactSummary;

/// A function of the user: of a configuration and the nominal impact there (of a scenario, the
/// scenario's). It must be twice differentiable, and safe to call from several threads when several
/// search. Without a gradient of its own, central differences of step 1e-5 give it to about 1e-9 of
/// its size: the function is called several times for every evaluation then.
using UserFunction = std::function<double(const Configuration&, const ImpactSummary&)>;

/// Total derivative of a UserFunction over the variables of the search (N, in the order of
/// Formulation): how the impact changes with them is part of it.
using UserGradient = std::function<Eigen::VectorXd(const Configuration&, const ImpactSummary&)>;

/// A term of the objective: |y| is joined by value / size.
struct UserTerm {
  std::string name;
  std::string unit;
  double size = 1;  ///< value that counts as one, in `unit`, > 0
  UserFunction value;
  UserGradient gradient = {};  ///< empty: central differences
};

/// A constraint: lower <= value <= upper, of order one.
struct UserConstraint {
  std::string name;
  std::string unit;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  UserFunction value;
  UserGradient gradient = {};  ///< empty: central differences
};

/// What a user adds to a problem. Files hold the names and values of these functions, not the
/// functions: `verify` says that it does not recompute them.
struct UserFunctions {
  std::vector<UserTerm> terms;
  std::vector<UserConstraint> constraints;

  bool empty() const { return terms.empty() && constraints.empty(); }
};

}  // namespace stillbase
