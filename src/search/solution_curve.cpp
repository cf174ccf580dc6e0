#include "search/solution_curve.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <stillbase/core/linear_algebra.hpp>

#include "formulation/projection.hpp"
#include "nlp/restoration.hpp"

namespace stillbase {

namespace {

/// A solution, with the Jacobian of the equations and the objective vector there.
struct Corrected {
  Eigen::VectorXd x;
  Eigen::MatrixXd J;
};

/// Newton's method within the plane through `x` normal to `normal`; empty: it did not converge.
std::optional<Corrected> correct(const Formulation& formulation, const Eigen::VectorXd& x,
                                 const Eigen::VectorXd& normal, const CurveOptions& options) {
  Eigen::VectorXd at = x, r;
  Eigen::MatrixXd J;
  for (int iteration = 0; iteration < options.newton_steps; ++iteration) {
    evaluate_equations(formulation, at, true, r, J);
    if (!r.allFinite()) return std::nullopt;
    if (r.cwiseAbs().maxCoeff() <= options.exact) return Corrected{at, J};
    Eigen::MatrixXd A(J.rows() + 1, J.cols());
    A << J, normal.transpose();
    Eigen::VectorXd b(r.size() + 1);
    b << r, normal.dot(at - x);
    at -= nlp::shortest_step(A, b);  // rows of a planar robot may vanish identically
  }
  evaluate_equations(formulation, at, true, r, J);
  if (r.cwiseAbs().maxCoeff() <= options.exact) return Corrected{at, J};
  return std::nullopt;
}

/// Whether the rotation angle of the base is at most pi: beyond it other variables say the same.
bool is_shortest(const Formulation& formulation, const Eigen::VectorXd& x,
                 const CurveOptions& options) {
  return (in_shortest_turns(formulation, x, options.other_turn) - x).isZero(0);
}

/// Distance to the nearest bound or inequality, each in its own unit, negative beyond it; minus
/// infinity where other variables say the same, see is_shortest().
double room_inside(const Formulation& formulation, const Eigen::VectorXd& x,
                   const CurveOptions& options) {
  if (!is_shortest(formulation, x, options)) return -kInfinity;
  double room =
      std::min((x - formulation.lower()).minCoeff(), (formulation.upper() - x).minCoeff());
  if (room < -options.inside) return room;
  nlp::Evaluation at_x;
  formulation.evaluate_value(x, at_x);
  const Eigen::VectorXd lower = formulation.constraint_lower();
  const Eigen::VectorXd upper = formulation.constraint_upper();
  for (Eigen::Index i = 0; i < lower.size(); ++i) {
    if (lower[i] == upper[i]) continue;
    room = std::min({room, at_x.constraints[i] - lower[i], upper[i] - at_x.constraints[i]});
  }
  return room;
}

/// The one direction that the rows of J leave open, in the sense of `like`.
std::optional<Eigen::VectorXd> tangent_along(const Eigen::MatrixXd& J, const Eigen::VectorXd& like,
                                             const CurveOptions& options) {
  constexpr double kNothing = 1e-12;  // slopes over typical sizes: only rounding is left
  if (J.isZero(kNothing)) {
    return J.cols() == 1 ? std::optional<Eigen::VectorXd>(like.cwiseSign()) : std::nullopt;
  }
  const PivotedQr qr(J.transpose(), options.dependent);
  if (J.cols() - qr.rank() != 1) return std::nullopt;
  const Eigen::VectorXd t = qr.complement();
  return t.dot(like) < 0 ? Eigen::VectorXd(-t) : t;
}

/// A step of length h from a point of the curve; empty: too long for the curve's bend.
std::optional<CurvePoint> stepped(const Formulation& formulation, const CurvePoint& from, double h,
                                  const CurveOptions& options) {
  const Eigen::VectorXd ahead = from.x + h * from.tangent;
  const auto there = from.bend.size() == 0 ? correct(formulation, ahead, from.tangent, options)
                                           : correct(formulation, ahead + h * h / 2 * from.bend,
                                                     from.tangent, options);
  if (!there || (there->x - ahead).norm() > options.off_tangent * h) return std::nullopt;
  const auto tangent = tangent_along(there->J, from.tangent, options);
  if (!tangent || tangent->dot(from.tangent) < options.turn_cosine) return std::nullopt;
  Eigen::VectorXd bend = (*tangent - from.tangent) / h;
  bend -= bend.dot(*tangent) * *tangent;
  return CurvePoint{there->x, *tangent, from.arc + h, std::move(bend)};
}

/// Step along the tangent of `from` at which the curve passes through x, at most `longest`.
std::optional<double> step_to(const Formulation& formulation, const CurvePoint& from,
                              const Eigen::VectorXd& x, double longest,
                              const CurveOptions& options) {
  const Eigen::VectorXd d = formulation.difference(x, from.x);
  const double h = from.tangent.dot(d);
  if (h < -options.same_point || h > longest + options.same_point) return std::nullopt;
  if ((d - h * from.tangent).norm() > options.off_tangent * h + options.same_point)
    return std::nullopt;
  const auto there = correct(formulation, from.x + h * from.tangent, from.tangent, options);
  if (!there || formulation.difference(there->x, x).norm() > options.same_point)
    return std::nullopt;
  return h;
}

/// The last point before a limit that lies within one step: where the room ends, by false position
/// (the Illinois rule; Dowell and Jarratt, BIT 11, 1971). Where that does not halve what is open,
/// as where the room jumps or another limit is near all along, the next trial is in the middle.
/// @param room at `from` and, beyond the limit, at the step h
CurvePoint last_inside(const Formulation& formulation, const CurvePoint& from, double h,
                       std::pair<double, double> room, const CurveOptions& options) {
  CurvePoint last = from;
  double inside = 0, outside = h;
  auto [room_before, room_beyond] = room;  // weights of the ends, once they are halved
  const auto try_step = [&](double step) {
    const auto trial = stepped(formulation, from, step, options);
    const double there = trial ? room_inside(formulation, trial->x, options) : -kInfinity;
    const bool is_inside = there >= -options.inside;
    if (is_inside) {
      inside = step;
      last = *trial;
    } else {
      outside = step;
    }
    return std::pair(is_inside, there);
  };
  // Whether the limit is at the last point itself: it is crossed right behind it.
  const auto is_at_limit = [&](double there) {
    constexpr double kBehind = 1e-9;  // far more than the rounding of a point
    const double behind = inside + kBehind;
    return there <= options.inside && behind < outside && !try_step(behind).first;
  };
  if (is_at_limit(room_before)) return last;
  const double open = std::ldexp(h, -options.halvings);
  bool was_before = false, was_beyond = false, is_slow = false;
  while (outside - inside > open) {
    const double width = outside - inside;
    const bool is_smooth = !is_slow && room_before > 0 && std::isfinite(room_beyond);
    const double part = is_smooth ? room_before / (room_before - room_beyond) : 0.5;
    const auto [is_before, there] = try_step(inside + part * width);
    if (is_before && is_at_limit(there)) break;
    (is_before ? room_before : room_beyond) = there;
    if (is_before && was_before) room_beyond /= 2;
    if (!is_before && was_beyond) room_before /= 2;
    was_before = is_before;
    was_beyond = !is_before;
    is_slow = outside - inside > width / 2;
  }
  return last;
}

/// Length of the cubic between two points with these tangents, L = |dr/ds| in its middle by
/// Simpson's rule: |3/2 d - L (t_0 + t_1) / 4| = L, d the chord. Of an arc of angle a it is wrong
/// by a part of a^4 / 2880.
double length_between(const CurvePoint& from, const CurvePoint& to) {
  const Eigen::VectorXd d = to.x - from.x, t = from.tangent + to.tangent;
  const double a = 1 - t.squaredNorm() / 16, b = 0.75 * d.dot(t), c = 2.25 * d.squaredNorm();
  return (std::sqrt(b * b + 4 * a * c) - b) / (2 * a);
}

double arc_length_of(const SolutionCurve& curve) {
  double sum = 0;
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    sum += length_between(curve.points[i - 1], curve.points[i]);
  }
  return sum;
}

/// Points after `start` in the sense of its tangent.
struct Walk {
  std::vector<CurvePoint> points;
  std::optional<double> closing_step;  ///< from the last one back to `start`
  bool is_complete = false;
};

Walk walk(const Formulation& formulation, const CurvePoint& start, const StopCondition& stop,
          const CurveOptions& options) {
  Walk out;
  CurvePoint at = start;
  double h = options.longest_step;
  double room = room_inside(formulation, start.x, options);
  while (static_cast<int>(out.points.size()) < options.most_points && !stop.reached()) {
    const auto next = stepped(formulation, at, h, options);
    if (!next) {
      h /= 2;
      if (h < options.shortest_step) return out;
      continue;
    }
    if (at.arc > 10 * options.same_point && at.tangent.dot(start.tangent) > 0) {
      if (const auto closing = step_to(formulation, at, start.x, h, options)) {
        out.closing_step = std::max(*closing, 0.0);
        out.is_complete = true;
        return out;
      }
    }
    const double room_there = room_inside(formulation, next->x, options);
    if (!(room_there >= -options.inside)) {
      const CurvePoint last = last_inside(formulation, at, h, {room, room_there}, options);
      if (last.arc > at.arc) out.points.push_back(last);
      const auto beyond = stepped(formulation, last, options.shortest_step, options);
      out.is_complete = is_shortest(formulation, beyond ? beyond->x : next->x, options);
      return out;
    }
    out.points.push_back(*next);
    at = *next;
    room = room_there;
    h = std::min(1.5 * h, options.longest_step);
  }
  return out;
}

}  // namespace

