#include <stillbase/capture/robust.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include <stillbase/impact/contact.hpp>

#include "capture/formulation_parts.hpp"

namespace stillbase {

namespace {

/// |y| as a function of the direction at one posture: y and W_h are linear and quadratic in it, so
/// a direction costs a few small products.
struct DirectionModel {
  const CaptureProblem* problem;
  Encounter encounter;
  Matrix3d Y;         ///< quantity per unit force
  Vector3d y_moment;  ///< quantity per unit of impulse from the stated moment
  Matrix3d W;         ///< hand velocity per unit force
  Vector3d n, u, v;   ///< predicted direction and tangents
  double half_angle = 0;
  bool planar = false;

  DirectionModel(const CaptureProblem& p, const Formulation& formulation,
                 const Configuration& configuration)
      : problem(&p), encounter(formulation.encounter(configuration)) {
    const ImpactResistance resistance = prepare_resistance(p.resistance, p.robot.n());
    const auto posture = evaluate_posture<double>(p.robot, resistance, configuration.phi);
    for (int i = 0; i < 3; ++i) {
      Y.col(i) = objective_quantity(p.objective, respond<double>(posture, Vector6d::Unit(i)));
    }
    Vector6d moment = Vector6d::Zero();
    moment.tail<3>() = encounter.F.tail<3>();
    y_moment = objective_quantity(p.objective, respond<double>(posture, moment));
    W = extended_inverse_inertia(posture.factor, posture.jacobian).topLeftCorner<3, 3>();
    n = encounter.F.head<3>();
    half_angle = p.uncertainty.cone_half_angle;
    planar = p.uncertainty.cone_plane_normal.has_value();
    if (planar) {
      u = p.uncertainty.cone_plane_normal->cross(n).normalized();
      v.setZero();
    } else {
      std::tie(u, v) = tangent_basis(n);
    }
  }

  /// Direction at angle |c| from n towards (c_1, c_2).
  Vector3d direction(const Eigen::Vector2d& c) const {
    const double angle = c.norm();
    if (angle == 0) return n;
    return std::cos(angle) * n + std::sin(angle) / angle * (c[0] * u + c[1] * v);
  }

  double value(const Vector3d& d) const {
    Encounter here = encounter;
    if (!here.speed_stated) here.closing_speed = d.dot(here.velocity);
    const Vector3d lever = here.r.cross(d);
    here.target_inverse_mass =
        1 / here.target_mass + lever.dot(here.target_inverse_inertia * lever);
    const double p = impulse_magnitude(*problem, here, d.dot(W * d));
    return p * (Y * d + y_moment).norm();
  }

  Eigen::Vector2d project(Eigen::Vector2d c) const {
    if (planar) c[1] = 0;
    const double angle = c.norm();
    return angle > half_angle ? Eigen::Vector2d(c * (half_angle / angle)) : c;
  }
};

}  // namespace

WorstCase worst_case(const CaptureProblem& problem, const Formulation& formulation,
                     const Configuration& configuration) {
  const DirectionModel model(problem, formulation, configuration);
  struct Place {
    Eigen::Vector2d c;
    double value;
  };
  std::vector<Place> places;
  const auto add = [&](const Eigen::Vector2d& c) {
    places.push_back({c, model.value(model.direction(c))});
  };
  add(Eigen::Vector2d::Zero());
  const double alpha = model.half_angle;
  if (alpha > 0) {
    constexpr int kRings = 12;
    constexpr int kSpokes = 36;
    for (int ring = 1; ring <= kRings; ++ring) {
      const double radius = alpha * ring / kRings;
      if (model.planar) {
        // Both sides; twice as fine, since a wedge is one-dimensional.
        for (const double c : {radius, -radius, radius - alpha / 24, alpha / 24 - radius}) {
          add({c, 0});
        }
        continue;
      }
      for (int spoke = 0; spoke < kSpokes; ++spoke) {
        const double angle = 2 * M_PI * spoke / kSpokes;
        add({radius * std::cos(angle), radius * std::sin(angle)});
      }
    }
  }
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.value > b.value; });

  WorstCase out;
  const std::size_t refined = std::min<std::size_t>(places.size(), 5);
  for (std::size_t i = 0; i < refined; ++i) {
    Place place = places[i];
    for (double step = alpha / 12; step > 1e-10; step /= 2) {
      bool moved = true;
      while (moved) {
        moved = false;
        for (int direction = 0; direction < 8; ++direction) {
          const double angle = M_PI / 4 * direction;
          const Eigen::Vector2d c =
              model.project(place.c + step * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
          const double value = model.value(model.direction(c));
          if (value > place.value * (1 + 1e-14)) {
            place = {c, value};
            moved = true;
          }
        }
      }
    }
    if (place.value > out.value || i == 0) out = {place.value, model.direction(place.c)};
  }
  return out;
}

double nominal_value(const CaptureProblem& problem, const Formulation& formulation,
                     const Configuration& configuration) {
  const DirectionModel model(problem, formulation, configuration);
  return model.value(model.n);
}

}  // namespace stillbase
