// Work on several threads whose results do not depend on their number.
//
// What is done for an index may depend on what was taken of lower indices, in a way that does not
// change what is taken in the end, and on nothing else that changes. Results are taken in the order
// of the indices. Then every number of threads gives the same bytes.
#pragma once

#include <functional>

#include <stillbase/core/interrupt.hpp>

namespace stillbase {

/// Processors of this machine, at least 1.
int processor_count();

/// A number of threads as options state it, where 0 asks for one per processor.
inline int jobs_or_processors(int jobs) { return jobs > 0 ? jobs : processor_count(); }

/// Calls work(i) once for every i of 0 .. count - 1 on at most `jobs` threads, of which the
/// caller's is one, and take(i) as soon as all up to i were worked on: in order, one at a time, on
/// any of the threads. With one job everything happens on the caller's thread: work(0), take(0),
/// work(1), ...
/// @param stop reached: no further index is begun; those that were begun are taken as well
/// @return how many were taken; less than `count` when stopped
/// @throws what work() or take() throws; of several the one with the lowest index, when all threads
/// have ended
int for_each_index(int jobs, int count, const StopCondition& stop,
                   const std::function<void(int)>& work, const std::function<void(int)>& take = {});

}  // namespace stillbase
