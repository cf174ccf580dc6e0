// The same robot in MuJoCo. Its functions are called one by one, so that nothing is timed that the
// result does not need (contacts, sensors, actuators).
#include <algorithm>
#include <cstring>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <string>

#include <mujoco/mujoco.h>

#include "bench_support.hpp"

namespace stillbase {

namespace {

std::string numbers(std::initializer_list<double> values) {
  std::ostringstream out;
  out.precision(17);
  for (const double value : values) out << value << ' ';
  return out.str();
}

std::string inertial(const Body& body) {
  const Matrix3d& I = body.inertia;
  const Vector3d& c = body.centroid;
  return "<inertial pos=\"" + numbers({c.x(), c.y(), c.z()}) + "\" mass=\"" + numbers({body.mass}) +
         "\" fullinertia=\"" + numbers({I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2), I(1, 2)}) +
         "\"/>";
}

std::string bodies_below(int parent) {
  std::string out;
  for (int k = 0; k < robot().n(); ++k) {
    const Joint& joint = robot().joints[k];
    if (joint.parent != parent) continue;
    const Eigen::Quaterniond q(joint.R.matrix());
    out += "<body pos=\"" + numbers({joint.p.x(), joint.p.y(), joint.p.z()}) + "\" quat=\"" +
           numbers({q.w(), q.x(), q.y(), q.z()}) + "\"><joint type=\"" +
           (joint.is_prismatic() ? "slide" : "hinge") + "\" axis=\"0 0 1\"/>" +
           inertial(robot().bodies[k]) + bodies_below(k) + "</body>";
  }
  return out;
}

std::string model_xml() {
  return "<mujoco><compiler angle=\"radian\" inertiafromgeom=\"false\"/><option gravity=\"0 0 0\"/>"
         "<worldbody><body><freejoint/>" +
         inertial(robot().base) + bodies_below(kBase) + "</body></worldbody></mujoco>";
}

class MuJoCo {
 public:
  MuJoCo() {
    const std::string xml = model_xml();
    const auto files = std::make_unique<mjVFS>();
    mj_defaultVFS(files.get());
    if (mj_makeEmptyFileVFS(files.get(), "robot.xml", static_cast<int>(xml.size())) != 0) {
      throw std::runtime_error("MuJoCo: no memory for the model");
    }
    std::memcpy(files->filedata[0], xml.data(), xml.size());
    char error[1000] = "";
    model_ = mj_loadXML("robot.xml", files.get(), error, sizeof(error));
    mj_deleteVFS(files.get());
    if (model_ == nullptr) throw std::runtime_error(std::string("MuJoCo: ") + error);
    data_ = mj_makeData(model_);
    nv_ = model_->nv;
    jacobian_.setZero(6, nv_);
    force_.setZero(nv_);
    solution_.setZero(nv_);
  }

  void set_posture(const JointVectord& phi) {
    Eigen::Map<Eigen::VectorXd>(data_->qpos + 7, phi.size()) = phi;
  }

  void mass_matrix() {
    mj_kinematics(model_, data_);
    mj_comPos(model_, data_);
    mj_crb(model_, data_);
  }

  void hand_jacobian() {
    const int body = robot().hand_body + 2;  // world, base, body 0, ...: depth first like ours
    const Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>> R(data_->xmat + 9 * body);
    const Vector3d point = Eigen::Map<const Vector3d>(data_->xpos + 3 * body) + R * robot().p_hand;
    mj_jac(model_, data_, jacobian_.data(), jacobian_.data() + 3 * nv_, point.data(), body);
  }

  const Eigen::VectorXd& jump(const Vector6d& F) {
    mass_matrix();
    hand_jacobian();
    mj_factorM(model_, data_);
    force_.noalias() = jacobian_.transpose() * F;
    mj_solveM(model_, data_, solution_.data(), force_.data(), 1);
    return solution_;
  }

  const Eigen::VectorXd& acceleration(const JointVectord& phidot) {
    Eigen::Map<Eigen::VectorXd>(data_->qvel + 6, phidot.size()) = phidot;
    return acceleration();
  }

  const Eigen::VectorXd& acceleration() {
    mass_matrix();
    mj_factorM(model_, data_);
    mj_comVel(model_, data_);
    mj_rne(model_, data_, 0, force_.data());
    force_ = -force_;
    mj_solveM(model_, data_, solution_.data(), force_.data(), 1);
    return solution_;
  }

