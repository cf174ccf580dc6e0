// Time and heap allocations per call of the functions that a search calls a million times, on the
// seven-joint arm of problems/robots/iiwa_on_cube.urdf, beside other libraries where installed.
#include <algorithm>
#include <cstdio>
#include <exception>
#include <map>
#include <string>
#include <vector>

#include <benchmark/benchmark.h>

#include <stillbase/core/file.hpp>
#include <stillbase/dynamics/bias.hpp>
#include <stillbase/formulation/formulation.hpp>
#include <stillbase/impact/batch.hpp>
#include <stillbase/impact/contact_response.hpp>
#include <stillbase/robot/urdf_reader.hpp>
#include <stillbase/simulation/plant.hpp>

#include "bench_support.hpp"
#include "support/count_allocations.hpp"
#include "support/random_robot.hpp"

namespace stillbase {

const RobotModel& robot() {
  static const RobotModel model = [] {
    const std::string path = STILLBASE_SOURCE_DIR "/problems/robots/iiwa_on_cube.urdf";
    return read_urdf(read_text_file(path), path, "hand");
  }();
  return model;
}

long allocations_so_far() { return kCountsAllocations ? allocation_count : -1; }

void register_mujoco();
void register_dart();

namespace {

ImpactResistance free_joints() { return {JointVectord::Zero(robot().n()), {}}; }

void mass_matrix_and_hand_jacobian(benchmark::State& state) {
  Postures postures;
  measure(state, [&] {
    const auto kinematics = compute_kinematics<double>(robot(), postures.next());
    const auto inertia = compute_inertia(robot(), kinematics);
    const auto jacobian = compute_hand_jacobian(robot(), kinematics);
    benchmark::DoNotOptimize(inertia.H_phi.data());
    benchmark::DoNotOptimize(jacobian.J_phi.data());
    benchmark::ClobberMemory();
  });
}
BENCHMARK(mass_matrix_and_hand_jacobian);

void bias_forces(benchmark::State& state) {
  const auto kinematics = compute_kinematics<double>(robot(), Postures().next());
  const auto inertia = compute_inertia(robot(), kinematics);
  const JointVectord phidot = joint_rates();
  measure(state, [&] {
    const auto bias = compute_bias<double>(robot(), kinematics, inertia, wrench(), phidot);
    benchmark::DoNotOptimize(bias.c_phi.data());
    benchmark::ClobberMemory();
  });
}
BENCHMARK(bias_forces);

/// The velocity jump of a new posture, from joint positions on: what the peers do, too.
void jump(benchmark::State& state) {
  Postures postures;
  const JointVectord nothing_added = JointVectord::Zero(robot().n());
  const Vector6d F = wrench();
  measure(state, [&] {
    const auto d = compute_jump<double>(robot(), postures.next(), nothing_added, {}, F);
    benchmark::DoNotOptimize(d.Delta_phidot.data());
    benchmark::ClobberMemory();
  });
}
BENCHMARK(jump);

/// The same with the momenta and the hand's inverse mass, ready for other directions and gradients.
void posture_and_response(benchmark::State& state) {
  Postures postures;
  const ImpactResistance resistance = free_joints();
  const Vector6d F = wrench();
  measure(state, [&] {
    const auto posture = evaluate_posture<double>(robot(), resistance, postures.next());
    const auto response = respond<double>(posture, F);
    benchmark::DoNotOptimize(response.d.Delta_phidot.data());
    benchmark::ClobberMemory();
  });
}
BENCHMARK(posture_and_response);

/// The same and the exact gradient of 1/2 |y|^2, y the vector that the weights take.
void jump_with_gradient(benchmark::State& state, bool of_base_momentum) {
  Postures postures;
  const ImpactResistance resistance = free_joints();
  const Vector6d F = wrench();
  measure(state, [&] {
    const auto posture = evaluate_posture<double>(robot(), resistance, postures.next());
    const auto response = respond<double>(posture, F);
    ResponseWeights<double> weights;
    (of_base_momentum ? weights.base : weights.omega) =
        of_base_momentum ? response.base : response.omega();
    const auto gradient = response_gradient(robot(), posture, response, weights);
    benchmark::DoNotOptimize(gradient.phi.data());
    benchmark::ClobberMemory();
  });
}
BENCHMARK_CAPTURE(jump_with_gradient, base_angular_velocity, false);
BENCHMARK_CAPTURE(jump_with_gradient, base_angular_momentum, true);

/// Posture, impulse of a latch on a client of the same size, and the exact gradient of 1/2 |l|^2,
/// l the angular momentum of the base after it.
void latch_with_gradient(benchmark::State& state) {
  Postures postures;
  const ImpactResistance resistance = free_joints();
  RigidContact<double> contact;
  contact.law = ContactLaw::Latch;
  contact.target = {1 / 50.0,          4 * Matrix3d::Identity(), Matrix3d::Identity() / 4,
                    {-0.5, 0.1, 0.05}, {-0.02, 0.01, 0},         {0.01, -0.02, 0.03}};
  measure(state, [&] {
    const auto posture = evaluate_posture<double>(robot(), resistance, postures.next());
    const auto response = respond_to_contact<double>(posture, contact);
    ResponseWeights<double> weights;
    weights.base = response.base;
    const auto gradient = contact_gradient<double>(robot(), posture, contact, response, weights);
    benchmark::DoNotOptimize(gradient.phi.data());
    benchmark::ClobberMemory();
  });
}
BENCHMARK(latch_with_gradient);

BatchObjective part_alone(ResponsePart part) {
  BatchObjective out;
  out.add(part, 1);
  return out;
}

/// The same per posture, many postures at a time.
void jump_with_gradient_in_packs(benchmark::State& state, BatchObjective objective) {
  constexpr int kCount = 64;
  Postures postures;
  ImpactBatch batch;
  batch.phi.resize(kCount, robot().n());
  batch.F.resize(kCount, 6);
  for (int i = 0; i < kCount; ++i) {
    batch.phi.row(i) = postures.next();
    batch.F.row(i) = wrench();
  }
  const ImpactResistance resistance = free_joints();
  BatchObjectiveValues values;
  int used = kCount;
  measure(state, [&] {  // one call per posture: the batch runs when its postures are used up
    if (++used < kCount) return;
    used = 0;
    evaluate_objective(robot(), resistance, batch, objective, true, values);
    benchmark::ClobberMemory();
  });
}
BENCHMARK_CAPTURE(jump_with_gradient_in_packs, base_angular_velocity,
                  part_alone(ResponsePart::BaseRate));
BENCHMARK_CAPTURE(jump_with_gradient_in_packs, base_angular_momentum,
                  part_alone(ResponsePart::BaseAngularMomentum));

/// Accelerations from joint positions and rates on, joints without torque.
void forward_dynamics(benchmark::State& state) {
  Postures postures;
  const JointVectord no_rotors = JointVectord::Zero(robot().n());
  PlantState plant = state_at_rest({}, no_rotors);
  plant.phidot = joint_rates();
  measure(state, [&] {
    plant.phi = postures.next();
    const auto acceleration =
        compute_acceleration(robot(), no_rotors, plant, Vector6d::Zero(), no_rotors);
    benchmark::DoNotOptimize(acceleration.phiddot.data());
    benchmark::ClobberMemory();
  });
}
BENCHMARK(forward_dynamics);

/// The jump of a random chain with that many joints, by the route that its size chooses.
void jump_of_chain(benchmark::State& state) {
  const int n = static_cast<int>(state.range(0));
  Random random(1);
  const RobotModel chain = random_robot(random, n, false);
  Postures postures(n);
  const JointVectord nothing_added = JointVectord::Zero(n);
  const Vector6d F = wrench();
  measure(state, [&] {
    const auto d = compute_jump<double>(chain, postures.next(), nothing_added, {}, F);
    benchmark::DoNotOptimize(d.Delta_phidot.data());
    benchmark::ClobberMemory();
  });
}
BENCHMARK(jump_of_chain)->Arg(7)->Arg(14)->Arg(20)->Arg(21)->Arg(60);

/// The accelerations of the same chains, by the route that their size chooses or by the inertia
/// matrix.
void forward_dynamics_of_chain(benchmark::State& state, bool by_matrix) {
  const int n = static_cast<int>(state.range(0));
  Random random(1);
  const RobotModel chain = random_robot(random, n, false);
  Postures postures(n);
  const JointVectord none = JointVectord::Zero(n);
  PlantState plant = state_at_rest({}, none);
  for (double& rate : plant.phidot) rate = random.uniform(-0.1, 0.1);
  const Vector6d F_b = Vector6d::Zero();
  measure(state, [&] {
    plant.phi = postures.next();
    const PlantAcceleration acceleration =
        by_matrix ? compute_acceleration(PlantTerms(chain, none, plant), F_b, none)
                  : compute_acceleration(chain, none, plant, F_b, none);
    benchmark::DoNotOptimize(acceleration.phiddot.data());
    benchmark::ClobberMemory();
  });
}
BENCHMARK_CAPTURE(forward_dynamics_of_chain, chosen, false)->Arg(14)->Arg(20)->Arg(21)->Arg(60);
BENCHMARK_CAPTURE(forward_dynamics_of_chain, by_matrix, true)->Arg(14)->Arg(20)->Arg(21)->Arg(60);

/// One evaluation as an optimizer sees it: objective, gradient, constraints, Jacobian.
void formulation_evaluate(benchmark::State& state) {
  CaptureProblem problem;
  problem.robot = robot();
  problem.resistance.model = ResistanceModel::Free;
  problem.start = JointVectord::Zero(robot().n());
  problem.impulse.source = ImpulseSource::Given;
  problem.impulse.direction = wrench().head<3>();
  problem.variables.joints.assign(static_cast<std::size_t>(robot().n()), true);
  const Formulation formulation(problem);
  Postures postures;
  nlp::Evaluation out;
  Eigen::VectorXd x(formulation.num_variables());
  measure(state, [&] {
    x = postures.next();
    formulation.evaluate(x, out);
    benchmark::DoNotOptimize(out.gradient.data());
    benchmark::ClobberMemory();
  });
}
BENCHMARK(formulation_evaluate);

/// Prints what the console reporter prints, and keeps the times for the table of ratios.
class Reporter : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.error_occurred) continue;
      const bool is_median = run.aggregate_name == "median";
      if (run.run_type == Run::RT_Aggregate && !is_median) continue;
      std::vector<double>& times = times_[run.run_name.function_name];
      if (is_median) times.clear();  // it stands for the repetitions
      times.push_back(run.GetAdjustedCPUTime());
    }
    ConsoleReporter::ReportRuns(runs);
  }

  /// Ours over theirs, medians of the repetitions.
  void print_ratios() const {
    const auto row = [this](const std::string& ours, const std::string& theirs) {
      const auto a = times_.find(ours), b = times_.find(theirs);
      if (a == times_.end() || b == times_.end()) return;
      std::printf("%-68s %8.0f ns %8.0f ns %6.3f\n", (ours + " / " + theirs).c_str(),
                  median(a->second), median(b->second), median(a->second) / median(b->second));
    };
    std::printf("\n%-68s %11s %11s %6s\n", "ratio of medians", "first", "second", "ratio");
    for (const char* what : {"mass_matrix_and_hand_jacobian", "jump", "forward_dynamics"}) {
      for (const char* peer : {"/mujoco", "/dart"}) row(what, std::string(what) + peer);
    }
    row("rk4_step_without_control", "rk4_step_without_control/mujoco");
    row("rk4_step_under_control/sampled_rns_damped", "rk4_step_without_control/mujoco");
    for (const char* how : {"/fcl_pairs", "/fcl_tree", "/fcl_overlap"}) {
      row("path_posture", std::string("path_posture") + how);
    }
    for (const char* what : {"base_angular_velocity", "base_angular_momentum"}) {
      row(std::string("jump_with_gradient_in_packs/") + what,
          std::string("jump_with_gradient/") + what);
    }
  }

 private:
  static double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  }

  std::map<std::string, std::vector<double>> times_;
};

}  // namespace
}  // namespace stillbase

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  try {
#ifdef STILLBASE_BENCH_MUJOCO
    stillbase::register_mujoco();
#endif
#ifdef STILLBASE_BENCH_DART
    stillbase::register_dart();
#endif
  } catch (const std::exception& error) {
    std::fprintf(stderr, "impact_bench: %s\n", error.what());
    return 1;
  }
  stillbase::Reporter reporter;
  benchmark::RunSpecifiedBenchmarks(&reporter);
  reporter.print_ratios();
  benchmark::Shutdown();
  return 0;
}
