// Pieces of work in processes of their own, so that a crash, a hang or a runaway allocation of one
// is an outcome and not the end.
//
// Assumptions: POSIX. Where the caller has other threads, the work takes no lock that one of them
// may hold: in the child it is held for ever. The allocator's are free there (glibc, musl, macOS).
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/interrupt.hpp>

namespace stillbase {

enum class ChildEnd {
  Finished,     ///< the work returned
  Crashed,      ///< it threw
  TimedOut,     ///< killed at a time limit
  OutOfMemory,  ///< an allocation beyond the memory limit
  Died,         ///< its process was killed by a signal, or left: says nothing of the work
};
std::string to_string(ChildEnd end);

struct ChildOutcome {
  ChildEnd end = ChildEnd::Crashed;
  std::string bytes;    ///< what the work returned; empty unless Finished
  std::string message;  ///< text of an exception, name of a signal, ...
  double seconds = 0;   ///< wall clock without pauses
};

struct ChildOptions {
  int jobs = 1;         ///< processes at a time
  double seconds = 60;  ///< wall clock of each, without pauses
  /// Processor time of each: a limit that comes no nearer on a busy machine.
  double processor_seconds = kInfinity;
  /// Bytes of address space that each may take beyond those of this process, which it shares (of
  /// this process only under Linux); no limit under sanitizers.
  std::uint64_t memory = 2ull << 30;
  StopCondition stop;  ///< when reached, running children are killed and none begins
  /// Called in this process before the child of a piece of work begins; may be empty. After it
  /// throws no further child begins.
  std::function<void(int)> before;
};

/// Runs work(0) .. work(count - 1), each in a child of this process, and calls done(i, outcome) in
/// this process as they end, in any order. Children that were killed by `stop` are not reported.
/// SIGINT and SIGTERM are left to this process: a signal to the whole group does not end children.
/// Time in which this process stood still for more than a second, as between SIGSTOP and SIGCONT,
/// is a pause: it counts for no child. Children end with this process, at once under Linux,
/// elsewhere at their time limit. What the work writes to memory is lost with its process; what it
/// returns is not.
/// @return number of pieces reported; count unless stopped
/// @throws FileError when the system gives no process or pipe; what `done` throws, after the
/// running children have been killed; what `options.before` throws, after they have been reported
int run_in_children(int count, const ChildOptions& options,
                    const std::function<std::string(int)>& work,
                    const std::function<void(int, const ChildOutcome&)>& done);

}  // namespace stillbase
