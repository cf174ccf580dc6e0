// What the shell learns. The numbers are a promise to scripts.
#pragma once

#include <stdexcept>

namespace stillbase::app {

enum ExitCode : int {
  kDone = 0,
  kInternalError = 1,
  kCommandLine = 2,
  kInputRefused = 3,
  kInfeasible = 4,
  kVerificationFailed = 5,
  kLimit = 6,
  kFileFailed = 7,
  kCampaignIncomplete = 8,
  kNoApproach = 9,
  kSignalBase = 128  ///< + number of the signal
};

/// A command line that no parser can know to be wrong: exit code 2.
class CommandLineError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace stillbase::app
