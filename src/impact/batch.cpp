#include <stillbase/impact/batch.hpp>

#include <cassert>
#include <cmath>

#include "impact/batch_run.hpp"
#include "impact/direction_squares_kernel.hpp"
#include "impact/null_velocities.hpp"

namespace stillbase {

const BatchKernel* batch_kernel_plain() {
  static constinit const BatchKernel kernel = {
      1,
      kMaxJoints,
      [] { return true; },
      [](const RobotModel& robot, const ImpactResistance& resistance, const BatchColumns& columns) {
        run_batch<double>(robot, resistance, columns, 1);
      },
      [](const RobotModel& robot, const std::vector<Eigen::Index>& free,
         const NullVelocityColumns& columns) {
        find_null_velocities<double>(robot, free, columns, 1);
      },
      run_direction_squares<double>,
      [](const double* x, double* sine, double* cosine) {
        *sine = std::sin(*x);
        *cosine = std::cos(*x);
      }};
  return &kernel;
}

const std::vector<const BatchKernel*>& batch_kernels() {
  static const std::vector<const BatchKernel*> kernels = [] {
    std::vector<const BatchKernel*> out;
    for (const BatchKernel* kernel : {batch_kernel_avx512(), batch_kernel_avx2(),
                                      batch_kernel_two_lanes(), batch_kernel_plain()}) {
      if (kernel != nullptr && kernel->runs_here()) out.push_back(kernel);
    }
    return out;
  }();
  return kernels;
}

void set_objective(const BatchObjective& objective, BatchColumns& columns) {
  columns.objective_parts = 0;
  for (std::size_t k = 0; k < kResponseParts; ++k) {
    const Matrix3d& G = objective.metrics[k];
    if (G.isZero(0)) continue;
    BatchMetric& metric = columns.objective[columns.objective_parts++];
    metric.part = static_cast<ResponsePart>(k);
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) metric.G[i][j] = G(i, j);
    }
  }
}

namespace {

BatchColumns columns_of(const ImpactBatch& batch) {
  assert(batch.F.cols() == 6);
  assert(batch.F.rows() == batch.phi.rows());
  assert(batch.approach.size() == batch.target_inverse_mass.size());
  BatchColumns columns;
  columns.count = batch.phi.rows();
  columns.phi = batch.phi.data();
  columns.F = batch.F.data();
  columns.is_one_posture = batch.is_one_posture;
  assert(!batch.is_one_posture || batch.phi.colwise().maxCoeff() == batch.phi.colwise().minCoeff());
  if (batch.approach.size() > 0) {
    assert(batch.approach.size() == columns.count);
    columns.approach = batch.approach.data();
    columns.target_inverse_mass = batch.target_inverse_mass.data();
  }
  if (batch.target.size() > 0) {
    assert(batch.target.rows() == columns.count && batch.target.cols() == kTargetNumbers);
    columns.target = batch.target.data();
    columns.law = batch.law;
  }
  return columns;
}

/// The widest one for n joints.
const BatchKernel& kernel_for(int n) {
  for (const BatchKernel* kernel : batch_kernels()) {
    if (n <= kernel->max_joints) return *kernel;
  }
  return *batch_kernel_plain();
}

void run(const RobotModel& robot, const ImpactResistance& resistance, const BatchColumns& columns) {
  kernel_for(robot.n()).run(robot, resistance, columns);
}

}  // namespace

void put_target(const TargetAtHand<double>& target, Eigen::Index row, ImpactBatch& batch) {
  Eigen::Index column = 0;
  for_each_number(target, [&](double number) { batch.target(row, column++) = number; });
}

int batch_lanes(int n) { return kernel_for(n).lanes; }

void evaluate_postures(const RobotModel& robot, const ImpactResistance& resistance,
                       const ImpactBatch& batch, ImpactBatchValues& out) {
  BatchColumns columns = columns_of(batch);
  out.Delta_Omega.resize(columns.count, 6);
  out.base.resize(columns.count, 3);
  out.total.resize(columns.count, 3);
  out.hand_inverse_mass.resize(columns.count);
  out.p.resize(columns.count);
  columns.Delta_Omega = out.Delta_Omega.data();
  columns.base = out.base.data();
  columns.total = out.total.data();
  columns.hand_inverse_mass = out.hand_inverse_mass.data();
  columns.p = out.p.data();
  run(robot, resistance, columns);
}

void evaluate_objective(const RobotModel& robot, const ImpactResistance& resistance,
                        const ImpactBatch& batch, const BatchObjective& objective, bool derivatives,
                        BatchObjectiveValues& out) {
  BatchColumns columns = columns_of(batch);
  set_objective(objective, columns);
  out.psi.resize(columns.count);
  columns.psi = out.psi.data();
  if (derivatives) {
    out.gradient.resize(columns.count, robot.n());
    out.gradient_F.resize(columns.count, 6);
    columns.gradient = out.gradient.data();
    columns.gradient_F = out.gradient_F.data();
    if (columns.target != nullptr) {
      out.gradient_target.resize(columns.count, 9);
      columns.gradient_target = out.gradient_target.data();
    }
  }
  run(robot, resistance, columns);
}

void find_direction_squares(const DirectionSquares& directions) {
  batch_kernels().front()->direction_squares(directions);
}

void find_null_velocities(const RobotModel& robot, const std::vector<Eigen::Index>& free,
                          NullVelocities& batch) {
  const Eigen::Index count = batch.phi.rows();
  assert(batch.wanted.rows() == count);
  assert(batch.wanted.cols() == static_cast<Eigen::Index>(free.size()));
  batch.phidot.resize(count, batch.wanted.cols());
  batch.conditioning.resize(count);
  kernel_for(robot.n()).null_velocities(robot, free,
                                        {count, batch.phi.data(), batch.wanted.data(),
                                         batch.phidot.data(), batch.conditioning.data()});
}

}  // namespace stillbase
