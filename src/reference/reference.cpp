#include <stillbase/reference/reference.hpp>

#include <cassert>
#include <cmath>

// Assumptions: rigid bodies, a tree with parents before children, everything in base frame B.
// Not written for speed, and without any code of the other implementation of the dynamics.

namespace stillbase::reference {
namespace {

using Eigen::Matrix3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

// A frame that moves with the joints: pose in B and velocity relative to B.
struct MovingFrame {
  Matrix3d R = Matrix3d::Identity();
  Vector3d o = Vector3d::Zero();
  Vector3d o_rate = Vector3d::Zero();
  Vector3d rate = Vector3d::Zero();  // angular velocity relative to B

  Vector3d point(const Vector3d& local) const { return o + R * local; }
  Vector3d point_rate(const Vector3d& local) const { return o_rate + rate.cross(R * local); }
};

Matrix3d cross_matrix(const Vector3d& a) {
  Matrix3d m;
  m << 0, -a(2), a(1), a(2), 0, -a(0), -a(1), a(0), 0;
  return m;
}

// Rotation about z by angle.
Matrix3d rotation_about_z(double angle) {
  Matrix3d m = Matrix3d::Identity();
  m(0, 0) = m(1, 1) = std::cos(angle);
  m(1, 0) = std::sin(angle);
  m(0, 1) = -m(1, 0);
  return m;
}

// [Omega; rates of the bodies' joints] = G [Omega; phidot].
MatrixXd coupling_matrix(const RobotModel& robot) {
  const int bodies = robot.num_bodies();
  MatrixXd G = MatrixXd::Zero(6 + bodies, 6 + robot.n());
  G.topLeftCorner(6, 6).setIdentity();
  for (int k = 0; k < bodies; ++k) {
    G(6 + k, 6 + robot.couplings[k].joint) = robot.couplings[k].ratio;
  }
  return G;
}

// Positions of the bodies' joints.
VectorXd body_positions(const RobotModel& robot, const VectorXd& phi) {
  if (!robot.is_coupled()) return phi;
  VectorXd all(robot.num_bodies());
  for (int k = 0; k < robot.num_bodies(); ++k) {
    const Coupling& coupling = robot.couplings[k];
    all(k) = coupling.ratio * phi(coupling.joint) + coupling.offset;
  }
  return all;
}

std::vector<MovingFrame> body_frames(const RobotModel& robot, const VectorXd& joint_positions,
                                     const VectorXd& joint_rates) {
  const VectorXd phi = body_positions(robot, joint_positions);
  VectorXd phidot = joint_rates;
  if (robot.is_coupled()) {
    phidot = coupling_matrix(robot).bottomRightCorner(robot.num_bodies(), robot.n()) * joint_rates;
  }
  std::vector<MovingFrame> frames;
  for (int k = 0; k < robot.num_bodies(); ++k) {
    const Joint& joint = robot.tree()[k];
    const MovingFrame parent = joint.parent == kBase ? MovingFrame{} : frames[joint.parent];
    const Matrix3d R0 = parent.R * joint.R.matrix();
    const Vector3d z = R0.col(2);
    MovingFrame frame;
    if (joint.is_prismatic()) {
      frame.R = R0;
      frame.o = parent.point(joint.p) + z * phi(k);
      frame.rate = parent.rate;
      frame.o_rate = parent.point_rate(joint.p) + parent.rate.cross(z) * phi(k) + z * phidot(k);
    } else {
      frame.R = R0 * rotation_about_z(phi(k));
      frame.o = parent.point(joint.p);
      frame.rate = parent.rate + z * phidot(k);
      frame.o_rate = parent.point_rate(joint.p);
    }
    frames.push_back(frame);
  }
  return frames;
}

// Velocity of a point of a body in B components, [linear; angular] = J [Omega; phidot], and the
// derivative of J along the motion.
struct PointJacobian {
  MatrixXd J, J_rate;
};

PointJacobian point_jacobian(const RobotModel& robot, const std::vector<MovingFrame>& frames,
                             int body, const Vector3d& point, const Vector3d& point_rate) {
  const int n = robot.num_bodies();
  PointJacobian result{MatrixXd::Zero(6, 6 + n), MatrixXd::Zero(6, 6 + n)};
  result.J.block<3, 3>(0, 0).setIdentity();
  result.J.block<3, 3>(0, 3) = -cross_matrix(point);
  result.J.block<3, 3>(3, 3).setIdentity();
  result.J_rate.block<3, 3>(0, 3) = -cross_matrix(point_rate);
  for (int k = body; k != kBase; k = robot.tree()[k].parent) {
    const MovingFrame& frame = frames[k];
    const Vector3d z = frame.R.col(2);
    const Vector3d z_rate = frame.rate.cross(z);
    if (robot.tree()[k].is_prismatic()) {
      result.J.block<3, 1>(0, 6 + k) = z;
      result.J_rate.block<3, 1>(0, 6 + k) = z_rate;
    } else {
      const Vector3d arm = point - frame.o;
      const Vector3d arm_rate = point_rate - frame.o_rate;
      result.J.block<3, 1>(0, 6 + k) = z.cross(arm);
      result.J.block<3, 1>(3, 6 + k) = z;
      result.J_rate.block<3, 1>(0, 6 + k) = z_rate.cross(arm) + z.cross(arm_rate);
      result.J_rate.block<3, 1>(3, 6 + k) = z_rate;
    }
  }
  if (robot.is_coupled()) {
    const MatrixXd G = coupling_matrix(robot);
    result.J = (result.J * G).eval();
    result.J_rate = (result.J_rate * G).eval();
  }
  return result;
}

VectorXd or_zero(const VectorXd& x, int n) {
  assert(x.size() == 0 || x.size() == n);
  return x.size() == 0 ? VectorXd::Zero(n) : x;
}

}  // namespace

std::vector<Pose> body_poses(const RobotModel& robot, const Eigen::VectorXd& phi) {
  assert(phi.size() == robot.n());
  std::vector<Pose> poses;
  for (const MovingFrame& frame : body_frames(robot, phi, VectorXd::Zero(phi.size()))) {
    poses.push_back({frame.o, Eigen::Quaterniond(frame.R)});
  }
  return poses;
}

Dynamics compute(const RobotModel& robot, const State& state) {
  const int n = robot.n();
  assert(state.phi.size() == n);
  const VectorXd phidot = or_zero(state.phidot, n);
  VectorXd x(6 + n);
  x << state.Omega, phidot;
  const Vector3d omega = state.Omega.tail<3>();
  const std::vector<MovingFrame> frames = body_frames(robot, state.phi, phidot);

  struct Part {
    double mass;
    Vector3d centroid;
    Matrix3d inertia;  // about its centroid, B axes
    PointJacobian jacobian;
  };
  std::vector<Part> parts;
  for (int k = kBase; k < robot.num_bodies(); ++k) {
    const Body& body = k == kBase ? robot.base : robot.bodies[k];
    const MovingFrame frame = k == kBase ? MovingFrame{} : frames[k];
    const Vector3d centroid = frame.point(body.centroid);
    parts.push_back({body.mass, centroid, frame.R * body.inertia * frame.R.transpose(),
                     point_jacobian(robot, frames, k, centroid, frame.point_rate(body.centroid))});
  }

  Dynamics d;
  d.centroid.setZero();
  for (const Part& part : parts) {
    d.mass += part.mass;
    d.centroid += part.mass * part.centroid;
  }
  d.centroid /= d.mass;

  d.H = MatrixXd::Zero(6 + n, 6 + n);
  d.c = VectorXd::Zero(6 + n);
  d.P.setZero();
  d.L_g.setZero();
  d.Htilde_omega.setZero();
  d.Htilde_omegaphi = MatrixXd::Zero(3, n);
  for (const Part& part : parts) {
    const MatrixXd J_v = part.jacobian.J.topRows(3), J_w = part.jacobian.J.bottomRows(3);
    d.H += part.mass * J_v.transpose() * J_v + J_w.transpose() * part.inertia * J_w;

    // The columns of J are components in B, which rotates: the acceleration has a transport term.
    const Vector3d v = J_v * x, w = J_w * x;
    const Vector3d a = part.jacobian.J_rate.topRows(3) * x + omega.cross(v);
    const Vector3d alpha = part.jacobian.J_rate.bottomRows(3) * x + omega.cross(w);
    const Vector3d moment = part.inertia * alpha + w.cross(part.inertia * w);
    d.c += J_v.transpose() * (part.mass * a) + J_w.transpose() * moment;

    // About the system centroid: momenta of the locked robot and of the joints alone.
    const Matrix3d arm = cross_matrix(part.centroid - d.centroid);
    d.P += part.mass * v;
    d.L_g += part.inertia * w + part.mass * arm * v;
    d.Htilde_omega += part.inertia - part.mass * arm * arm;
    d.Htilde_omegaphi += part.inertia * J_w.rightCols(n) + part.mass * arm * J_v.rightCols(n);
  }

  // Rotors spin relative to their links alone: T = 1/2 sum I_r (gear_ratio rate)^2.
  VectorXd rotors = VectorXd::Zero(6 + robot.num_bodies());
  for (int k = 0; k < robot.num_bodies(); ++k) {
    const Joint& joint = robot.tree()[k];
    rotors(6 + k) = joint.rotor_inertia * joint.gear_ratio * joint.gear_ratio;
  }
  if (robot.is_coupled()) {
    const MatrixXd G = coupling_matrix(robot);
    d.H += G.transpose() * rotors.asDiagonal() * G;
  } else {
    d.H.diagonal() += rotors;
  }

  const MovingFrame hand_frame = robot.hand_body == kBase ? MovingFrame{} : frames[robot.hand_body];
  d.hand_position = hand_frame.point(robot.p_hand);
  d.hand_rotation = hand_frame.R * robot.R_hand;
  d.J = point_jacobian(robot, frames, robot.hand_body, d.hand_position,
                       hand_frame.point_rate(robot.p_hand))
            .J;
  return d;
}

MatrixXd solve_definite(const MatrixXd& A, const MatrixXd& B) { return A.ldlt().solve(B); }

namespace {

// Solves H x = b where locked joints keep x = 0: their rows become x_k = 0, their columns drop out.
VectorXd solve_free(MatrixXd H, const std::vector<bool>& locked, VectorXd b) {
  for (std::size_t k = 0; k < locked.size(); ++k) {
    if (!locked[k]) continue;
    const auto row = static_cast<Eigen::Index>(6 + k);
    H.row(row).setZero();
    H.col(row).setZero();
    H(row, row) = 1;
    b(row) = 0;
  }
  return solve_definite(H, b);
}

}  // namespace

Impact impact(const Dynamics& dynamics, const Eigen::VectorXd& added_inertia,
              const std::vector<bool>& locked, const Eigen::Matrix<double, 6, 1>& Fbar) {
  const auto n = dynamics.H.rows() - 6;
  assert(added_inertia.size() == 0 || added_inertia.size() == n);
  assert(locked.empty() || static_cast<Eigen::Index>(locked.size()) == n);
  MatrixXd H = dynamics.H;
  if (added_inertia.size() != 0) H.diagonal().tail(n) += added_inertia;

  const VectorXd x = solve_free(H, locked, dynamics.J.transpose() * Fbar);
  Impact result;
  result.Delta_Omega = x.head<6>();
  result.Delta_phidot = x.tail(n);
  const Vector3d f = Fbar.head<3>(), t = Fbar.tail<3>();
  result.total = (dynamics.hand_position - dynamics.centroid).cross(f) + t;
  result.base = dynamics.Htilde_omega * result.Delta_Omega.tail<3>();
  result.coupling = dynamics.Htilde_omegaphi * result.Delta_phidot;
  if (f.squaredNorm() > 0) {
    const VectorXd push = dynamics.J.topRows(3).transpose() * f;
    result.hand_inverse_mass = push.dot(solve_free(H, locked, push)) / f.squaredNorm();
  }
  return result;
}

Eigen::Matrix<double, 6, 6> centroid_from_hand(const MetBody& body) {
  Eigen::Matrix<double, 6, 6> T = Eigen::Matrix<double, 6, 6>::Identity();
  T.topRightCorner<3, 3>() = cross_matrix(body.r);
  return T;
}

Eigen::Matrix<double, 6, 1> impulse_that_joins(const Dynamics& dynamics,
                                               const Eigen::VectorXd& added_inertia,
                                               const std::vector<bool>& locked, const MetBody& body,
                                               bool is_held) {
  const Eigen::Index n = dynamics.H.rows() - 6, rows = is_held ? 6 : 3;
  const bool turns = !body.inertia.isZero(0);
  const Eigen::Index own = turns ? 6 : 3;  // velocities of the body
  MatrixXd H = dynamics.H, J = dynamics.J.topRows(rows);
  if (added_inertia.size() != 0) H.diagonal().tail(n) += added_inertia;
  for (std::size_t k = 0; k < locked.size(); ++k) {
    if (!locked[k]) continue;
    const auto at = static_cast<Eigen::Index>(6 + k);
    H.row(at).setZero();
    H.col(at).setZero();
    H(at, at) = 1;
    J.col(at).setZero();
  }
  // Velocity of the body's point at the hand per twist of the body.
  const MatrixXd to_hand = centroid_from_hand(body).inverse().topLeftCorner(rows, own);
  MatrixXd M = MatrixXd::Zero(own, own);
  M.topLeftCorner(3, 3) = body.mass * Matrix3d::Identity();
  if (turns) M.bottomRightCorner(3, 3) = body.inertia;
  VectorXd before(own);
  before.head(3) = body.velocity;
  if (turns) before.tail(3) = body.omega;

  // H x = J' F, M (y - y0) = -T' F, J x = T y.
  const Eigen::Index robot = H.rows(), all = robot + own + rows;
  MatrixXd K = MatrixXd::Zero(all, all);
  K.topLeftCorner(robot, robot) = H;
  K.block(robot, robot, own, own) = M;
  K.bottomLeftCorner(rows, robot) = J;
  K.block(robot + own, robot, rows, own) = -to_hand;
  K.topRightCorner(robot, rows) = -J.transpose();
  K.block(robot, robot + own, own, rows) = to_hand.transpose();
  VectorXd right = VectorXd::Zero(all);
  right.segment(robot, own) = M * before;
  Eigen::Matrix<double, 6, 1> F = Eigen::Matrix<double, 6, 1>::Zero();
  F.head(rows) = VectorXd(K.fullPivLu().solve(right)).tail(rows);
  return F;
}

}  // namespace stillbase::reference
