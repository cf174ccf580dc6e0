#include <stillbase/plan/plan.hpp>

namespace stillbase {

std::string to_string(PlanStatus status) {
  switch (status) {
    case PlanStatus::Optimal:
      return "optimal";
    case PlanStatus::Feasible:
      return "feasible";
    case PlanStatus::Infeasible:
      return "infeasible";
    case PlanStatus::Limit:
      return "limit";
  }
  return "";
}

std::string to_string(ProofStatus status) {
  switch (status) {
    case ProofStatus::NotApplicable:
      return "not_applicable";
    case ProofStatus::Complete:
      return "complete";
    case ProofStatus::Undecided:
      return "undecided";
  }
  return "";
}

std::string to_string(ApproachStatus status) {
  switch (status) {
    case ApproachStatus::Found:
      return "found";
    case ApproachStatus::NotRequested:
      return "not_requested";
    case ApproachStatus::StartInvalid:
      return "start_invalid";
    case ApproachStatus::GoalInvalid:
      return "goal_invalid";
    case ApproachStatus::GoalUnreachable:
      return "goal_unreachable";
    case ApproachStatus::UnreachableInBaseMode:
      return "unreachable_in_base_mode";
    case ApproachStatus::HitEarly:
      return "hit_early";
    case ApproachStatus::TimeOut:
      return "time_out";
    case ApproachStatus::Interrupted:
      return "interrupted";
    case ApproachStatus::TooSlow:
      return "too_slow";
    case ApproachStatus::BaseDriftOpen:
      return "base_drift_open";
  }
  return "";
}

}  // namespace stillbase
