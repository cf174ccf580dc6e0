#include "audit/smooth_parts.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include <stillbase/core/constants.hpp>

#include "audit/manifold.hpp"

namespace stillbase::audit {

using namespace verification;

namespace {

/// How the largest values are found, and which of them are parts of the measure.
struct SmoothPartsOptions {
  double active = 1e-5;        ///< relative: squares this near to the largest one count as largest
  double zero = 1e-9;          ///< of the typical objective: a size that is rounding
  int rings = 12;              ///< of a cone, from which maxima are climbed to; of a wedge twice
  int azimuths = 72;           ///< of each ring
  double finest_climb = 1e-7;  ///< of their spacing, the last step of a climb
  double same_direction = 1e-4;  ///< rad between maxima that are one
  double on_rim = 1e-9;          ///< relative, from the half-angle
  /// rad, of the differences of Newton's method: errors grow with its eighth power. Where the value
  /// bends over 0.1 rad, 0.02 is too long.
  double newton_step = 0.005;
  int newton_rounds = 3;     ///< from places that values alone leave 1e-6 rad away
  double no_weight = 1e-12;  ///< rounding of sums of weights, which are 1 together
};
constexpr SmoothPartsOptions kSmoothParts;

double square_along(const Situation& at, const Vector3d& d) {
  return square_of(at.problem, at.response, at.impulse(d));
}

std::vector<WeightedSquare> squares_of(const Situation& at) {
  return sampled_squares(at.problem, at.target(), at.at, at.response);
}

bool is_over_velocity(const CaptureProblem& problem) {
  return problem.uncertainty.residual_velocity && problem.measure.kind != RiskMeasure::Nominal;
}

/// Axes of N from those of B for both halves of a velocity.
Vector6d turned_to(const Eigen::Quaterniond& R, const Vector6d& V) {
  Vector6d out;
  out << R * Vector3d(V.head<3>()), R * Vector3d(V.tail<3>());
  return out;
}

/// The place where the slopes of the value vanish, by Newton's method with differences; along the
/// rim where the maximum lies on it. Values alone leave it unknown by the root of their rounding:
/// 1e-6 rad where the value changes by a thousandth along the rim.
/// @param value of a place
template <class Value>
ConePlace refined(const UncertaintySpec& cone, const Value& value, const ConePlace& found) {
  const bool is_wedge = cone.cone_plane_normal.has_value();
  const bool is_on_rim = std::abs(found.angle) >= cone.cone_half_angle * (1 - kSmoothParts.on_rim);
  if (is_wedge && is_on_rim) return found;
  // Along the rim by the azimuth; inside by coordinates that are smooth on the axis too.
  const auto moved = [&](const ConePlace& from, const Eigen::Vector2d& u) {
    ConePlace out = from;
    if (is_on_rim) {
      out.azimuth += u[0];
    } else if (is_wedge) {
      out.angle += u[0];
    } else {
      const Eigen::Vector2d c =
          from.angle * Eigen::Vector2d(std::cos(from.azimuth), std::sin(from.azimuth)) + u;
      out.angle = c.norm();
      out.azimuth = std::atan2(c[1], c[0]);
    }
    return out;
  };
  const Eigen::Index count = is_wedge || is_on_rim ? 1 : 2;
  ConePlace place = found;
  for (int round = 0; round < kSmoothParts.newton_rounds; ++round) {
    const auto f = [&](double a, double b) {
      return value(moved(place, kSmoothParts.newton_step * Eigen::Vector2d(a, b)));
    };
    Eigen::Vector2d slope = Eigen::Vector2d::Zero();
    Eigen::Matrix2d bend = -Eigen::Matrix2d::Identity();
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto along = [&](double a) { return i == 0 ? f(a, 0) : f(0, a); };
      const auto across = [&](double a) { return along(a) - along(-a); };
      slope[i] = 4 * across(1) / 5 - across(2) / 5 + 4 * across(3) / 105 - across(4) / 280;
      bend(i, i) = along(1) + along(-1) - 2 * f(0, 0);
    }
    if (count == 2) {
      bend(0, 1) = bend(1, 0) = (f(1, 1) - f(1, -1) - f(-1, 1) + f(-1, -1)) / 4;
    }
    if (!(bend(0, 0) < 0) || !(bend.determinant() * bend(0, 0) < 0)) return found;
    const Eigen::Vector2d step = -bend.inverse() * slope;
    if (!(step.norm() < 1)) return found;  // outside of what the differences know
    place = moved(place, kSmoothParts.newton_step * step);
  }
  return std::abs(place.angle) <= cone.cone_half_angle ? place : found;
}

/// All local maxima over the cone, with the largest first.
/// @param value of a place
template <class Value>
std::vector<ConePlace> local_maxima(const UncertaintySpec& cone, const Value& value) {
  const double half = cone.cone_half_angle;
  const bool is_wedge = cone.cone_plane_normal.has_value();
  const int rings = is_wedge ? 2 * kSmoothParts.rings : kSmoothParts.rings,
            azimuths = is_wedge ? 1 : kSmoothParts.azimuths;
  const double lowest = is_wedge ? -half : 0, step = (half - lowest) / rings;
  const auto at = [&](double angle, double azimuth) {
    ConePlace out{std::clamp(angle, lowest, half), azimuth, 0};
    out.value = value(out);
    return out;
  };
  std::vector<std::vector<ConePlace>> grid;
  for (int i = 0; i <= rings; ++i) {
    grid.emplace_back();
    for (int j = 0; j < azimuths; ++j) {
      grid.back().push_back(at(lowest + i * step, 2 * kPi * j / azimuths));
    }
  }
  std::vector<ConePlace> out;
  const auto is_highest = [&](int i, int j) {
    for (int di = -1; di <= 1; ++di) {
      for (int dj = -1; dj <= 1; ++dj) {
        if (i + di < 0 || i + di > rings) continue;
        const int side = (j + dj + azimuths) % azimuths;
        if (grid[i + di][side].value > grid[i][j].value) return false;
      }
    }
    return true;
  };
  for (int i = 0; i <= rings; ++i) {
    for (int j = 0; j < azimuths; ++j) {
      if (!is_highest(i, j)) continue;
      ConePlace best = grid[i][j];
      for (double scale = 1; scale > kSmoothParts.finest_climb;) {
        ConePlace better = best;
        for (const double sign : {-1.0, 1.0}) {
          const ConePlace a = at(best.angle + sign * scale * step, best.azimuth);
          if (a.value > better.value) better = a;
          if (is_wedge) continue;
          const ConePlace b = at(best.angle, best.azimuth + sign * scale * 2 * kPi / azimuths);
          if (b.value > better.value) better = b;
        }
        if (!(better.value > best.value)) scale /= 2;
        best = better;
      }
      out.push_back(refined(cone, value, best));
    }
  }
  std::sort(out.begin(), out.end(),
            [](const ConePlace& a, const ConePlace& b) { return a.value > b.value; });
  return out;
}

}  // namespace

