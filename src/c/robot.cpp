// Robots of the C interface.
#include <algorithm>
#include <limits>

#include <fmt/format.h>

#include <stillbase/impact/batch.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "c/c_interface.hpp"

using namespace stillbase;
using stillbase::c::copy_to;
using stillbase::c::guarded;
using stillbase::c::needed;
using stillbase::c::numbers;

stillbase_status stillbase_robot_read(const char* path, const char* hand, stillbase_robot** robot) {
  return guarded([&] {
    needed(path, "path");
    needed(robot, "robot");
    *robot = new stillbase_robot{read_robot(path, hand == nullptr ? "" : hand)};
  });
}

void stillbase_robot_free(stillbase_robot* robot) { delete robot; }

int stillbase_robot_joints(const stillbase_robot* robot) {
  return robot == nullptr ? 0 : robot->model.n();
}

const char* stillbase_robot_joint_name(const stillbase_robot* robot, int k) {
  if (robot == nullptr || k < 0 || k >= robot->model.n()) return nullptr;
  return robot->model.joints[static_cast<std::size_t>(k)].name.c_str();
}

stillbase_status stillbase_robot_jump(const stillbase_robot* robot, const double* phi,
                                      const double* impulse, double* Delta_Omega,
                                      double* Delta_phidot) {
  return guarded([&] {
    const RobotModel& model = needed(robot, "robot").model;
    needed(Delta_Omega, "Delta_Omega");
    const JointVectord at = numbers(phi, model.n(), "phi");
    const Vector6d Fbar = numbers(impulse, 6, "impulse");
    const auto jump = compute_jump<double>(model, at, JointVectord::Zero(model.n()), {}, Fbar);
    c::demand_finite(jump.Delta_Omega);
    c::demand_finite(jump.Delta_phidot);
    copy_to(Delta_Omega, jump.Delta_Omega);
    copy_to(Delta_phidot, jump.Delta_phidot);
  });
}

stillbase_status stillbase_robot_respond(const stillbase_robot* robot, size_t count,
                                         const double* phi, const double* impulses,
                                         double* Delta_Omega, double* base) {
  using Rows = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  return guarded([&] {
    const RobotModel& model = needed(robot, "robot").model;
    if (count == 0) return;
    needed(Delta_Omega, "Delta_Omega");
    const int widest = std::max(model.n(), 6);
    constexpr auto kMostBytes = static_cast<std::size_t>(std::numeric_limits<Eigen::Index>::max());
    if (count > kMostBytes / sizeof(double) / static_cast<std::size_t>(widest)) {
      throw c::ArgumentError(fmt::format("count: {} postures are more than fit in memory", count));
    }
    const auto rows = static_cast<Eigen::Index>(count);
    ImpactBatch batch;
    batch.phi =
        Eigen::Map<const Rows>(numbers(phi, rows * model.n(), "phi").data(), rows, model.n());
    batch.F = Eigen::Map<const Rows>(numbers(impulses, rows * 6, "impulses").data(), rows, 6);
    ImpactBatchValues values;
    evaluate_postures(model, {JointVectord::Zero(model.n()), {}}, batch, values);
    c::demand_finite(values.Delta_Omega);
    c::demand_finite(values.base);
    Eigen::Map<Rows>(Delta_Omega, rows, 6) = values.Delta_Omega;
    if (base != nullptr) Eigen::Map<Rows>(base, rows, 3) = values.base;
  });
}
