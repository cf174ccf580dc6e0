// What a problem may limit at the contact, for those who speak of it without judging it.
#pragma once

#include <string>
#include <vector>

#include <stillbase/plan/problem.hpp>

namespace stillbase {

/// One kind of constraint of the nonlinear program.
struct ContactLimitRow {
  const char* name;  ///< of the constraint; where there are several, what their names begin with
  bool has_several;  ///< one for each joint, pair of bodies or component
  bool (*is_stated)(const CaptureProblem&);
  const char* uncounted;  ///< how a proof that leaves it out calls it; null: proofs count it
  const char* loosening;  ///< what a user may change where it is violated
};

/// All of them but for equations of the hand, one row each.
const std::vector<ContactLimitRow>& contact_limits();

/// The row of a constraint that the problem states; null: it is none of these.
const ContactLimitRow* limit_of(const CaptureProblem& problem, const std::string& constraint);

/// Limits that a proof leaves out, of the posture at the contact: "joint rates", ...
std::vector<std::string> uncounted_limits(const CaptureProblem& problem);

}  // namespace stillbase
