// Runs side by side: what simulate_post_impact() does, for several robots at once.
#include <algorithm>
#include <iterator>
#include <memory>
#include <optional>
#include <vector>

#include "simulation/closed_loop.hpp"
#include "simulation/controller_kernel.hpp"
#include "simulation/integrators.hpp"
#include "simulation/lane_kernels.hpp"
#include "simulation/ticks.hpp"

namespace stillbase {
namespace {

/// The widest kernel that this processor runs.
const LaneKernel& widest_kernel() {
  static const LaneKernel& widest = []() -> const LaneKernel& {
    for (const LaneKernel* kernel : {lane_kernel_avx512(), lane_kernel_avx2()}) {
      if (kernel != nullptr && kernel->runs_here()) return *kernel;
    }
    return *lane_kernel_two_lanes();
  }();
  return widest;
}

/// Whether one model can stand for the joints of both.
bool same_joints(const RobotModel& a, const RobotModel& b) {
  const auto same = [](const Joint& x, const Joint& y) {
    return x.type == y.type && x.parent == y.parent && x.R.matrix() == y.R.matrix() && x.p == y.p &&
           x.lower == y.lower && x.upper == y.upper && x.max_velocity == y.max_velocity &&
           x.max_effort == y.max_effort && x.viscous_friction == y.viscous_friction &&
           x.coulomb_friction == y.coulomb_friction && x.rotor_inertia == y.rotor_inertia &&
           x.gear_ratio == y.gear_ratio;
  };
  const auto same_coupling = [](const Coupling& x, const Coupling& y) {
    return x.joint == y.joint && x.ratio == y.ratio && x.offset == y.offset;
  };
  return std::equal(a.joints.begin(), a.joints.end(), b.joints.begin(), b.joints.end(), same) &&
         std::equal(a.coupled_tree.begin(), a.coupled_tree.end(), b.coupled_tree.begin(),
                    b.coupled_tree.end(), same) &&
         std::equal(a.couplings.begin(), a.couplings.end(), b.couplings.begin(), b.couplings.end(),
                    same_coupling) &&
         a.bodies.size() == b.bodies.size() && a.hand_body == b.hand_body &&
         a.moves_hand == b.moves_hand;
}

const RobotModel* known_robot(const PostImpactRun& run) {
  if (run.options.controller_robot) return &*run.options.controller_robot;
  return run.options.sensors.are_exact() ? nullptr : &run.robot;
}

/// Whether all that changes the equations within a run is a joint that reaches its stop.
bool fits_a_lane(const LaneKernel& kernel, const PostImpactRun& run, const Controller& controller) {
  const SimulationOptions& options = run.options;
  const bool is_steady =
      controller.kind != ControllerKind::RnsHandback && controller.kind != ControllerKind::Detumble;
  const bool has_fixed_steps =
      options.integrator == IntegratorKind::Rk4 || options.integrator == IntegratorKind::Midpoint;
  const bool is_sampled = options.control_period > 0 &&
                          (options.output_period <= 0 || options.output_period >= options.horizon);
  const bool is_free = !options.friction && !options.thrusters.exist() && !options.base_wrench;
  const auto is_small = [&](const RobotModel& robot) {
    return robot.n() <= kernel.max_joints && robot.num_bodies() <= kernel.max_joints;
  };
  const RobotModel* const known = known_robot(run);
  return is_steady && has_fixed_steps && is_sampled && is_free && options.joint_stops &&
         !options.ends_at_stop && run.robot.n() > 0 && is_small(run.robot) &&
         (known == nullptr || is_small(*known));
}

bool same_stop(const StopCondition& a, const StopCondition& b) {
  return a.interrupted == b.interrupted && a.deadline == b.deadline;
}

/// Whether runs that fit lanes can be neighbours.
bool are_alike(const PostImpactRun& a, const PostImpactRun& b) {
  const SimulationOptions &x = a.options, &y = b.options;
  const SensorSpec &s = x.sensors, &t = y.sensors;
  const RobotModel *known_a = known_robot(a), *known_b = known_robot(b);
  return x.integrator == y.integrator && x.step == y.step && x.control_period == y.control_period &&
         x.start_time == y.start_time && x.horizon == y.horizon &&
         x.torque_limits == y.torque_limits && x.rate_limits == y.rate_limits &&
         x.max_steps == y.max_steps && same_stop(x.stop, y.stop) &&
         s.base_rate_error == t.base_rate_error && s.joint_rate_error == t.joint_rate_error &&
         s.are_exact() == t.are_exact() &&
         x.grasp.target.has_value() == y.grasp.target.has_value() &&
         same_joints(a.robot, b.robot) &&
         added_plant_inertia(a.resistance, a.robot.n()) ==
             added_plant_inertia(b.resistance, b.robot.n()) &&
         (known_a == nullptr) == (known_b == nullptr) &&
         (known_a == nullptr || same_joints(*known_a, *known_b));
}

/// Numbers of all lanes, see lane_kernels.hpp.
class LaneColumns {
 public:
  LaneColumns(int numbers, int lanes)
      : lanes_(lanes),
        numbers_(static_cast<std::size_t>(numbers) * static_cast<std::size_t>(lanes)) {}
  double& at(int number, int lane) { return numbers_[place(number, lane)]; }
  template <class Derived>
  int put(int first, int lane, const Eigen::MatrixBase<Derived>& values) {
    for (Eigen::Index j = 0; j < values.cols(); ++j) {
      for (Eigen::Index i = 0; i < values.rows(); ++i) at(first++, lane) = values(i, j);
    }
    return first;
  }
  template <class Derived>
  int take(int first, int lane, Eigen::MatrixBase<Derived>& values) const {
    for (Eigen::Index j = 0; j < values.cols(); ++j) {
      for (Eigen::Index i = 0; i < values.rows(); ++i) {
        values(i, j) = numbers_[place(first++, lane)];
      }
    }
    return first;
  }
  double* data() { return numbers_.data(); }

