// How good is the instantaneous impact? The table of `simulate --contact-table`.
#pragma once

#include <string>

#include <stillbase/simulation/after_contact.hpp>

namespace stillbase::app {

/// The contact of a case by a spring-damper that gets stiffer row by row, beside the instantaneous
/// impact with the case's joint resistance and with free joints.
/// @param friction Coulomb coefficient of the spring-damper contact; the impact has none
/// @param stop rows that it cuts off are said to be not over
/// @throws CommandLineError for a case without target or closing speed, or with locked joints
std::string contact_table(const ContactCase& subject, double friction, bool as_json,
                          const StopCondition& stop);

}  // namespace stillbase::app
