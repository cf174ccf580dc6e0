#include "formulation/measures/residual.hpp"

#include <algorithm>
#include <cmath>

#include "formulation/formulation_parts.hpp"
#include "formulation/measures/ball_maximum.hpp"

namespace stillbase {

namespace {

/// y = offset + slope s over the ellipsoid, |s| <= 1, without the objective's unit.
struct VelocityModel {
  Eigen::VectorXd offset;
  Eigen::Matrix<double, Eigen::Dynamic, 6> slope;

  VelocityModel(const CaptureProblem& problem, const Formulation& formulation,
                const Configuration& configuration) {
    const Formulation::Parts& parts = formulation.parts();
    const CaptureModel& model = parts.model;
    const auto at = model.place<double>(formulation.variables(configuration));
    const auto posture = model.posture(at);
    const auto y = [&](const Scenario& scenario) {
      const auto impact = model.impact(at, posture, scenario);
      Eigen::VectorXd out(0);
      for (const JumpObjective::Term& term : parts.jump.terms()) {
        const JointVectord value = JumpObjective::value(term, posture, impact.response);
        out.conservativeResize(out.size() + value.size());
        out.tail(value.size()) = impact.p * value;
      }
      return out;
    };
    // The mean of opposite errors is the nominal velocity, also where it separates.
    const double k = problem.uncertainty.residual_velocity->deviations;
    Scenario scenario = model.nominal;
    for (int i = 0; i < 6; ++i) {
      scenario.velocity_error = k * Vector6d::Unit(i);
      const Eigen::VectorXd plus = y(scenario);
      scenario.velocity_error = -k * Vector6d::Unit(i);
      const Eigen::VectorXd minus = y(scenario);
      if (i == 0) {
        offset = (plus + minus) / 2;
        slope.resize(plus.size(), 6);
      }
      slope.col(i) = (plus - minus) / 2;
    }
  }

  double length(const Vector6d& s) const { return (offset + slope * s).norm(); }
  std::vector<Vector6d> maxima() const {
    return maxima_over_ball(slope.transpose() * slope, slope.transpose() * offset);
  }
};

ConeMaximum maximum_at(const CaptureProblem& problem, const Formulation& formulation,
                       const VelocityModel& model, const Vector6d& s) {
  ConeMaximum out{formulation.nominal_scenario(),
                  formulation.objective_power().value(model.length(s))};
  out.scenario.velocity_error = problem.uncertainty.residual_velocity->deviations * s;
  return out;
}

Scenario nominal_of(const CaptureProblem& problem) { return rim_scenarios(problem, 0).front(); }

}  // namespace

bool has_residual(const CaptureProblem& problem) {
  return problem.uncertainty.residual_velocity.has_value();
}

std::vector<Scenario> mean_scenarios(const CaptureProblem& problem) {
  if (!has_residual(problem)) return draw_scenarios(problem);
  std::vector<Scenario> out(7, nominal_of(problem));
  for (std::size_t j = 0; j < out.size(); ++j) {
    // Columns of the orthogonal matrix by Helmert without its constant row, times sqrt(7).
    for (int i = 0; i < 6; ++i) {
      const double order = i + 1, row = std::sqrt(7 / (order * (order + 1)));
      const auto column = static_cast<double>(j);
      out[j].velocity_error[i] = column < order ? row : column == order ? -order * row : 0;
    }
    out[j].weight = 1. / 7;
  }
  return out;
}

std::vector<Scenario> outer_scenarios(const CaptureProblem& problem, int count) {
  if (!has_residual(problem)) return rim_scenarios(problem, count);
  std::vector<Scenario> out = {nominal_of(problem)};
  for (int i = 0; i < 6; ++i) {
    for (const double sign : {1.0, -1.0}) {
      out.push_back(out.front());
      out.back().velocity_error =
          sign * problem.uncertainty.residual_velocity->deviations * Vector6d::Unit(i);
    }
  }
  return out;
}

std::vector<ConeMaximum> ellipsoid_maxima(const CaptureProblem& problem,
                                          const Formulation& formulation,
                                          const Configuration& configuration) {
  const VelocityModel model(problem, formulation, configuration);
  std::vector<ConeMaximum> out;
  for (const Vector6d& s : model.maxima()) {
    out.push_back(maximum_at(problem, formulation, model, s));
  }
  return out;
}

ResidualSummary summarize_residual(const CaptureProblem& problem, const Formulation& formulation,
                                   const Configuration& configuration) {
  const CaptureModel& model = formulation.parts().model;
  const auto at = model.place<double>(formulation.variables(configuration));
  const ContactKinematics<double>& contact = at.contact;
  const Matrix3d R_BE = contact.R_EB.transpose();
  Matrix6d turn = Matrix6d::Zero();
  turn.topLeftCorner<3, 3>() = turn.bottomRightCorner<3, 3>() = R_BE;
  const Matrix6d root = turn * model.residual->at(at.time);

  ResidualSummary out;
  out.velocity << R_BE * contact.velocity_at(model.encounter.r), R_BE * contact.omega;
  if (model.encounter.hand_moves()) {
    out.velocity -= model.impact(at, model.posture(at), model.nominal).rigid.before.V;
  }
  out.covariance = root * root.transpose();
  out.deviations = problem.uncertainty.residual_velocity->deviations;
  const VelocityModel velocity(problem, formulation, configuration);
  out.worst_velocity = out.velocity + out.deviations * root * velocity.maxima().front();
  // A latch that moves along has hold of the target whichever way it drifts.
  if (model.encounter.hand_moves() && model.encounter.law == ContactLaw::Latch) return out;
  // The normal component is Gaussian.
  const Vector3d n = R_BE * model.encounter.n;
  const double mean = n.dot(out.velocity.head<3>());
  const double deviation = std::sqrt(n.dot(out.covariance.topLeftCorner<3, 3>() * n));
  out.separating =
      deviation > 0 ? std::erfc(mean / (std::sqrt(2.0) * deviation)) / 2 : (mean > 0 ? 0 : 1);
  return out;
}

std::vector<ConeMaximum> climb_ellipsoid(const CaptureProblem& problem,
                                         const Formulation& formulation,
                                         const Configuration& configuration,
                                         const std::vector<Scenario>& from) {
  const VelocityModel model(problem, formulation, configuration);
  const std::vector<Vector6d> maxima = model.maxima();
  std::vector<ConeMaximum> out;
  for (const Scenario& scenario : from) {
    const auto nearest = std::max_element(
        maxima.begin(), maxima.end(), [&scenario](const Vector6d& a, const Vector6d& b) {
          return a.dot(scenario.velocity_error) < b.dot(scenario.velocity_error);
        });
    out.push_back(maximum_at(problem, formulation, model, *nearest));
  }
  return out;
}

}  // namespace stillbase