 private:
  std::size_t place(int number, int lane) const {
    return static_cast<std::size_t>(number) * static_cast<std::size_t>(lanes_) +
           static_cast<std::size_t>(lane);
  }

  int lanes_;
  std::vector<double> numbers_;
};

/// Masses and hands of one robot per lane.
struct RobotColumns {
  LaneColumns bodies, hand;

  RobotColumns(const RobotModel& robot, int lanes)
      : bodies(kBodyNumbers * (1 + robot.num_bodies()), lanes), hand(kHandNumbers, lanes) {}
  void put(int lane, const RobotModel& robot) {
    int next = put(0, lane, robot.base);
    for (const Body& body : robot.bodies) next = put(next, lane, body);
    hand.put(hand.put(0, lane, robot.p_hand), lane, robot.R_hand);
  }
  LaneRobots view(const RobotModel& pattern) { return {&pattern, bodies.data(), hand.data()}; }

 private:
  int put(int first, int lane, const Body& body) {
    bodies.at(first, lane) = body.mass;
    return bodies.put(bodies.put(first + 1, lane, body.centroid), lane, body.inertia);
  }
};

void put_state(const PlantState& state, int lane, LaneColumns& columns) {
  columns.put(0, lane, pack(state).head(13 + 2 * state.phi.size()));
}

/// What of a state moves.
/// @return false: the numbers are not those of a motion
bool take_state(const LaneColumns& columns, int lane, PlantState& state) {
  int next = columns.take(0, lane, state.base.position);
  next = columns.take(next, lane, state.base.orientation.coeffs());
  next = columns.take(next, lane, state.phi);
  next = columns.take(next, lane, state.Omega);
  columns.take(next, lane, state.phidot);
  return is_bounded(pack(state));
}

PlantState with_unit_attitude(PlantState state) {
  state.base.orientation.normalize();
  return state;
}

/// One run in its lane.
struct Lane {
  const PostImpactRun& run;
  PlantState first;
  PlantState state;  ///< at the beginning of the step
  Course course;
  Sensing sensing;
  ControlCommand command;
  JointVectord demanded;
  bool saturated = false;
  bool is_moving = true;
  /// s; where the run goes on as a single one, because the next step meets what a lane cannot do.
  std::optional<double> leaves_at;
  SimulationResult result;

