// A constraint from outside the library.
#pragma once

#include <stillbase/formulation/formulation.hpp>

#include "formulation/constraints/constraint.hpp"

namespace stillbase {

std::unique_ptr<Constraint> user_constraint(UserConstraint constraint);

}  // namespace stillbase