SmoothParts::SmoothParts(const Situation& situation)
    : problem_(situation.problem), n_(situation.event.n) {
  const double typical = 2 * std::pow(typical_objective(problem_), 2);
  switch (problem_.measure.kind) {
    case RiskMeasure::Nominal:
      size_ = typical;
      break;
    case RiskMeasure::Expectation:
      size_ = values(situation)[0];
      break;
    case RiskMeasure::WorstCase:
      is_over_velocity(problem_) ? find_velocities(situation) : find_maxima(situation);
      break;
    case RiskMeasure::Cvar:
      find_tail(situation);
      break;
  }
  // What vanishes but for rounding has no size of its own.
  if (!(size_ > kSmoothParts.zero * kSmoothParts.zero * typical)) size_ = typical;
}

Eigen::VectorXd SmoothParts::values(const Situation& at) const {
  const RiskMeasure kind = problem_.measure.kind;
  if (is_over_velocity(problem_)) return over_velocity(at);
  if (is_sampled(kind)) return sampled(at);
  if (kind == RiskMeasure::Nominal) {
    return Eigen::VectorXd::Constant(1, square_along(at, at.event.n) / size_);
  }
  Eigen::VectorXd out(static_cast<Eigen::Index>(maxima_.size()));
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    out[i] = square_along(at, direction(at, maxima_[static_cast<std::size_t>(i)])) / size_;
  }
  return out;
}

std::vector<Vector3d> SmoothParts::worst_directions(const Situation& situation) const {
  std::vector<Vector3d> out;
  for (const ConePlace& place : maxima_) out.push_back(direction(situation, place));
  return out;
}

