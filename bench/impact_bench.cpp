// Time and heap allocations per call of the functions that a search calls a million times, on the
// seven-joint arm of problems/robots/iiwa_on_cube.urdf.
#include <vector>

#include <benchmark/benchmark.h>

#include <stillbase/capture/formulation.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/core/random.hpp>
#include <stillbase/dynamics/bias.hpp>
#include <stillbase/impact/gradient.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "support/count_allocations.hpp"

namespace stillbase {
namespace {

const RobotModel& robot() {
  static const RobotModel model = [] {
    const std::string path = STILLBASE_SOURCE_DIR "/problems/robots/iiwa_on_cube.urdf";
    return read_urdf(read_text_file(path), path, "hand");
  }();
  return model;
}

/// Postures in turn, so that no branch and no value can be learnt by heart.
class Postures {
 public:
  Postures() {
    Random random(1);
    for (int i = 0; i < 64; ++i) {
      JointVectord phi(robot().n());
      for (double& angle : phi) angle = random.uniform(-2, 2);
      postures_.push_back(phi);
    }
  }
  const JointVectord& next() { return postures_[++i_ % postures_.size()]; }

 private:
  std::vector<JointVectord> postures_;
  std::size_t i_ = 0;
};

/// Runs f over and over; reports the allocations of a call beside its time.
template <class F>
void measure(benchmark::State& state, const F& f) {
  f();  // whatever is set up once
  const long before = allocation_count;
  long calls = 0;
  for (auto _ : state) {
    f();
    ++calls;
  }
  if (kCountsAllocations && calls > 0) {
    state.counters["allocations"] =
        static_cast<double>(allocation_count - before) / static_cast<double>(calls);
  }
}

Vector6d wrench() {
  Vector6d F;
  F << 0.48, 0.6, 0.64, 0, 0, 0;
  return F;
}

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
  const JointVectord phidot = JointVectord::LinSpaced(robot().n(), -0.5, 0.5);
  measure(state, [&] {
    const auto bias = compute_bias<double>(robot(), kinematics, inertia, wrench(), phidot);
    benchmark::DoNotOptimize(bias.c_phi.data());
    benchmark::ClobberMemory();
  });
}
BENCHMARK(bias_forces);

/// The velocity jump of a new posture, from joint positions on.
void jump(benchmark::State& state) {
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
BENCHMARK(jump);

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

}  // namespace
}  // namespace stillbase

BENCHMARK_MAIN();