  void set_state(const PlantState& state) {
    set_posture(state.phi);
    const Vector3d& p = state.base.position;
    const Eigen::Quaterniond& q = state.base.orientation;
    const double base[7] = {p.x(), p.y(), p.z(), q.w(), q.x(), q.y(), q.z()};
    std::copy(base, base + 7, data_->qpos);
    // The free joint has its velocity in the world, the angular one in the base.
    Eigen::Map<Vector3d>(data_->qvel) = q * state.Omega.head<3>();
    Eigen::Map<Vector3d>(data_->qvel + 3) = state.Omega.tail<3>();
    Eigen::Map<Eigen::VectorXd>(data_->qvel + 6, state.phidot.size()) = state.phidot;
  }

  /// A step of Runge and Kutta's classical method; positions are integrated as mj_RungeKutta does.
  void rk4_step(double h) {
    const Eigen::VectorXd q = positions(), v = velocities();
    constexpr double kParts[4] = {0, 0.5, 0.5, 1};
    constexpr double kWeights[4] = {1. / 6, 1. / 3, 1. / 3, 1. / 6};
    rate_sum_.setZero(nv_);
    acceleration_sum_.setZero(nv_);
    for (int stage = 0; stage < 4; ++stage) {
      if (stage > 0) {
        const double part = kParts[stage] * h;
        positions() = q;
        rate_ = velocities();
        mj_integratePos(model_, data_->qpos, rate_.data(), part);
        velocities() = v + part * solution_;
      }
      rate_sum_ += kWeights[stage] * velocities();
      acceleration_sum_ += kWeights[stage] * acceleration();
    }
    positions() = q;
    mj_integratePos(model_, data_->qpos, rate_sum_.data(), h);
    velocities() = v + h * acceleration_sum_;
  }

  /// Joint positions and rates and the base's angular velocity.
  Eigen::VectorXd state() {
    Eigen::VectorXd out(2 * (nv_ - 6) + 3);
    out << positions().tail(nv_ - 6), velocities().tail(nv_ - 6), velocities().segment<3>(3);
    return out;
  }

  Eigen::MatrixXd full_mass_matrix() {
    Eigen::MatrixXd H(nv_, nv_);
    mj_fullM(model_, H.data(), data_->qM);
    return H;
  }

 private:
  Eigen::Map<Eigen::VectorXd> positions() { return {data_->qpos, model_->nq}; }
  Eigen::Map<Eigen::VectorXd> velocities() { return {data_->qvel, nv_}; }

  mjModel* model_ = nullptr;  // lives as long as the program
  mjData* data_ = nullptr;
  int nv_ = 0;
  Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor> jacobian_;
  Eigen::VectorXd force_, solution_, rate_, rate_sum_, acceleration_sum_;
};

MuJoCo& mujoco() {
  static MuJoCo instance;
  return instance;
}

void mass_matrix_and_hand_jacobian(benchmark::State& state) {
  Postures postures;
  measure(state, [&] {
    mujoco().set_posture(postures.next());
    mujoco().mass_matrix();
    mujoco().hand_jacobian();
    benchmark::ClobberMemory();
  });
}

void jump(benchmark::State& state) {
  Postures postures;
  const Vector6d F = wrench();
  measure(state, [&] {
    mujoco().set_posture(postures.next());
    benchmark::DoNotOptimize(mujoco().jump(F).data());
    benchmark::ClobberMemory();
  });
}

void forward_dynamics(benchmark::State& state) {
  Postures postures;
  const JointVectord phidot = joint_rates();
  measure(state, [&] {
    mujoco().set_posture(postures.next());
    benchmark::DoNotOptimize(mujoco().acceleration(phidot).data());
    benchmark::ClobberMemory();
  });
}

void rk4_step_without_control(benchmark::State& state) {
  int steps = 0;
  const PlantState start = moving_arm();
  measure(state, [&] {
    if (steps++ % 1000 == 0) mujoco().set_state(start);
    mujoco().rk4_step(kStep);
    benchmark::ClobberMemory();
  });
}

}  // namespace

/// Registers MuJoCo's rows; throws when it disagrees.
void register_mujoco() {
  const JointVectord phi = Postures().next();
  mujoco().set_posture(phi);
  PeerAnswers answers;
  answers.jump = mujoco().jump(wrench());
  answers.H = mujoco().full_mass_matrix();
  answers.acceleration = mujoco().acceleration(joint_rates());
  mujoco().set_state(moving_arm());
  mujoco().rk4_step(kStep);
  answers.step = mujoco().state();
  mujoco().set_state(state_at_rest({}, phi));
  require_agreement("MuJoCo", phi, answers);
  benchmark::RegisterBenchmark("mass_matrix_and_hand_jacobian/mujoco",
                               mass_matrix_and_hand_jacobian);
  benchmark::RegisterBenchmark("jump/mujoco", jump);
  benchmark::RegisterBenchmark("forward_dynamics/mujoco", forward_dynamics);
  benchmark::RegisterBenchmark("rk4_step_without_control/mujoco", rk4_step_without_control);
}

}  // namespace stillbase