/// The place's direction in B; azimuths are counted from a direction that follows the axis.
Vector3d SmoothParts::direction(const Situation& at, const ConePlace& place) const {
  const auto& plane = problem_.uncertainty.cone_plane_normal;
  if (plane) return cone_direction(at.event.n, plane, place.angle, 0);
  const Vector3d d = cone_direction(n_, plane, place.angle, place.azimuth);
  return rotation_between(n_, at.event.n) * d;
}

void SmoothParts::find_maxima(const Situation& situation) {
  const auto value = [&](const ConePlace& place) {
    return square_along(situation, direction(situation, place));
  };
  for (const ConePlace& place : local_maxima(problem_.uncertainty, value)) {
    if (maxima_.empty()) size_ = place.value;
    if (place.value < (1 - kSmoothParts.active) * size_) break;
    const auto is_same = [&](const ConePlace& other) {
      return angle_between(direction(situation, place), direction(situation, other)) <
             kSmoothParts.same_direction;
    };
    if (std::none_of(maxima_.begin(), maxima_.end(), is_same)) maxima_.push_back(place);
  }
}

/// As find_maxima() over the ellipsoid, whose places are kept in N.
void SmoothParts::find_velocities(const Situation& situation) {
  const ResidualCase residual = residual_case(situation);
  for (const Vector6d& s : local_maxima(residual)) {
    const double value = residual.square(residual.at(s));
    if (velocities_.empty()) size_ = value;
    if (value < (1 - kSmoothParts.active) * size_) break;
    if (!is_isolated(residual, s)) {
      objection_ =
          "equally bad velocities of the ellipsoid form a curve, or nearly do: no gradient";
    }
    velocities_.push_back(turned_to(situation.at.base.orientation, s));
  }
}

Eigen::VectorXd SmoothParts::over_velocity(const Situation& at) const {
  const ResidualCase residual = residual_case(at);
  if (problem_.measure.kind == RiskMeasure::Expectation) {
    return Eigen::VectorXd::Constant(1, residual.mean_square() / size_);
  }
  Eigen::VectorXd out(static_cast<Eigen::Index>(velocities_.size()));
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    const Vector6d s =
        turned_to(at.at.base.orientation.conjugate(), velocities_[static_cast<std::size_t>(i)]);
    out[i] = residual.square(residual.at(s)) / size_;
  }
  return out;
}

/// Of the mean over the tail: samples above the quantile count in full; what is left of the tail is
/// shared in some way among those at the quantile.
void SmoothParts::find_tail(const Situation& situation) {
  const std::vector<WeightedSquare> squares = squares_of(situation);
  std::vector<std::size_t> order(squares.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
    return squares[a].square > squares[b].square;
  });
  const double share = 1 - problem_.measure.cvar_level;
  double left = share, quantile = 0;
  for (const std::size_t i : order) {
    quantile = squares[i].square;
    if (left - squares[i].weight <= kSmoothParts.no_weight) break;
    left -= squares[i].weight;
  }
  left = share;
  weights_.setZero(static_cast<Eigen::Index>(squares.size()));
  for (const std::size_t i : order) {
    if (std::abs(squares[i].square - quantile) <= kSmoothParts.active * quantile) {
      at_quantile_.push_back(static_cast<Eigen::Index>(i));
    } else if (squares[i].square > quantile) {
      weights_[static_cast<Eigen::Index>(i)] = squares[i].weight / share;
      left -= squares[i].weight;
    }
  }
  remaining_ = left / share;
  size_ = sampled(situation).maxCoeff();
}

Eigen::VectorXd SmoothParts::sampled(const Situation& at) const {
  const std::vector<WeightedSquare> squares = squares_of(at);
  const bool is_tail = weights_.size() > 0;
  double sum = 0;
  for (std::size_t i = 0; i < squares.size(); ++i) {
    const auto index = static_cast<Eigen::Index>(i);
    sum += squares[i].square * (is_tail ? weights_[index] : squares[i].weight);
  }
  if (!is_tail) return Eigen::VectorXd::Constant(1, sum / size_);
  Eigen::VectorXd out(static_cast<Eigen::Index>(at_quantile_.size()));
  for (Eigen::Index i = 0; i < out.size(); ++i) {
    const auto sample = static_cast<std::size_t>(at_quantile_[static_cast<std::size_t>(i)]);
    out[i] = (sum + remaining_ * squares[sample].square) / size_;
  }
  return out;
}

}  // namespace stillbase::audit