  Lane(const PostImpactRun& its_run, const Controller& controller)
      : run(its_run),
        first(with_unit_attitude(run.initial)),
        state(first),
        course(run.robot, controller, run.options),
        sensing(run.options.sensors, run.options.control_period),
        command{JointVectord::Zero(run.robot.n())},
        demanded(JointVectord::Zero(run.robot.n())) {
    course.output.fires_at(run.options.start_time);  // the first state goes into the trace anyway
  }

  void go_on_alone(const Controller& controller, const JointVectord& rotor_inertia) {
    ClosedLoop loop(run.robot, rotor_inertia, controller, run.options);
    loop.go_on_from(sensing, command, demanded, saturated);
    StateVector x = pack(state);
    double t = *leaves_at;
    result = run_on(loop, x, t, course, run.options);
  }
};

class LaneGroup {
 public:
  /// @param runs as many as the kernel has lanes at most
  LaneGroup(const LaneKernel& kernel, const std::vector<const PostImpactRun*>& runs,
            const Controller& controller)
      : kernel_(kernel),
        controller_(controller),
        options_(runs.front()->options),
        n_(runs.front()->robot.n()),
        plant_(runs.front()->robot, kernel.lanes),
        held_(kHeldNumbers, kernel.lanes),
        wheels_(3, kernel.lanes),
        states_(13 + 2 * n_, kernel.lanes),
        measured_(13 + 2 * n_, kernel.lanes),
        tau_(n_, kernel.lanes),
        demanded_(n_, kernel.lanes),
        observed_(At::count, kernel.lanes),
        rotor_inertia_(added_plant_inertia(runs.front()->resistance, n_)),
        nothing_added_(JointVectord::Zero(n_)) {
    for (const PostImpactRun* run : runs)
      lanes_.push_back(std::make_unique<Lane>(*run, controller));
    const RobotModel* const known = known_robot(*runs.front());
    if (known != nullptr) known_.emplace(*known, kernel.lanes);
    for (int l = 0; l < kernel.lanes; ++l) {
      const PostImpactRun& run = lane_or_first(l).run;
      plant_.put(l, run.robot);
      if (known_) known_->put(l, *known_robot(run));
      if (run.options.grasp.target) put_held(l, *run.options.grasp.target);
      if (run.options.wheels.exist()) wheels_.put(0, l, run.initial.wheel_momentum);
      put_state(lane_or_first(l).state, l, states_);
    }
    step_.plant = plant_.view(runs.front()->robot);
    if (known_) step_.known = known_->view(*known);
    step_.controller = &controller_;
    if (!options_.sensors.are_exact()) step_.sensors = &options_.sensors;
    step_.rotor_inertia = &rotor_inertia_;
    step_.nothing_added = &nothing_added_;
    step_.none_locked = &none_locked_;
    step_.torque_limits = options_.torque_limits;
    step_.rate_limits = options_.rate_limits;
    step_.wheel_momentum = wheels_.data();
    if (options_.grasp.target) step_.held = held_.data();
    step_.is_midpoint = options_.integrator == IntegratorKind::Midpoint;
    step_.state = states_.data();
    step_.tau = tau_.data();
    step_.demanded = demanded_.data();
    step_.observed = observed_.data();
  }