std::optional<SolutionCurve> trace_curve(const Formulation& formulation, const Eigen::VectorXd& x,
                                         const StopCondition& stop, const CurveOptions& options) {
  Eigen::VectorXd r;
  Eigen::MatrixXd J;
  evaluate_equations(formulation, x, true, r, J);
  const auto tangent = tangent_along(J, Eigen::VectorXd::Ones(x.size()), options);
  if (!tangent) return std::nullopt;
  const CurvePoint start{x, *tangent, 0};
  SolutionCurve curve;
  const Walk ahead = walk(formulation, start, stop, options);
  if (ahead.closing_step) {
    curve.points.push_back(start);
    curve.points.insert(curve.points.end(), ahead.points.begin(), ahead.points.end());
    curve.is_closed = true;
    curve.is_complete = true;
    curve.length = curve.points.back().arc + *ahead.closing_step;
    // Full rotations of continuous joints lie between the last point and the first.
    const CurvePoint& last = curve.points.back();
    const Eigen::VectorXd back = formulation.difference(start.x, last.x);
    curve.arc_length =
        arc_length_of(curve) + length_between(last, {last.x + back, start.tangent, 0});
    return curve;
  }
  const Walk back = walk(formulation, {x, -*tangent, 0}, stop, options);
  const double before = back.points.empty() ? 0 : back.points.back().arc;
  for (auto point = back.points.rbegin(); point != back.points.rend(); ++point) {
    curve.points.push_back({point->x, -point->tangent, before - point->arc});
  }
  curve.points.push_back({x, *tangent, before});
  for (const CurvePoint& point : ahead.points) {
    curve.points.push_back({point.x, point.tangent, before + point.arc});
  }
  curve.is_complete = ahead.is_complete && back.is_complete;
  // The backward part was measured along the tangents at the other ends of its steps.
  for (std::size_t i = 1; i < curve.points.size(); ++i) {
    const CurvePoint& last = curve.points[i - 1];
    curve.points[i].arc = last.arc + last.tangent.dot(curve.points[i].x - last.x);
  }
  curve.length = curve.points.back().arc;
  curve.arc_length = arc_length_of(curve);
  return curve;
}

std::optional<double> place_on(const Formulation& formulation, const SolutionCurve& curve,
                               const Eigen::VectorXd& x, const CurveOptions& options) {
  for (std::size_t i = 0; i < curve.points.size(); ++i) {
    const bool is_last = i + 1 == curve.points.size();
    const double next = is_last ? curve.length : curve.points[i + 1].arc;
    if (const auto h =
            step_to(formulation, curve.points[i], x, next - curve.points[i].arc, options)) {
      return std::clamp(curve.points[i].arc + *h, 0.0, curve.length);
    }
  }
  return std::nullopt;
}

Eigen::VectorXd point_at(const Formulation& formulation, const SolutionCurve& curve, double arc,
                         const CurveOptions& options) {
  const auto after =
      std::upper_bound(curve.points.begin(), curve.points.end(), arc,
                       [](double value, const CurvePoint& point) { return value < point.arc; });
  const CurvePoint& from = after == curve.points.begin() ? *after : *(after - 1);
  const auto there =
      correct(formulation, from.x + (arc - from.arc) * from.tangent, from.tangent, options);
  return there ? there->x : from.x;
}

}  // namespace stillbase
