#include <stillbase/formulation/measures/robust.hpp>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <stillbase/core/constants.hpp>

#include "formulation/measures/cone_search.hpp"
#include "formulation/measures/residual.hpp"
#include "impact/direction_squares.hpp"

namespace stillbase {

namespace {

using Place = ConePlace;

ConeScan scan_of(const DirectionModel& model) {
  return model.differenced.is_simulated() ? kSimulatedScan : ConeScan{};
}

/// Unit vectors evenly around.
std::vector<Eigen::Vector2d> around(int count) {
  std::vector<Eigen::Vector2d> out;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * kPi * i / count;
    out.emplace_back(std::cos(angle), std::sin(angle));
  }
  return out;
}

/// Compass search: steps of one size while they lead up.
Place ascend(const DirectionModel& model, Place place, double step) {
  static const std::vector<Eigen::Vector2d> rose = around(8), wedge = around(2);
  const std::vector<Eigen::Vector2d>& compass = model.planar ? wedge : rose;
  for (bool moved = true; moved;) {
    moved = false;
    for (const Eigen::Vector2d& side : compass) {
      const Eigen::Vector2d c = model.project(place.c + step * side);
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

/// A direction of the cone, its place and |y|.
struct Spot {
  Eigen::Vector2d c;
  Vector3d d;
  double value;
};

Spot spot_at(const DirectionModel& model, const Eigen::Vector2d& c) {
  const Vector3d d = model.direction(c);
  return {c, d, model.value_along(d)};
}

/// A move on the sphere of directions, or along the cone's rim.
struct Step {
  Vector3d away, around;  // unit tangents: away from the cone's axis, and around it
  Eigen::Vector2d along = Eigen::Vector2d::Zero();  // rad, in these
  bool on_rim = false;
  bool is_to_top = false;  // the function is concave here: where the step ends is no saddle
};

/// Newton's step towards the maximum of ln |y|^2 over the directions: on the sphere, or along the
/// cone's rim where the maximum lies beyond it. Uphill where the function is not concave. Zero
/// where there is nothing to climb.
Step newton_step(const DirectionModel& model, const Spot& at) {
  Step step;
  const double angle = at.c.norm(), alpha = model.half_angle;
  const Vector3d& d = at.d;
  const Eigen::Vector2d side = angle > 0 ? Eigen::Vector2d(at.c / angle) : Eigen::Vector2d(1, 0);
  const Vector3d outward = side[0] * model.u + side[1] * model.v;
  step.away = d.dot(model.n) * outward - d.dot(outward) * model.n;
  step.around = side[0] * model.v - side[1] * model.u;
  const Vector3d &away = step.away, &around = step.around;
  Vector3d g;
  Matrix3d H;
  if (!model.log_derivatives(d, g, H)) return step;
  const double uphill = alpha / 12, longest = alpha / 4;
  const Eigen::Vector2d slope(g.dot(away), g.dot(around));
  step.on_rim = angle >= alpha * (1 - 1e-12) && slope[0] > 0;
  if (step.on_rim && model.planar) {
    step.is_to_top = true;
    return step;
  }
  if (step.on_rim) {
    // A circle of radius sin(alpha) bends towards its axis.
    const double bend = around.dot(H * around) - g.dot(outward) / std::sin(alpha);
    step.is_to_top = bend < 0;
    step.along[1] = bend < 0 ? -slope[1] / bend : std::copysign(uphill, slope[1]);
  } else {
    // A great circle bends towards -d.
    Eigen::Matrix2d bend;
    bend << away.dot(H * away), away.dot(H * around), away.dot(H * around), around.dot(H * around);
    bend.diagonal().array() -= g.dot(d);
    if (model.planar) {
      step.is_to_top = bend(0, 0) < 0;
      step.along[0] = bend(0, 0) < 0 ? -slope[0] / bend(0, 0) : std::copysign(uphill, slope[0]);
    } else if (bend(0, 0) < 0 && bend.determinant() > 0) {
      step.is_to_top = true;
      step.along = -bend.inverse() * slope;
    } else if (slope.norm() > 0) {
      step.along = slope * (uphill / slope.norm());
    }
  }
  if (!step.along.allFinite()) {
    step.along.setZero();
    step.is_to_top = false;
  }
  if (step.along.norm() > longest) {
    step.along *= longest / step.along.norm();
    step.is_to_top = false;
  }
  return step;
}

/// The end of a part of a step.
Spot moved_along(const DirectionModel& model, const Spot& from, const Step& step, double part) {
  if (step.on_rim) {
    const double turn = part * step.along[1] / std::sin(model.half_angle);
    return spot_at(model, model.project(Eigen::Rotation2Dd(turn) * from.c));
  }
  const double length = part * step.along.norm();
  if (!(length > 0)) return from;
  const Vector3d heading = (step.along[0] * step.away + step.along[1] * step.around).normalized();
  const Vector3d there = std::cos(length) * from.d + std::sin(length) * heading;
  return spot_at(model, model.coordinates(there));
}

/// Of Newton's method on the sphere of directions.
struct ClimbOptions {
  int steps = 50, halvings = 6;
  double least_step = 1e-10;   ///< rad: a shorter one is the last
  double visible_step = 1e-6;  ///< rad: of a shorter one rounding may hide the rise
  int rounds = 4;              ///< of a climb and a compass search, which leaves saddles
};

/// @return where it ends, and whether that is the top of a hill
std::pair<Spot, bool> climb_by_newton(const DirectionModel& model, Spot spot,
                                      const ClimbOptions& options) {
  for (int i = 0; i < options.steps; ++i) {
    const Step step = newton_step(model, spot);
    if (step.along.norm() < options.least_step)
      return {moved_along(model, spot, step, 1), step.is_to_top};
    bool rose = false;
    double part = 1;
    for (int halving = 0; halving < options.halvings && !rose; ++halving, part /= 2) {
      const double length = part * step.along.norm();
      if (halving > 0 && length < options.visible_step) return {spot, false};
      const Spot trial = moved_along(model, spot, step, part);
      // Of a step that values do not see the derivatives decide.
      rose = trial.value > spot.value || length < options.visible_step;
      if (rose) spot = trial;
    }
    if (!rose) break;
  }
  return {spot, false};
}

/// The maximum that a place belongs to.
Place refine(const DirectionModel& model, Place place) {
  const double alpha = model.half_angle;
  if (!(alpha > 0)) return place;
  if (model.is_linear()) {
    // Where that is no top a round of the compass: off a saddle, and on where |y| was zero.
    const ClimbOptions options;
    for (int round = 0; round <= options.rounds; ++round) {
      const auto [end, is_top] = climb_by_newton(model, spot_at(model, place.c), options);
      place = {end.c, end.value};
      if (is_top || round == options.rounds) break;
      const Place further = ascend(model, place, alpha / 36);
      if (!(further.value > place.value)) break;
      place = further;
    }
    return place;
  }
  for (const double part : {12., 36., 108.}) place = ascend(model, place, alpha / part);
  for (const double part : {216., 2160.}) place = jump_to_top(model, place, alpha / part);
  // Needed where the parabolas failed.
  for (const double step : {1e-5, 1e-7, 1e-9}) place = ascend(model, place, step);
  return place;
}

}  // namespace

void ConeSearch::scan(const DirectionModel& model) {
  const auto [rings, spokes, row, climbs] = scan_of(model);
  const double half_angle = model.half_angle;
  const std::size_t rings_now =
      half_angle > 0 && !model.planar ? static_cast<std::size_t>(rings) : 0;
  const std::size_t count = 1 + (rings_now > 0    ? rings_now * static_cast<std::size_t>(spokes)
                                 : half_angle > 0 ? static_cast<std::size_t>(row)
                                                  : 0);
  const bool is_new = half_angle != half_angle_ || rings_now != rings_ || count != count_;
  half_angle_ = half_angle;
  rings_ = rings_now;
  count_ = count;
  if (model.is_linear()) {
    if (is_new || directions_.rows() == 0) set_directions();
    return model.squares(directions_, squares_);
  }
  squares_.resize(count_);
  for (std::size_t i = 0; i < count_; ++i) {
    const double value = model.value(place(i));
    squares_[i] = std::copysign(value * value, value);  // what was given up is below all others
  }
}

Eigen::Vector2d ConeSearch::place(std::size_t i) const {
  if (i == 0) return Eigen::Vector2d::Zero();
  const auto part = [](std::size_t a, std::size_t b) {
    return static_cast<double>(a) / static_cast<double>(b);
  };
  if (rings_ == 0) return {half_angle_ * (2 * part(i - 1, count_ - 2) - 1), 0};
  const double turn = 2 * kPi * part((i - 1) / rings_, (count_ - 1) / rings_);
  const double angle = half_angle_ * part((i - 1) % rings_ + 1, rings_);
  return angle * Eigen::Vector2d(std::cos(turn), std::sin(turn));
}

void ConeSearch::set_directions() {
  constexpr auto kLanes = static_cast<std::size_t>(DirectionSquares::kMostLanes);
  const auto padded = static_cast<Eigen::Index>((count_ + kLanes - 1) / kLanes * kLanes);
  directions_.resize(padded, 3);
  directions_.col(0).setOnes();
  directions_.rightCols<2>().setZero();
  if (rings_ == 0) {
    for (std::size_t i = 1; i < count_; ++i) {
      const double angle = place(i)[0];
      directions_.row(static_cast<Eigen::Index>(i)) << std::cos(angle), std::sin(angle), 0;
    }
  } else {
    // The first spoke, and the others as it turned.
    const auto rings = static_cast<Eigen::Index>(rings_);
    const auto spokes = static_cast<Eigen::Index>((count_ - 1) / rings_);
    for (Eigen::Index ring = 1; ring <= rings; ++ring) {
      const double angle = place(static_cast<std::size_t>(ring))[0];
      directions_(ring, 0) = std::cos(angle);
      directions_(ring, 1) = std::sin(angle);
    }
    for (Eigen::Index spoke = spokes - 1; spoke >= 0; --spoke) {
      const double turn = 2 * kPi * static_cast<double>(spoke) / static_cast<double>(spokes);
      auto rows = directions_.middleRows(1 + spoke * rings, rings);
      const auto first = directions_.middleRows(1, rings);
      rows.col(0) = first.col(0);
      rows.col(2) = std::sin(turn) * first.col(1);
      rows.col(1) = std::cos(turn) * first.col(1);
    }
  }
}

void ConeSearch::find_peaks(std::vector<std::size_t>& peaks) const {
  peaks.clear();
  // Of equal neighbours the first.
  const auto is_above = [this](std::size_t i, std::size_t other) {
    return !(squares_[other] > squares_[i]) && !(squares_[other] == squares_[i] && other < i);
  };
  const auto take = [&](std::size_t i, bool is_peak) {
    if (is_peak && !std::isnan(squares_[i])) peaks.push_back(i);
  };
  if (rings_ == 0) {  // a row, after its middle
    take(0, count_ == 1);
    for (std::size_t i = 1; i < count_; ++i) {
      take(i, (i == 1 || is_above(i, i - 1)) && (i + 1 == count_ || is_above(i, i + 1)));
    }
    return;
  }
  bool is_middle_peak = true;
  for (std::size_t first = 1; first < count_; first += rings_) {
    is_middle_peak = is_middle_peak && is_above(0, first);
  }
  take(0, is_middle_peak);
  const std::size_t last = count_ - rings_;  // first place of the last spoke
  for (std::size_t spoke = 1; spoke <= last; spoke += rings_) {
    const std::size_t before = spoke == 1 ? last : spoke - rings_;
    const std::size_t after = spoke == last ? 1 : spoke + rings_;
    for (std::size_t ring = 0; ring < rings_; ++ring) {
      const std::size_t i = spoke + ring;
      const bool is_rim = ring + 1 == rings_;
      const auto is_above_spoke = [&](std::size_t first) {
        return is_above(i, first + ring) && (is_rim || is_above(i, first + ring + 1)) &&
               is_above(i, ring == 0 ? 0 : first + ring - 1);
      };
      take(i, (is_rim || is_above(i, i + 1)) && is_above(i, ring == 0 ? 0 : i - 1) &&
                  is_above_spoke(after) && is_above_spoke(before));
    }
  }
}

const std::vector<ConePlace>& ConeSearch::maxima(const DirectionModel& model) {
  scan(model);
  const std::size_t most = scan_of(model).climbs;
  peaks_.clear();
  const auto take = [&](std::size_t i) {
    const double value = model.is_linear()
                             ? model.value(place(i))
                             : std::copysign(std::sqrt(std::abs(squares_[i])), squares_[i]);
    peaks_.push_back({place(i), value});
  };
  find_peaks(peak_places_);
  for (const std::size_t i : peak_places_) take(i);
  if (peaks_.empty()) take(0);
  // Places apart from each other, so that equal maxima are all found.
  seeds_.clear();
  while (seeds_.size() < most) {
    const Place* best = nullptr;
    for (const Place& peak : peaks_) {
      if (best != nullptr && !(peak.value > best->value)) continue;
      const auto near = [&](const Place& seed) {
        return (seed.c - peak.c).squaredNorm() <= std::pow(model.half_angle / 4, 2);
      };
      if (std::none_of(seeds_.begin(), seeds_.end(), near)) best = &peak;
    }
    if (best == nullptr) break;
    seeds_.push_back(*best);
  }
  found_.clear();
  for (const Place& seed : seeds_) {
    const Place found = refine(model, seed);
    bool known = false;
    for (Place& other : found_) {
      if ((other.c - found.c).norm() > 1e-3 * model.half_angle) continue;
      known = true;
      if (found.value > other.value) other = found;
    }
    if (!known) found_.push_back(found);
  }
  // Insertion keeps the order of equal ones, in place.
  const auto is_larger = [](const Place& a, const Place& b) { return a.value > b.value; };
  for (auto place = found_.begin(); place != found_.end(); ++place) {
    std::rotate(std::upper_bound(found_.begin(), place, *place, is_larger), place, place + 1);
  }
  return found_;
}

namespace {

/// That of this thread, since a search asks for thousands of maxima over one cone; `own` where a
/// value may call the user, and the user this.
ConeSearch& search_of(const DirectionModel& model, ConeSearch& own) {
  static thread_local ConeSearch kept;
  return model.is_linear() ? kept : own;
}

}  // namespace

WorstCase worst_case(const CaptureProblem& problem, const Formulation& formulation,
                     const Configuration& configuration) {
  if (has_residual(problem)) {
    const double value = ellipsoid_maxima(problem, formulation, configuration).front().value;
    return {value, formulation.encounter(configuration).F.head<3>(), true};
  }
  const DirectionModel model(problem, formulation, configuration);
  ConeSearch own;
  const Place worst = search_of(model, own).maxima(model).front();
  return {formulation.objective_power().value(worst.value), model.direction(worst.c),
          model.is_complete()};
}

std::vector<ConeMaximum> cone_maxima(const CaptureProblem& problem, const Formulation& formulation,
                                     const Configuration& configuration) {
  if (has_residual(problem)) return ellipsoid_maxima(problem, formulation, configuration);
  const DirectionModel model(problem, formulation, configuration);
  ConeSearch own;
  std::vector<ConeMaximum> out;
  for (const Place& place : search_of(model, own).maxima(model)) {
    ConeMaximum maximum{formulation.nominal_scenario(),
                        formulation.objective_power().value(place.value)};
    maximum.scenario.direction =
        (model.encounter.contact.R_EB * model.direction(place.c)).normalized();
    out.push_back(maximum);
  }
  return out;
}

std::vector<ConeMaximum> climb(const CaptureProblem& problem, const Formulation& formulation,
                               const Configuration& configuration,
                               const std::vector<Scenario>& from) {
  if (has_residual(problem)) return climb_ellipsoid(problem, formulation, configuration, from);
  const DirectionModel model(problem, formulation, configuration);
  const Matrix3d& R_EB = model.encounter.contact.R_EB;
  std::vector<ConeMaximum> out;
  for (const Scenario& scenario : from) {
    const Eigen::Vector2d c = model.coordinates(R_EB.transpose() * scenario.direction);
    const Place place = refine(model, {c, model.value(c)});
    out.push_back({scenario, formulation.objective_power().value(place.value)});
    out.back().scenario.direction = (R_EB * model.direction(place.c)).normalized();
  }
  return out;
}

double nominal_value(const CaptureProblem& problem, const Formulation& formulation,
                     const Configuration& configuration) {
  const DirectionModel model(problem, formulation, configuration);
  return formulation.objective_power().value(model.value(Eigen::Vector2d::Zero()));
}

std::map<std::string, double> objective_terms(const CaptureProblem& problem,
                                              const Formulation& formulation,
                                              const Configuration& configuration) {
  std::map<std::string, double> out;
  CaptureProblem one = problem;
  one.user = {};  // the user's terms are no quantities
  for (ObjectiveTerm term : problem.objective) {
    term.size = 1;
    one.objective = {term};
    const JumpObjective jump(one);
    const DifferencedTerms differenced(one);
    const DirectionModel model(problem, formulation, configuration, jump, differenced);
    const QuantityRow& row = row_of(term.quantity);
    out[row.name] = row.power.value(model.value(Eigen::Vector2d::Zero()));
  }
  return out;
}

}  // namespace stillbase