  std::vector<SimulationResult> run() {
    double t = options_.start_time;
    const double end = t + options_.horizon;
    Ticks control(t, options_.control_period);
    SimulationStatus status = SimulationStatus::Finished;
    take_states(t, control);
    while (t < end && status == SimulationStatus::Finished) {
      end_early(t);
      if (!is_any_moving()) break;
      bool commands = control.fires_at(t);
      if (commands) measure();
      const double next = end_of_stretch(t, control.next(), end);
      while (t < next) {
        status = check_stop(options_, steps_);
        if (status != SimulationStatus::Finished) break;
        const double count = number_of_steps(t, next, options_.step);
        const double h = (next - t) / count;
        advance(t, h, commands);
        take_states(t, control);
        ++steps_;
        commands = false;
        t = count > 1 ? t + h : next;
      }
    }
    if (is_any_moving()) end_all(t, status);
    std::vector<SimulationResult> results;
    for (auto& lane : lanes_) {
      if (lane->leaves_at) lane->go_on_alone(controller_, rotor_inertia_);
      results.push_back(std::move(lane->result));
    }
    return results;
  }

 private:
  using At = ObservationOffset;

  /// Lanes without a run have the robot of the first one.
  const Lane& lane_or_first(int l) const {
    const auto i = static_cast<std::size_t>(l);
    return *lanes_[i < lanes_.size() ? i : 0];
  }

  void put_held(int l, const HeldTarget& held) {
    held_.at(0, l) = held.body.mass;
    int next = held_.put(1, l, held.body.inertia);
    next = held_.put(next, l, held.hand_target.position);
    held_.put(next, l, held.hand_target.orientation.toRotationMatrix());
  }

  bool is_any_moving() const {
    return std::any_of(lanes_.begin(), lanes_.end(), [](const auto& x) { return x->is_moving; });
  }

  template <class Do>
  void for_each_moving(Do action) {
    for (std::size_t l = 0; l < lanes_.size(); ++l) {
      if (lanes_[l]->is_moving) action(static_cast<int>(l), *lanes_[l]);
    }
  }

  /// Lanes without a run, or whose run is over, do their first step again and again, so that their
  /// numbers stay finite.
  void reset_idle_lanes() {
    for (int l = 0; l < kernel_.lanes; ++l) {
      const auto i = static_cast<std::size_t>(l);
      if (i < lanes_.size() && lanes_[i]->is_moving) continue;
      const PlantState& first = lane_or_first(l).first;
      put_state(first, l, states_);
      put_state(first, l, measured_);
    }
  }

  /// The states after a step from t. A lane that cannot do this step leaves the group before it.
  void take_states(double t, const Ticks& control) {
    for_each_moving([&](int l, Lane& lane) {
      PlantState after = lane.state;
      bool is_within = take_state(states_, l, after);
      for (int k = 0; k < n_; ++k) {
        const Joint& joint = lane.run.robot.joints[static_cast<std::size_t>(k)];
        is_within = is_within && after.phi[k] >= joint.lower && after.phi[k] <= joint.upper;
      }
      if (is_within) {
        lane.state = after;
        return;
      }
      lane.leaves_at = t;
      lane.course.control = control;
      lane.course.steps = steps_;
      lane.course.is_within_stretch = control.next() > t;
      lane.is_moving = false;
    });
  }

  void end_early(double t) {
    std::vector<int> over;
    for_each_moving([&](int l, Lane& lane) {
      const auto& ends_when = lane.run.options.ends_when;
      if (ends_when && ends_when(lane.course.recorder.so_far())) over.push_back(l);
    });
    if (over.empty()) return;
    look();
    for (const int l : over) {
      end(t, SimulationStatus::Finished, l, *lanes_[static_cast<std::size_t>(l)]);
    }
  }

  void end_all(double t, SimulationStatus status) {
    look();
    for_each_moving([&](int l, Lane& lane) { end(t, status, l, lane); });
  }

  void end(double t, SimulationStatus status, int l, Lane& lane) {
    lane.course.recorder.record_next();
    observe(t, l, lane);
    lane.result = lane.course.recorder.take(status, steps_);
    lane.is_moving = false;
  }

