// The same robot in MuJoCo. Its functions are called one by one, so that nothing is timed that the
// result does not need (contacts, sensors, actuators).
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
    const Eigen::Quaterniond q(joint.R);
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
    mass_matrix();
    mj_factorM(model_, data_);
    mj_comVel(model_, data_);
    mj_rne(model_, data_, 0, force_.data());
    force_ = -force_;
    mj_solveM(model_, data_, solution_.data(), force_.data(), 1);
    return solution_;
  }

  Eigen::MatrixXd full_mass_matrix() {
    Eigen::MatrixXd H(nv_, nv_);
    mj_fullM(model_, H.data(), data_->qM);
    return H;
  }

 private:
  mjModel* model_ = nullptr;  // lives as long as the program
  mjData* data_ = nullptr;
  int nv_ = 0;
  Eigen::Matrix<double, 6, Eigen::Dynamic, Eigen::RowMajor> jacobian_;
  Eigen::VectorXd force_, solution_;
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

}  // namespace

/// Registers MuJoCo's rows; throws when it disagrees.
void register_mujoco() {
  const JointVectord phi = Postures().next();
  mujoco().set_posture(phi);
  PeerAnswers answers;
  answers.jump = mujoco().jump(wrench());
  answers.H = mujoco().full_mass_matrix();
  answers.acceleration = mujoco().acceleration(joint_rates());
  require_agreement("MuJoCo", phi, answers);
  benchmark::RegisterBenchmark("mass_matrix_and_hand_jacobian/mujoco",
                               mass_matrix_and_hand_jacobian);
  benchmark::RegisterBenchmark("jump/mujoco", jump);
  benchmark::RegisterBenchmark("forward_dynamics/mujoco", forward_dynamics);
}

}  // namespace stillbase
