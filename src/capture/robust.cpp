#include <stillbase/capture/robust.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include <stillbase/impact/contact.hpp>

#include "capture/formulation_kernel.hpp"

namespace stillbase {

namespace {

/// |y| as a function of the direction at one posture: y and W_h are linear and quadratic in it, so
/// a direction costs a few small products.
struct DirectionModel {
  static constexpr int kMaxRows = 3 + 3 + 3 + 6 + 1 + kMaxJoints;  // one term of each quantity

  const CaptureProblem* problem;
  Encounter encounter;
  /// y = p Y [d; 1]: all terms below each other, and what a stated moment adds.
  Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::ColMajor, kMaxRows, 4> Y;
  Matrix3d W;        ///< d' W d: inverse mass of hand and target together
  Vector3d n, u, v;  ///< predicted direction and tangents
  double half_angle = 0;
  bool planar = false;
  // For terms of the user, which may be any function of the direction.
  const std::vector<UserTerm>* user_terms;
  Configuration configuration;

  DirectionModel(const CaptureProblem& p, const Formulation& formulation, const Configuration& at)
      : problem(&p),
        encounter(formulation.encounter(at)),
        user_terms(&formulation.user_terms()),
        configuration(at) {
    const ImpactResistance resistance = prepare_resistance(p.resistance, p.robot.n());
    const auto posture = evaluate_posture<double>(p.robot, resistance, configuration.phi);
    Vector6d moment = Vector6d::Zero();
    moment.tail<3>() = encounter.F.tail<3>();
    ImpactResponse<double> unit[4] = {
        respond<double>(posture, Vector6d::Unit(0)), respond<double>(posture, Vector6d::Unit(1)),
        respond<double>(posture, Vector6d::Unit(2)), respond<double>(posture, moment)};
    Y.resize(0, 4);
    for (const ObjectiveTerm& term : p.objective) {
      JointVectord y[4];
      for (int i = 0; i < 4; ++i) y[i] = term_quantity<double>(term, posture, unit[i]);
      // The impulse itself is no linear image of the direction: 1 per unit, whatever it is.
      if (term.quantity == ObjectiveQuantity::ImpulseMagnitude) {
        for (int i = 0; i < 3; ++i) y[i].setZero();
      }
      const Eigen::Index first = Y.rows();
      Y.conservativeResize(first + y[0].size(), 4);
      for (int i = 0; i < 4; ++i) Y.col(i).tail(y[i].size()) = y[i];
    }
    W = extended_inverse_inertia(posture.factor, posture.jacobian).topLeftCorner<3, 3>();
    const Matrix3d lever = skew<double>(encounter.r);
    W += lever.transpose() * encounter.target_inverse_inertia * lever;
    W.diagonal().array() += 1 / encounter.target_mass;
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

  /// The inverse of direction(), inside the cone.
  Eigen::Vector2d coordinates(const Vector3d& d) const {
    const Eigen::Vector2d side(d.dot(u), d.dot(v));
    const double sine = side.norm();
    if (sine == 0) return side;
    return project(side * (std::atan2(sine, d.dot(n)) / sine));
  }

  double value(const Eigen::Vector2d& c) const {
    const Vector3d d = direction(c);
    const double speed =
        encounter.speed_stated ? encounter.closing_speed : d.dot(encounter.velocity);
    const double p = encounter.magnitude_given
                         ? problem->impulse.magnitude
                         : normal_impulse(problem->impulse.restitution, speed, d.dot(W * d), 0);
    const Eigen::Vector4d d1(d.x(), d.y(), d.z(), 1);
    double square = 0;
    for (Eigen::Index i = 0; i < Y.rows(); ++i) square += std::pow(p * Y.row(i).dot(d1), 2);
    for (const UserTerm& term : *user_terms) square += user_square(term, p, d, speed);
    return std::sqrt(square);
  }

  double user_square(const UserTerm& term, double p, const Vector3d& d, double speed) const {
    Vector6d F;
    F << d, encounter.F.tail<3>();
    const ImpactSummary impact =
        summarize_impact(problem->robot, configuration.phi, problem->resistance, p * F, speed);
    return std::pow(term.value(configuration, impact) / term.size, 2);
  }

  Eigen::Vector2d project(Eigen::Vector2d c) const {
    if (planar) c[1] = 0;
    const double angle = c.norm();
    return angle > half_angle ? Eigen::Vector2d(c * (half_angle / angle)) : c;
  }
};

/// A place in the cone and its |y|.
struct Place {
  Eigen::Vector2d c;
  double value;
};

/// Rings about the predicted direction, or a row in the wedge.
std::vector<Place> scan(const DirectionModel& model) {
  constexpr int kRings = 12;
  constexpr int kSpokes = 36;
  constexpr int kRow = 97;  // a wedge is one-dimensional: finer for less
  const double alpha = model.half_angle;
  std::vector<Place> places;
  const auto add = [&](const Eigen::Vector2d& c) { places.push_back({c, model.value(c)}); };
  add(Eigen::Vector2d::Zero());
  if (!(alpha > 0)) return places;
  if (model.planar) {
    for (int i = 0; i < kRow; ++i) add({alpha * (2.0 * i / (kRow - 1) - 1), 0});
    return places;
  }
  for (int ring = 1; ring <= kRings; ++ring) {
    const double radius = alpha * ring / kRings;
    for (int spoke = 0; spoke < kSpokes; ++spoke) {
      const double angle = 2 * M_PI * spoke / kSpokes;
      add({radius * std::cos(angle), radius * std::sin(angle)});
    }
  }
  return places;
}

/// Compass search for the maximum that a place belongs to. The value is flat there: a step of 1e-8
/// rad leaves an error of about 1e-16.
Place refine(const DirectionModel& model, Place place) {
  const int compass = model.planar ? 2 : 8;
  for (double step = model.half_angle / 12; step > 1e-9; step /= 3) {
    bool moved = true;
    while (moved) {
      moved = false;
      for (int i = 0; i < compass; ++i) {
        const double angle = 2 * M_PI / compass * i;
        const Eigen::Vector2d c =
            model.project(place.c + step * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
        const double value = model.value(c);
        if (value > place.value * (1 + 1e-14)) {
          place = {c, value};
          moved = true;
        }
      }
    }
  }
  return place;
}

/// The maxima over the cone, largest first.
std::vector<Place> maxima(const DirectionModel& model) {
  std::vector<Place> places = scan(model);
  std::stable_sort(places.begin(), places.end(),
                   [](const Place& a, const Place& b) { return a.value > b.value; });
  constexpr std::size_t kMost = 6;
  // Places apart from each other, so that equal maxima are all found.
  std::vector<Place> seeds;
  for (const Place& place : places) {
    bool apart = true;
    for (const Place& seed : seeds) {
      apart = apart && (seed.c - place.c).norm() > model.half_angle / 4;
    }
    if (apart) seeds.push_back(place);
    if (seeds.size() == kMost) break;
  }
  std::vector<Place> out;
  for (const Place& seed : seeds) {
    const Place found = refine(model, seed);
    bool known = false;
    for (Place& other : out) {
      if ((other.c - found.c).norm() > 1e-3 * model.half_angle) continue;
      known = true;
      if (found.value > other.value) other = found;
    }
    if (!known) out.push_back(found);
  }
  std::stable_sort(out.begin(), out.end(),
                   [](const Place& a, const Place& b) { return a.value > b.value; });
  return out;
}

}  // namespace

WorstCase worst_case(const CaptureProblem& problem, const Formulation& formulation,
                     const Configuration& configuration) {
  const DirectionModel model(problem, formulation, configuration);
  const Place worst = maxima(model).front();
  return {worst.value, model.direction(worst.c)};
}

std::vector<ConeMaximum> cone_maxima(const CaptureProblem& problem, const Formulation& formulation,
                                     const Configuration& configuration) {
  const DirectionModel model(problem, formulation, configuration);
  std::vector<ConeMaximum> out;
  for (const Place& place : maxima(model)) {
    ConeMaximum maximum{formulation.predicted_scenario(), place.value};
    maximum.scenario.direction = (model.encounter.R_EB * model.direction(place.c)).normalized();
    out.push_back(maximum);
  }
  return out;
}

std::vector<ConeMaximum> climb(const CaptureProblem& problem, const Formulation& formulation,
                               const Configuration& configuration,
                               const std::vector<Scenario>& from) {
  const DirectionModel model(problem, formulation, configuration);
  const Matrix3d& R_EB = model.encounter.R_EB;
  std::vector<ConeMaximum> out;
  for (const Scenario& scenario : from) {
    const Eigen::Vector2d c = model.coordinates(R_EB.transpose() * scenario.direction);
    const Place place = refine(model, {c, model.value(c)});
    out.push_back({scenario, place.value});
    out.back().scenario.direction = (R_EB * model.direction(place.c)).normalized();
  }
  return out;
}

double nominal_value(const CaptureProblem& problem, const Formulation& formulation,
                     const Configuration& configuration) {
  const DirectionModel model(problem, formulation, configuration);
  return model.value(Eigen::Vector2d::Zero());
}

std::map<std::string, double> objective_terms(const CaptureProblem& problem,
                                              const Formulation& formulation,
                                              const Configuration& configuration) {
  std::map<std::string, double> out;
  CaptureProblem one = problem;
  for (ObjectiveTerm term : problem.objective) {
    term.size = 1;
    one.objective = {term};
    out[to_string(term.quantity)] = nominal_value(one, formulation, configuration);
  }
  return out;
}

}  // namespace stillbase
