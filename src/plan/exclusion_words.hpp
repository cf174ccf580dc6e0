// Words of Candidate::excluded, which the planner writes and the audit recognises.
#pragma once

#include <string>

#include <stillbase/plan/plan.hpp>

namespace stillbase::exclusion {

// What the candidate alone shows: what touches, or the limit that is exceeded, follows.
inline constexpr const char* kAtContact = "at the contact: ";
inline constexpr const char* kAfterImpact = "after the impact: ";
inline constexpr const char* kNotJudged = "not judged";  ///< in place of either, after a stop

// What the search for a path shows.
inline constexpr const char* kNoPath = "no approach path: ";  // a status follows
inline constexpr const char* kNoPathOfFeature =
    "no approach path to the candidates of its feature: ";  // a status follows
inline constexpr const char* kLimitOfFeature =
    "the candidates of its feature exceed a limit after the impact";
inline constexpr const char* kAtPathEnd = "where its path ends: ";  // what touches follows
inline constexpr const char* kAfterPathEnd =
    "after the impact, where its path ends: ";  // a limit follows
inline constexpr const char* kNoBetterAtPathEnd = "no better where its path ends";
inline constexpr const char* kOtherPathFirst = "a path to another one was found first";
inline constexpr const char* kNotTried = "not tried";
inline constexpr const char* kFirstPathWanted = "not tried: approach.effort is first";

// Limits after the impact, of post_impact_failure().
inline constexpr const char* kAttitude = "attitude change of the base";
inline constexpr const char* kBaseRate = "base rate";
inline constexpr const char* kGripLoad = "load of the grip";
// After the name of a joint.
inline constexpr const char* kStop = " reaches its stop";
inline constexpr const char* kRateLimit = " exceeds its rate limit";
inline constexpr const char* kTorqueLimit = " exceeds its torque limit";
/// Begins what is said of a contact that goes on.
inline constexpr const char* kStillTouching = "hand and target still touch after the horizon";
/// @param horizon s
std::string not_at_rest(double horizon);
/// Ends what is said of a demand on grip or wheels: " of 10 N m s", or that there is no wheel.
std::string of_most(const LimitUse& use);

}  // namespace stillbase::exclusion
