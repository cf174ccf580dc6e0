// SIGINT and SIGTERM stop the work at the next good place; what was finished is saved. A second
// signal ends the program at once.
#pragma once

#include <stillbase/core/interrupt.hpp>

namespace stillbase::app {

/// From now on the signals are caught.
void catch_signals();

/// The stop condition that they set.
/// @param time_limit s from now; not positive: none
StopCondition stop_condition(double time_limit = 0);

/// 130 or 143 after a signal, else 0.
int signal_exit_code();

}  // namespace stillbase::app
