// Work on several threads whose results do not depend on their number.
//
// What is done for an index may depend on what was taken of lower indices, in a way that does not
// change what is taken in the end, and on nothing else that changes. Results are taken in the order
// of the indices. Then every number of threads gives the same bytes.
#pragma once

#include <functional>
#include <memory>

#include <stillbase/core/interrupt.hpp>

namespace stillbase {

/// Processors of this machine, at least 1.
int processor_count();

/// A number of threads as options state it, where 0 asks for one per processor.
inline int jobs_or_processors(int jobs) { return jobs > 0 ? jobs : processor_count(); }

/// Keeps the threads of for_each_index() from one call to the next: a search makes hundreds of
/// calls, and a thread takes longer to begin than some of them.
///
/// While it exists, calls on the thread that made it, and on its threads, are helped by at most
/// `jobs - 1` threads in all, which begin when first wanted and round as the caller does. Inside
/// another crew, and for one job, it does nothing. A process that is forked has none of them.
class ThreadCrew {
 public:
  explicit ThreadCrew(int jobs);
  ThreadCrew(const ThreadCrew&) = delete;
  ThreadCrew& operator=(const ThreadCrew&) = delete;
  /// Ends the threads. On the thread that made it.
  ~ThreadCrew();

 private:
  friend int for_each_index(int jobs, int count, const StopCondition& stop,
                            const std::function<void(int)>& work,
                            const std::function<void(int)>& take);
  class Threads;
  std::unique_ptr<Threads> threads_;  ///< null inside another crew, and for one job
};

/// Calls work(i) once for every i of 0 .. count - 1 on at most `jobs` threads, of which the
/// caller's is one, and take(i) as soon as all up to i were worked on: in order, one at a time, on
/// any of the threads. These are those of a ThreadCrew, or begin and end with the call. With one
/// job everything happens on the caller's thread: work(0), take(0), work(1), ...
/// @param stop reached: no further index is begun; those that were begun are taken as well
/// @return how many were taken; less than `count` when stopped
/// @throws what work() or take() throws; of several the one with the lowest index, when no thread
/// works on it any more
int for_each_index(int jobs, int count, const StopCondition& stop,
                   const std::function<void(int)>& work, const std::function<void(int)>& take = {});

}  // namespace stillbase
