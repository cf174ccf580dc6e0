// Replanning by the C interface.
#include <algorithm>
#include <chrono>

#include <stillbase/target/estimate.hpp>

#include "c/c_interface.hpp"

using namespace stillbase;
using stillbase::c::guarded;
using stillbase::c::needed;

namespace {

const char* status_text(ReplanStatus status) {
  switch (status) {
    case ReplanStatus::Optimal:
      return "optimal";
    case ReplanStatus::Feasible:
      return "feasible";
    case ReplanStatus::Infeasible:
      return "infeasible";
    case ReplanStatus::Refused:
      break;
  }
  return "refused";
}

/// What is not finite is for the replanner to refuse.
StateEstimate estimate_of(const stillbase_estimate& stated) {
  StateEstimate out;
  out.state.time = stated.time;
  out.state.pose.position = Eigen::Map<const Vector3d>(stated.position);
  const double* const q = stated.orientation;
  out.state.pose.orientation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]);
  out.state.linear_velocity = Eigen::Map<const Vector3d>(stated.linear_velocity);
  out.state.angular_velocity = Eigen::Map<const Vector3d>(stated.angular_velocity);
  if (stated.covariance != nullptr) {
    out.covariance = Eigen::Map<const StateCovariance>(stated.covariance);  // symmetric
  }
  return out;
}

void write_update(const ReplanResult& result, stillbase_update& out) {
  out.status = status_text(result.status);
  out.reason = result.reason;
  out.was_cut = result.was_cut ? 1 : 0;
  out.value = result.value;
  out.nominal = result.nominal;
  out.worst_case = result.worst_case;
  out.max_violation = result.max_violation;
  out.least_margin = kInfinity;
  for (const ConstraintValue& constraint : result.constraints) {
    if (constraint.lower == constraint.upper) continue;
    out.least_margin = std::min(out.least_margin, margin_of(constraint));
  }
  out.kkt_residual = result.kkt_residual;
  out.old_value = result.old.value;
  out.old_max_violation = result.old.max_violation;
  out.seconds = result.seconds;
}

}  // namespace

stillbase_status stillbase_replanner_make(const stillbase_plan* plan, double stay_within,
                                          stillbase_replanner** replanner) {
  return guarded([&] {
    const Plan& data = needed(plan, "plan").data;
    needed(replanner, "replanner");
    if (!(stay_within > 0)) throw c::ArgumentError("stay_within: must be > 0 rad");
    ReplanOptions options;
    options.stay_within = stay_within;
    *replanner = new stillbase_replanner{Replanner(data, options), data.problem.robot.n()};
  });
}

void stillbase_replanner_free(stillbase_replanner* replanner) { delete replanner; }

int stillbase_replanner_joints(const stillbase_replanner* replanner) {
  return replanner == nullptr ? 0 : replanner->joints;
}

stillbase_status stillbase_replanner_update(stillbase_replanner* replanner,
                                            const stillbase_estimate* estimate, double deadline,
                                            stillbase_contact* contact, double* phi,
                                            stillbase_update* update) {
  return guarded([&] {
    Replanner& data = needed(replanner, "replanner").data;
    const StateEstimate stated = estimate_of(needed(estimate, "estimate"));
    needed(phi, "phi");
    if (!(deadline >= 0)) throw c::ArgumentError("deadline: must be >= 0 s");
    StopCondition stop;
    stop.set_deadline_after(deadline);
    const ReplanResult& result = data.replan(stated, stop);
    c::write_configuration(result.configuration, contact, phi);
    if (update != nullptr) write_update(result, *update);
  });
}
