#include "formulation/measures/direction_model.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include <stillbase/core/in_place.hpp>

#include "impact/direction_squares.hpp"

namespace stillbase {

namespace {

double positive_part(double x) { return std::max(x, 0.0); }

/// The response to no impulse.
ImpactResponse<double> no_response(const PostureImpact<double>& posture) {
  return {.F = Vector6d::Zero(),
          .d = {Vector6d::Zero(), JointVectord::Zero(posture.jacobian.J_phi.cols())},
          .total = Vector3d::Zero(),
          .base = Vector3d::Zero(),
          .hand_inverse_mass = 0,
          .held_momentum = Vector6d::Zero()};
}

}  // namespace

DirectionModel::DirectionModel(const CaptureProblem& p, const Formulation& formulation,
                               const Configuration& at)
    : DirectionModel(p, formulation, at, formulation.parts().jump,
                     formulation.parts().differenced) {}

DirectionModel::DirectionModel(const CaptureProblem& p, const Formulation& formulation,
                               const Configuration& at, const JumpObjective& jump,
                               const DifferencedTerms& terms)
    : problem(p),
      model(formulation.encounter_model()),
      differenced(terms),
      stop(formulation.simulations_stop()),
      configuration(at),
      jump_(jump) {
  const ImpactResistance& resistance = formulation.parts().model.resistance;
  move_to(formulation.encounter(at),
          evaluate_posture<double>(p.robot, resistance, configuration.phi));
}

void DirectionModel::move_to(const Encounter<double>& there, const PostureImpact<double>& posture) {
  encounter = there;
  if (model.is_rigid_contact()) {
    RigidContact<double> contact;
    set_rigid_contact<double>(model, encounter.contact, nominal_scenario(model), contact);
    const auto response = respond_to_contact<double>(posture, contact);
    whole_square = 0;
    for (const JumpObjective::Term& term : jump_.terms()) {
      *whole_square += JumpObjective::value(term, posture, response).squaredNorm();
    }
  }
  const ImpactResponse<double> none = no_response(posture);
  Vector6d moment = Vector6d::Zero();
  moment.tail<3>() = encounter.F.tail<3>();
  const ImpactResponse<double> unit[4] = {
      respond<double>(posture, Vector6d::Unit(0)), respond<double>(posture, Vector6d::Unit(1)),
      respond<double>(posture, Vector6d::Unit(2)),
      moment.isZero(0) ? none : respond<double>(posture, moment)};
  Eigen::Index size = 0;
  for (const JumpObjective::Term& term : jump_.terms()) {
    size += JumpObjective::value(term, posture, none).size();
  }
  Y.resize(size, 4);
  Eigen::Index first = 0;
  for (const JumpObjective::Term& term : jump_.terms()) {
    // What a term is worth without an impulse (1 for the impulse itself) is no image of a
    // direction: it counts once.
    const JointVectord constant = JumpObjective::value(term, posture, none);
    const Eigen::Index rows = constant.size();
    for (int i = 0; i < 4; ++i) {
      Y.col(i).segment(first, rows) = JumpObjective::value(term, posture, unit[i]);
      if (i < 3) Y.col(i).segment(first, rows) -= constant;
    }
    first += rows;
  }
  // Columns of W_h: velocities of the hand.
  for (int i = 0; i < 3; ++i) {
    const ImpactJump<double>& d = unit[i].d;
    W.col(i) = posture.jacobian.R_bh.topRows<3>() * d.Delta_Omega;
    W.col(i).noalias() += posture.jacobian.J_phi.topRows<3>() * d.Delta_phidot;
  }
  W = (W + W.transpose()).eval() / 2;
  const ContactKinematics<double>& contact = encounter.contact;
  add_target_inverse_inertia(model, contact, W);
  velocity = Matrix3d(contact.R_EB.transpose()) * contact.velocity_at(model.r);
  n = encounter.F.head<3>();
  half_angle = problem.uncertainty.cone_half_angle;
  planar = problem.uncertainty.cone_plane_normal.has_value();
  if (planar) {
    u = problem.uncertainty.cone_plane_normal->cross(n).normalized();
    v.setZero();
  } else {
    std::tie(u, v) = tangent_basis(n);
  }
}

Vector3d DirectionModel::direction(const Eigen::Vector2d& c) const {
  const double angle = c.norm();
  if (angle == 0) return n;
  return std::cos(angle) * n + std::sin(angle) / angle * (c[0] * u + c[1] * v);
}

Eigen::Vector2d DirectionModel::coordinates(const Vector3d& d) const {
  const Eigen::Vector2d side(d.dot(u), d.dot(v));
  const double sine = side.norm();
  if (sine == 0) return side;
  return project(side * (std::atan2(sine, d.dot(n)) / sine));
}

Eigen::Vector2d DirectionModel::project(Eigen::Vector2d c) const {
  if (planar) c[1] = 0;
  const double angle = c.norm();
  return angle > half_angle ? Eigen::Vector2d(c * (half_angle / angle)) : c;
}

double DirectionModel::closing_speed(const Vector3d& d) const {
  return model.follows_target() ? d.dot(velocity) : encounter.closing_speed;
}

double DirectionModel::magnitude(const Vector3d& d) const {
  if (model.magnitude_is_given()) return problem.impulse.magnitude;
  return (1 + problem.impulse.restitution) * positive_part(closing_speed(d)) / d.dot(W * d);
}

double DirectionModel::square(const Vector3d& d) const {
  if (whole_square) return *whole_square;
  const double p = magnitude(d);
  double sum = 0;
  for (Eigen::Index i = 0; i < Y.rows(); ++i) {
    const double y = p * (Y.row(i).head<3>().dot(d) + Y(i, 3));
    sum += y * y;
  }
  return sum;
}

double DirectionModel::other_square(const Vector3d& d, const StopCondition& until) const {
  if (whole_square) {
    const ImpactSummary impact = impact_at(problem, model, encounter, configuration.phi);
    return differenced.square(configuration, impact, until);
  }
  Vector6d F;
  F << d, encounter.F.tail<3>();
  const ImpactSummary impact = summarize_impact(
      problem.robot, configuration.phi, problem.resistance, magnitude(d) * F, closing_speed(d));
  return differenced.square(configuration, impact, until);
}

double DirectionModel::value(const Eigen::Vector2d& c) const {
  const Vector3d d = direction(c);
  if (is_linear()) return value_along(d);
  const bool is_predicted = c.isZero(0);
  if (!is_predicted && !is_complete()) return -kInfinity;
  const double sum = square(d) + other_square(d, is_predicted ? StopCondition{} : stop);
  return std::isnan(sum) && !is_complete() ? -kInfinity : std::sqrt(sum);
}

void DirectionModel::squares(const Eigen::MatrixX3d& directions,
                             std::vector<double>& squares) const {
  const Eigen::Index count = directions.rows();
  assert(is_linear() && count % DirectionSquares::kMostLanes == 0);
  if (whole_square) return squares.assign(static_cast<std::size_t>(count), *whole_square);
  squares.resize(static_cast<std::size_t>(count));
  Matrix3d basis;
  basis << n, u, v;
  constexpr int kUsual = 24;  // rows that need no heap
  InPlaceMatrix<double, kUsual> Y_here(Y);
  Y_here.leftCols<3>().noalias() = Y.leftCols<3>().lazyProduct(basis);
  const Matrix3d W_here = basis.transpose() * W * basis;
  const Vector3d velocity_here = basis.transpose() * velocity;
  DirectionSquares asked{
      .count = count,
      .d = {directions.col(0).data(), directions.col(1).data(), directions.col(2).data()},
      .rows = Y.rows(),
      .Y = Y_here.data(),
      .p = problem.impulse.magnitude,
      .speed_of_d = nullptr,
      .W = nullptr,
      .squares = squares.data()};
  if (!model.magnitude_is_given()) {
    asked.p = 1 + problem.impulse.restitution;
    asked.W = W_here.data();
    if (model.follows_target()) {
      asked.speed_of_d = velocity_here.data();
    } else {
      asked.p *= positive_part(encounter.closing_speed);
    }
  }
  find_direction_squares(asked);
}

bool DirectionModel::log_derivatives(const Vector3d& d, Vector3d& gradient,
                                     Matrix3d& hessian) const {
  if (!is_linear() || whole_square) return false;
  gradient.setZero();
  hessian.setZero();
  // + weight ln x, x with gradient g and Hessian H.
  const auto add = [&](double weight, double x, const Vector3d& g, const Matrix3d& H) {
    gradient += weight / x * g;
    hessian += weight / x * H - weight / (x * x) * (g * g.transpose());
  };
  if (!model.magnitude_is_given()) {
    if (model.follows_target()) {
      const double speed = d.dot(velocity);
      if (!(speed > 0)) return false;
      add(2, speed, velocity, Matrix3d::Zero());
    }
    const Matrix3d twice = W + W.transpose();
    add(-2, d.dot(W * d), twice * d, twice);
  }
  double square = 0;
  Vector3d slope = Vector3d::Zero();
  Matrix3d bend = Matrix3d::Zero();
  for (Eigen::Index i = 0; i < Y.rows(); ++i) {
    const Vector3d row = Y.row(i).head<3>().transpose();
    const double y = row.dot(d) + Y(i, 3);
    square += y * y;
    slope += 2 * y * row;
    bend += 2 * row * row.transpose();
  }
  if (!(square > 0)) return false;
  add(1, square, slope, bend);
  return gradient.allFinite() && hessian.allFinite();
}

}  // namespace stillbase
