// The batch loop, once for each width of register, chosen at run time.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <stillbase/impact/batch.hpp>

#include "impact/direction_squares.hpp"

namespace stillbase {

/// The matrix of one part of the objective, plain numbers: kernels for wide registers share no
/// inline functions on doubles with the other files.
struct BatchMetric {
  ResponsePart part;
  double G[3][3];
};

/// The columns of a batch: entry (i, j) of a matrix is at [i + j * count]. Null: not wanted.
struct BatchColumns {
  std::ptrdiff_t count = 0;
  const double* phi = nullptr;
  const double* F = nullptr;
  const double* approach = nullptr;
  const double* target_inverse_mass = nullptr;
  const double* target = nullptr;
  ContactLaw law = ContactLaw::Frictionless;
  bool is_one_posture = false;
  double* Delta_Omega = nullptr;
  double* base = nullptr;
  double* total = nullptr;
  double* hand_inverse_mass = nullptr;
  double* p = nullptr;
  std::array<BatchMetric, kResponseParts> objective = {};  ///< parts whose matrix is not zero
  std::size_t objective_parts = 0;
  double* psi = nullptr;
  double* gradient = nullptr;
  double* gradient_F = nullptr;
  double* gradient_target = nullptr;
};

/// The same of null_velocities.hpp.
struct NullVelocityColumns {
  std::ptrdiff_t count = 0;
  const double* phi = nullptr;
  const double* wanted = nullptr;
  double* phidot = nullptr;
  double* conditioning = nullptr;
};

struct BatchKernel {
  int lanes;
  int max_joints;
  bool (*runs_here)();  ///< on this processor
  void (*run)(const RobotModel& robot, const ImpactResistance& resistance,
              const BatchColumns& columns);
  void (*null_velocities)(const RobotModel& robot, const std::vector<Eigen::Index>& free,
                          const NullVelocityColumns& columns);
  void (*direction_squares)(const DirectionSquares& directions);
  /// Sine and cosine of `lanes` angles: for the tests.
  void (*sin_cos)(const double* x, double* sine, double* cosine);
};

/// Sets the objective of a batch.
void set_objective(const BatchObjective& objective, BatchColumns& columns);

/// Null where the compiler has no such registers.
const BatchKernel* batch_kernel_avx512();
const BatchKernel* batch_kernel_avx2();
const BatchKernel* batch_kernel_two_lanes();  ///< any machine
const BatchKernel* batch_kernel_plain();      ///< any machine, any robot

/// All that run on this processor, the widest first, the plain one last.
const std::vector<const BatchKernel*>& batch_kernels();

}  // namespace stillbase
