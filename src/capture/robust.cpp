#include <stillbase/capture/robust.hpp>

#include <algorithm>
#include <cmath>
#include <vector>

#include "capture/direction_model.hpp"

namespace stillbase {

namespace {

/// A place in the cone and its |y|.
struct Place {
  Eigen::Vector2d c;
  double value;
};

/// Rings about the predicted direction, or a row in the wedge.
std::vector<Place> scan(const DirectionModel& model) {
  // A direction that has to be simulated costs as much as all the others together.
  const bool dear = !model.turns.empty();
  const int rings = dear ? 3 : 12;
  const int spokes = dear ? 12 : 36;
  const int row = dear ? 17 : 97;  // a wedge is one-dimensional: finer for less
  const double alpha = model.half_angle;
  std::vector<Eigen::Vector2d> grid = {Eigen::Vector2d::Zero()};
  if (alpha > 0 && model.planar) {
    for (int i = 0; i < row; ++i) grid.emplace_back(alpha * (2.0 * i / (row - 1) - 1), 0);
  } else if (alpha > 0) {
    grid.reserve(1 + rings * spokes);
    for (int spoke = 0; spoke < spokes; ++spoke) {
      const double angle = 2 * M_PI * spoke / spokes;
      const Eigen::Vector2d end(alpha * std::cos(angle), alpha * std::sin(angle));
      for (int ring = 1; ring <= rings; ++ring) grid.emplace_back(end * ring / rings);
    }
  }
  std::vector<double> values;
  model.values(grid, values);
  std::vector<Place> out(grid.size());
  for (std::size_t i = 0; i < grid.size(); ++i) out[i] = {grid[i], values[i]};
  return out;
}

/// Compass search: steps of one size while they lead up.
Place ascend(const DirectionModel& model, Place place, double step) {
  const int compass = model.planar ? 2 : 8;
  for (bool moved = true; moved;) {
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
  return place;
}

/// To the top of the parabola through the values at distances `step` about a place: within the
/// cone, or along its rim.
Place jump_to_top(const DirectionModel& model, const Place& place, double step) {
  const double radius = place.c.norm();
  const bool at_rim = radius > model.half_angle - step;
  if (at_rim && model.planar) return place;
  const Eigen::Vector2d outward =
      at_rim ? Eigen::Vector2d(place.c / radius) : Eigen::Vector2d(1, 0);
  const Eigen::Vector2d across(-outward.y(), outward.x());
  const auto value = [&](double a, double b) {
    return model.value(model.project(place.c + step * (a * outward + b * across)));
  };
  // Gradient and Hessian in steps.
  const auto slope = [](double minus, double plus) { return (plus - minus) / 2; };
  const auto bend = [&](double minus, double plus) { return plus - 2 * place.value + minus; };
  Eigen::Vector2d move = Eigen::Vector2d::Zero();
  if (at_rim || model.planar) {
    const double minus = at_rim ? value(0, -1) : value(-1, 0);
    const double plus = at_rim ? value(0, 1) : value(1, 0);
    if (!(bend(minus, plus) < 0)) return place;
    move[at_rim ? 1 : 0] = -slope(minus, plus) / bend(minus, plus);
  } else {
    const double w = value(-1, 0), e = value(1, 0), s = value(0, -1), n = value(0, 1);
    const double twist = (value(1, 1) - value(1, -1) - value(-1, 1) + value(-1, -1)) / 4;
    Eigen::Matrix2d H;
    H << bend(w, e), twist, twist, bend(s, n);
    if (!(H(0, 0) < 0) || !(H.determinant() > 0)) return place;
    move = -H.inverse() * Eigen::Vector2d(slope(w, e), slope(s, n));
  }
  if (!(move.norm() < 4)) return place;  // outside of what the parabola knows
  const Eigen::Vector2d c = model.project(place.c + step * (move[0] * outward + move[1] * across));
  const Place top{c, model.value(c)};
  return top.value > place.value ? top : place;
}

/// The maximum that a place belongs to. The value is flat there: a step of 1e-8 rad leaves an error
/// of about 1e-16.
Place refine(const DirectionModel& model, Place place) {
  const double alpha = model.half_angle;
  if (!(alpha > 0)) return place;
  for (const double part : {12., 36., 108.}) place = ascend(model, place, alpha / part);
  for (const double part : {216., 2160.}) place = jump_to_top(model, place, alpha / part);
  // Hardly anything is left to do; where the parabolas failed, everything.
  for (const double step : {1e-5, 1e-7, 1e-9}) place = ascend(model, place, step);
  return place;
}

/// The maxima over the cone, largest first.
std::vector<Place> maxima(const DirectionModel& model) {
  const std::vector<Place> places = scan(model);
  const std::size_t most = model.turns.empty() ? 6 : 3;
  // Places apart from each other, so that equal maxima are all found.
  std::vector<Place> seeds;
  while (seeds.size() < most) {
    const Place* best = nullptr;
    for (const Place& place : places) {
      const auto near = [&](const Place& seed) {
        return (seed.c - place.c).squaredNorm() <= std::pow(model.half_angle / 4, 2);
      };
      if (best != nullptr && !(place.value > best->value)) continue;
      if (std::none_of(seeds.begin(), seeds.end(), near)) best = &place;
    }
    if (best == nullptr) break;
    seeds.push_back(*best);
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
  return {worst.value, model.direction(worst.c), model.is_complete()};
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
  const std::vector<UserTerm> none;  // those of the user are no quantities
  for (ObjectiveTerm term : problem.objective) {
    term.size = 1;
    one.objective = {term};
    DirectionModel model(one, formulation, configuration);
    model.user_terms = &none;
    out[to_string(term.quantity)] = model.value(Eigen::Vector2d::Zero());
  }
  return out;
}

}  // namespace stillbase
