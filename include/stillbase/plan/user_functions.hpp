// Objective terms and constraints from outside the library.
#pragma once

#include <functional>
#include <limits>
#include <string>
#include <vector>

namespace stillbase {

struct Configuration;
struct ImpactSummary;

/// A function of the user: of a configuration and the nominal impact there (of a scenario, the
/// scenario's). Central differences of step 1e-5 give its gradient, to about 1e-9 of its size, so
/// it is called several times for every evaluation. It must be twice differentiable, and safe to
/// call from several threads when several search.
using UserFunction = std::function<double(const Configuration&, const ImpactSummary&)>;

/// A term of the objective: |y| is joined by value / size.
struct UserTerm {
  std::string name;
  std::string unit;
  double size = 1;  ///< value that counts as one, in `unit`, > 0
  UserFunction value;
};

/// A constraint: lower <= value <= upper, of order one.
struct UserConstraint {
  std::string name;
  std::string unit;
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  UserFunction value;
};

/// What a user adds to a problem. Files hold the names and values of these functions, not the
/// functions: `verify` says that it does not recompute them.
struct UserFunctions {
  std::vector<UserTerm> terms;
  std::vector<UserConstraint> constraints;

  bool empty() const { return terms.empty() && constraints.empty(); }
};

}  // namespace stillbase