  void measure() {
    if (!known_) return;
    for_each_moving([&](int l, Lane& lane) {
      const bool is_exact = lane.sensing.is_exact();
      put_state(is_exact ? lane.state : lane.sensing.measure(lane.state), l, measured_);
    });
    step_.measured = measured_.data();
  }

  /// Observes all states with the torques that are held.
  void look() {
    step_.commands = false;
    step_.h = 0;
    reset_idle_lanes();
    kernel_.advance(step_);
  }

  void advance(double t, double h, bool commands) {
    step_.commands = commands;
    step_.h = h;
    reset_idle_lanes();
    kernel_.advance(step_);
    for_each_moving([&](int l, Lane& lane) { observe(t, l, lane); });
  }

  /// The state before the last call of the kernel.
  void observe(double t, int l, Lane& lane) {
    tau_.take(0, l, lane.command.tau);
    demanded_.take(0, l, lane.demanded);
    lane.saturated = false;
    for (int k = 0; k < n_; ++k) {
      const Joint& joint = lane.run.robot.joints[static_cast<std::size_t>(k)];
      lane.saturated = lane.saturated || is_cut(joint, lane.demanded[k], lane.command.tau[k]);
    }
    Observation now{t, lane.state, lane.command, lane.demanded, lane.saturated};
    observed_.take(At::base, l, now.momentum.base);
    observed_.take(At::coupling, l, now.momentum.coupling);
    observed_.take(At::P, l, now.momentum.P);
    now.momentum.L_g = now.momentum.base + now.momentum.coupling;
    now.kinetic_energy = observed_.at(At::energy, l);
    now.central_inertia = observed_.at(At::inertia, l);
    now.mass = lane.run.robot.total_mass();
    if (step_.sensors != nullptr) now.momentum_seen = observed_.at(At::seen, l);
    if (is_reaction_null_space_control(controller_.kind)) {
      now.rank = static_cast<int>(observed_.at(At::rank, l));
      observed_.take(At::unreachable, l, now.unreachable);
    }
    if (options_.grasp.target) {
      Vector6d wrench;
      observed_.take(At::grip, l, wrench);
      lane.course.recorder.observe_grip(wrench);
    }
    lane.course.recorder.observe(now);
  }

  const LaneKernel& kernel_;
  const Controller& controller_;
  const SimulationOptions& options_;
  int n_;
  std::vector<std::unique_ptr<Lane>> lanes_;
  RobotColumns plant_;
  std::optional<RobotColumns> known_;
  LaneColumns held_, wheels_, states_, measured_, tau_, demanded_, observed_;
  JointVectord rotor_inertia_, nothing_added_;
  std::vector<bool> none_locked_;
  LaneStep step_;
  long steps_ = 0;
};

}  // namespace

std::vector<SimulationResult> simulate_post_impacts(const std::vector<PostImpactRun>& runs,
                                                    const Controller& controller) {
  for (const PostImpactRun& run : runs) {
    check_simulation(run.robot, run.resistance, run.initial, controller, run.options);
  }
  const LaneKernel& kernel = widest_kernel();
  std::vector<SimulationResult> results;
  for (std::size_t i = 0; i < runs.size();) {
    std::vector<const PostImpactRun*> group;
    const auto joins = [&](const PostImpactRun& run) {
      return static_cast<int>(group.size()) < kernel.lanes &&
             fits_a_lane(kernel, run, controller) &&
             (group.empty() || are_alike(*group.front(), run));
    };
    while (i < runs.size() && joins(runs[i])) group.push_back(&runs[i++]);
    if (group.empty()) {
      const PostImpactRun& run = runs[i++];
      results.push_back(
          simulate_post_impact(run.robot, run.resistance, run.initial, controller, run.options));
      continue;
    }
    auto found = LaneGroup(kernel, group, controller).run();
    std::move(found.begin(), found.end(), std::back_inserter(results));
  }
  return results;
}

int size_of_group(int count, int threads) {
  return std::clamp((count + threads - 1) / std::max(1, threads), 1, widest_kernel().lanes);
}

}  // namespace stillbase
