// What lower bounds are checked against.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include <stillbase/reference/reference.hpp>

#include "proof/minimum_problem.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {

/// |y|^2 after every impulse, at one posture, by the second implementation of the dynamics.
inline std::vector<double> squares_at(const proof::MinimumProblem& problem,
                                      const Eigen::VectorXd& phi) {
  const reference::Dynamics at = reference::compute(problem.where.robot, {phi, {}, {}});
  std::vector<double> squares;
  for (const proof::ImpulseCase& impulse : problem.impulses) {
    const auto unit =
        reference::impact(at, problem.where.added_inertia, problem.where.locked, impulse.F);
    // F' W_h F is twice the energy that a unit of impulse brings in.
    Eigen::VectorXd rates(6 + unit.Delta_phidot.size());
    rates << unit.Delta_Omega, unit.Delta_phidot;
    const double inverse_mass =
        rates.dot(at.H * rates) + problem.where.added_inertia.dot(unit.Delta_phidot.cwiseAbs2());
    const double p = impulse.numerator / (inverse_mass + *impulse.target_inverse_mass);
    double sum = 0;
    for (const ObjectiveTerm& term : problem.objective) {
      Eigen::VectorXd y;
      switch (term.quantity) {
        case ObjectiveQuantity::BaseAngularMomentum:
          y = unit.base;
          break;
        case ObjectiveQuantity::BaseAngularVelocity:
          y = unit.Delta_Omega.tail<3>();
          break;
        case ObjectiveQuantity::TotalAngularMomentum:
          y = unit.total;
          break;
        case ObjectiveQuantity::BaseMomentum:
          y = at.H.topLeftCorner<6, 6>() * unit.Delta_Omega;
          y.tail<3>() /= term.length;
          break;
        case ObjectiveQuantity::ImpulseMagnitude:
          y = Eigen::VectorXd::Ones(1);
          break;
        case ObjectiveQuantity::JointRateNorm:
          y = unit.Delta_phidot;
          break;
        case ObjectiveQuantity::BaseEnergy: {
          const Body& base = problem.where.robot.base;
          const Vector3d v = unit.Delta_Omega.head<3>(), omega = unit.Delta_Omega.tail<3>();
          const double energy = (base.mass * v.dot(v) + omega.dot(base.inertia * omega)) / 2;
          y = Eigen::VectorXd::Constant(1, std::sqrt(energy * term.size));  // a square: E / size
          break;
        }
        default:
          throw std::logic_error("no formula here");
      }
      sum += (p * y / term.size).squaredNorm();
    }
    squares.push_back(sum);
  }
  return squares;
}

/// What is bounded. Impulses weigh alike.
inline double value_at(const proof::MinimumProblem& problem, const Eigen::VectorXd& phi) {
  std::vector<double> squares = squares_at(problem, phi);
  std::sort(squares.begin(), squares.end(), std::greater<>());
  double left = 1;  // of the worst ones, as many samples
  if (problem.measure == RiskMeasure::Expectation) left = static_cast<double>(squares.size());
  if (problem.measure == RiskMeasure::Cvar) {
    left = static_cast<double>(squares.size()) * (1 - problem.cvar_level);
  }
  const double count = left;
  double sum = 0;
  for (const double square : squares) {
    sum += std::min(left, 1.0) * square / count;
    left -= std::min(left, 1.0);
  }
  return std::sqrt(sum);
}

}  // namespace stillbase
