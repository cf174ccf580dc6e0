// Signed distance of two shapes and where it is taken, for any number type.
//
// Which features are nearest is decided on plain values; the distance between those features is
// then written in S, so that it has exact derivatives wherever the choice does not change. The
// distance is continuously differentiable while the shapes are apart and the nearest points are
// unique; parallel segments, parallel faces of two boxes, a cylinder whose capsule and box are
// equally far, and shapes that lie deep inside each other have kinks, at which the derivative is
// that of one side.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include <stillbase/core/types.hpp>

#include "core/tangent.hpp"
#include "formulation/constraints/clearance_pairs.hpp"

namespace stillbase {

/// Axes and origin of a shape in a common frame.
template <class S>
struct PlacedShape {
  const ClearanceShape* shape;
  Matrix3<S> R;
  Vector3<S> p;
};

/// d distance = normal . (velocity of the first - velocity of the second, both at `point`).
template <class S>
struct Separation {
  S distance = S(0);
  Vector3<S> normal;  ///< from the second to the first; a unit vector unless they overlap deeply
  Vector3<S> point;
};

/// Pairs of shapes in closed form.
namespace closed_form {

template <class S>
Vector3d plain(const Vector3<S>& v) {
  return {value_of_number(v[0]), value_of_number(v[1]), value_of_number(v[2])};
}

template <class S>
Matrix3d plain_axes(const Matrix3<S>& M) {
  Matrix3d out;
  for (int i = 0; i < 3; ++i) out.col(i) = plain<S>(Vector3<S>(M.col(i)));
  return out;
}

inline double sign_of(double x) { return x < 0 ? -1 : 1; }

/// Gaps of boxes (m) and slopes of their faces (rad) that may be the same but for rounding. What is
/// compared too often costs time alone.
inline constexpr double kSameGap = 1e-9;

/// Where on two segments a + s u and b + t v, s and t in [-1, 1], the nearest points are.
struct SegmentChoice {
  double s = 0, t = 0;
  bool s_free = false, t_free = false;  ///< not at an end
};

inline SegmentChoice nearest_on_segments(const Vector3d& a, const Vector3d& u, const Vector3d& b,
                                         const Vector3d& v) {
  const double uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  SegmentChoice best;
  double least = -1;
  const auto offer = [&](const SegmentChoice& choice) {
    const double square = (a + choice.s * u - b - choice.t * v).squaredNorm();
    if (least >= 0 && square >= least) return;
    least = square;
    best = choice;
  };
  // The foot of a point on the other segment; at an end when it lies beyond.
  const auto foot = [](const Vector3d& point, const Vector3d& from, const Vector3d& along,
                       double square, bool& is_free) {
    const double at = square > 0 ? along.dot(point - from) / square : 0;
    is_free = square > 0 && at > -1 && at < 1;
    return std::clamp(at, -1.0, 1.0);
  };
  for (const double end : {-1.0, 1.0}) {
    SegmentChoice first{end, 0, false, false}, second{0, end, false, false};
    first.t = foot(a + end * u, b, v, vv, first.t_free);
    offer(first);
    second.s = foot(b + end * v, a, u, uu, second.s_free);
    offer(second);
  }
  const double determinant = uu * vv - uv * uv;
  if (determinant > 1e-12 * uu * vv) {
    const Vector3d w = b - a;
    const double s = (vv * u.dot(w) - uv * v.dot(w)) / determinant;
    const double t = (uv * u.dot(w) - uu * v.dot(w)) / determinant;
    if (std::abs(s) < 1 && std::abs(t) < 1) offer({s, t, true, true});
  }
  return best;
}

template <class S>
Separation<S> between_segments(const PlacedShape<S>& first, const PlacedShape<S>& second) {
  using std::sqrt;
  const Vector3<S> u = first.R.col(2) * S(first.shape->half.z());
  const Vector3<S> v = second.R.col(2) * S(second.shape->half.z());
  const Vector3<S> w = second.p - first.p;
  const SegmentChoice choice =
      nearest_on_segments(plain<S>(first.p), plain<S>(u), plain<S>(second.p), plain<S>(v));
  S s(choice.s), t(choice.t);
  const S uu = u.squaredNorm(), vv = v.squaredNorm(), uv = u.dot(v);
  if (choice.s_free && choice.t_free) {
    const S determinant = uu * vv - uv * uv;
    s = (vv * u.dot(w) - uv * v.dot(w)) / determinant;
    t = (uv * u.dot(w) - uu * v.dot(w)) / determinant;
  } else if (choice.s_free) {
    s = u.dot(w + v * t) / uu;
  } else if (choice.t_free) {
    t = v.dot(u * s - w) / vv;
  }
  Separation<S> out;
  out.point = first.p + u * s;
  const Vector3<S> apart = u * s - v * t - w;
  const S square = apart.squaredNorm();
  if (!(square > S(1e-20))) {  // the axes intersect: no direction is better than another
    out.normal = first.R.col(0);
    out.distance = S(-first.shape->radius - second.shape->radius);
    return out;
  }
  const S length = sqrt(square);
  out.normal = apart / length;
  out.distance = length - S(first.shape->radius + second.shape->radius);
  return out;
}

/// Signed distance of a point (in the box's axes) from a box, on plain values.
inline double box_distance(const Vector3d& p, const Vector3d& half) {
  const Vector3d q = p.cwiseAbs() - half;
  const double inside = q.maxCoeff();
  return inside > 0 ? Vector3d(q.cwiseMax(0)).norm() : inside;
}

/// The t in [-1, 1] at which p + t d is nearest to a box, and what holds it there: the minimum of a
/// parabola, two faces that are equally far (deep inside; `face_i` and `face_j`, which may be the
/// opposite ones of one axis), or nothing of both: an end.
struct BoxChoice {
  double t = 0;
  bool is_free = false;
  int face_i = -1, face_j = -1;
};

/// The signed distance is convex along the segment. Between the places where it enters or leaves a
/// slab of the box its square is one parabola; inside it is a broken line, which is looked at where
/// the segment comes in.
inline BoxChoice nearest_to_box(const Vector3d& p, const Vector3d& d, const Vector3d& half) {
  // Mostly an end is nearest: outside, where the square does not fall from it on.
  for (const double end : {-1.0, 1.0}) {
    const Vector3d at = p + end * d;
    double slope = 0, square = 0;
    for (int i = 0; i < 3; ++i) {
      const double outside = std::abs(at[i]) - half[i];
      if (!(outside > 0)) continue;
      slope += outside * sign_of(at[i]) * d[i];
      square += outside * outside;
    }
    if (square > kSameGap * kSameGap && -end * slope >= 0) return {end, false, -1, -1};
  }
  std::array<BoxChoice, 26> breaks;
  std::size_t count = 0;
  const auto add = [&](double numerator, double denominator, int i, int j) {
    if (denominator == 0) return;
    const double t = numerator / denominator;
    if (t > -1 && t < 1) breaks[count++] = {t, false, i, j};
  };
  BoxChoice best;
  double least = kInfinity;
  const auto offer = [&](BoxChoice choice) {
    const Vector3d at = p + choice.t * d;
    const double value = box_distance(at, half);
    if (value >= least) return;
    least = value;
    // Faces that are not the nearest ones hold nothing.
    const Vector3d q = at.cwiseAbs() - half;
    if (choice.face_i >= 0 &&
        (value > 0 || q[choice.face_i] < value - 1e-12 || q[choice.face_j] < value - 1e-12)) {
      choice.face_i = choice.face_j = -1;
    }
    best = choice;
  };
  const auto search = [&] {
    std::sort(breaks.begin(), breaks.begin() + static_cast<std::ptrdiff_t>(count),
              [](const BoxChoice& a, const BoxChoice& b) { return a.t < b.t; });
    for (std::size_t k = 0; k < count; ++k) offer(breaks[k]);
    for (std::size_t k = 0; k + 1 < count; ++k) {
      const double low = breaks[k].t, high = breaks[k + 1].t;
      const Vector3d middle = p + (low + high) / 2 * d;
      double slope = 0, curvature = 0;
      for (int i = 0; i < 3; ++i) {
        const double side = sign_of(middle[i]);
        if (!(side * middle[i] > half[i])) continue;
        slope += (side * p[i] - half[i]) * side * d[i];
        curvature += d[i] * d[i];
      }
      if (!(curvature > 0)) continue;
      const double t = -slope / curvature;
      if (t > low && t < high) offer({t, true, -1, -1});
    }
  };
  for (int i = 0; i < 3; ++i) {
    add(half[i] - p[i], d[i], -1, -1);
    add(-half[i] - p[i], d[i], -1, -1);
  }
  breaks[count++] = {-1, false, -1, -1};
  breaks[count++] = {1, false, -1, -1};
  search();
  if (least > kSameGap) return best;  // not inside the box
  for (int i = 0; i < 3; ++i) {
    add(-p[i], d[i], i, i);
    const int j = (i + 1) % 3;  // |p_i| - h_i = |p_j| - h_j
    for (const double sign : {1.0, -1.0}) {
      add(half[i] - half[j] - p[i] + sign * p[j], d[i] - sign * d[j], i, j);
      add(half[j] - half[i] - p[i] + sign * p[j], d[i] - sign * d[j], i, j);
    }
  }
  least = kInfinity;
  search();
  return best;
}

/// A sphere or capsule against a box.
template <class S>
Separation<S> segment_and_box(const PlacedShape<S>& round, const PlacedShape<S>& box) {
  using std::sqrt;
  const Vector3d& half = box.shape->half;
  const Vector3<S> p = box.R.transpose() * (round.p - box.p);
  const Vector3<S> d = box.R.transpose() * round.R.col(2) * S(round.shape->half.z());
  const BoxChoice choice = nearest_to_box(plain<S>(p), plain<S>(d), half);
  const Vector3d at = plain<S>(p) + choice.t * plain<S>(d);
  S t(choice.t);
  if (choice.is_free) {
    S slope(0), curvature(0);
    for (int i = 0; i < 3; ++i) {
      const double side = sign_of(at[i]);
      if (!(side * at[i] > half[i])) continue;
      slope += (p[i] * S(side) - S(half[i])) * d[i] * S(side);
      curvature += d[i] * d[i];
    }
    t = -slope / curvature;
  } else if (choice.face_i >= 0 && choice.face_i != choice.face_j) {
    // Where the segment is as far from one face as from the other: its least depth there is a
    // mixture of both, in which the slopes along the segment cancel.
    const int i = choice.face_i, j = choice.face_j;
    const S side_i(sign_of(at[i])), side_j(sign_of(at[j]));
    const S slope_i = d[i] * side_i, slope_j = d[j] * side_j;
    const S depth_i = p[i] * side_i - S(half[i]), depth_j = p[j] * side_j - S(half[j]);
    const S difference = slope_i - slope_j;
    if (value_of_number(difference) != 0) {
      t = (depth_j - depth_i) / difference;
      Separation<S> out;
      out.distance = depth_i + slope_i * t - S(round.shape->radius);
      Vector3<S> normal = Vector3<S>::Zero();
      normal[i] = -side_i * slope_j / difference;
      normal[j] = side_j * slope_i / difference;
      out.normal = box.R * normal;
      out.point = round.p + round.R.col(2) * (t * S(round.shape->half.z()));
      return out;
    }
  } else if (choice.face_i >= 0) {
    // Across the middle of the box: as deep as it can be, wherever it moves.
    Separation<S> out;
    out.distance = S(-half[choice.face_i] - round.shape->radius);
    out.normal = Vector3<S>::Zero();
    out.point = round.p;
    return out;
  }
  const Vector3<S> x = p + d * t;
  Separation<S> out;
  out.point = round.p + round.R.col(2) * (t * S(round.shape->half.z()));
  Vector3<S> normal = Vector3<S>::Zero();
  const Vector3d q = at.cwiseAbs() - half;
  if (q.maxCoeff() > 1e-10) {
    S square(0);
    for (int i = 0; i < 3; ++i) {
      if (!(q[i] > 0)) continue;
      normal[i] = x[i] - S(sign_of(at[i]) * half[i]);
      square += normal[i] * normal[i];
    }
    const S length = sqrt(square);
    normal /= length;
    out.distance = length - S(round.shape->radius);
  } else {
    int face = 0;
    q.maxCoeff(&face);
    normal[face] = S(sign_of(at[face]));
    out.distance = x[face] * S(sign_of(at[face])) - S(half[face] + round.shape->radius);
  }
  out.normal = box.R * normal;
  return out;
}

/// Centre of a box's edge (the two axes beside `along`) or its corner (along < 0) that is furthest
/// along a direction.
template <class S>
Vector3<S> support(const PlacedShape<S>& box, const Vector3d& direction, int along) {
  Vector3<S> out = box.p;
  for (int i = 0; i < 3; ++i) {
    if (i == along) continue;
    const Vector3<S> axis = box.R.col(i);
    out += axis * S(sign_of(plain<S>(axis).dot(direction)) * box.shape->half[i]);
  }
  return out;
}

/// The least distance of a corner of either box from the other one.
template <class S>
Separation<S> nearest_corner(const PlacedShape<S>& first, const PlacedShape<S>& second) {
  bool is_of_first = true;
  Vector3d nearest = Vector3d::Zero();
  double least = kInfinity;
  const auto offer = [&](bool is_first) {
    const PlacedShape<S>& box = is_first ? first : second;
    const PlacedShape<S>& other = is_first ? second : first;
    const Matrix3d to_other = plain_axes<S>(other.R).transpose();
    const Vector3d from = to_other * (plain<S>(box.p) - plain<S>(other.p));
    const Matrix3d halves = to_other * plain_axes<S>(box.R) * box.shape->half.asDiagonal();
    for (unsigned i = 0; i < 8; ++i) {
      const Vector3d sign((i & 1U) != 0 ? 1 : -1, (i & 2U) != 0 ? 1 : -1, (i & 4U) != 0 ? 1 : -1);
      const Vector3d q = (from + halves * sign).cwiseAbs() - other.shape->half;
      const double inside = q.maxCoeff();
      const double distance = inside > 0 ? q.cwiseMax(0).squaredNorm() : inside;  // or its square
      if (distance >= least) continue;
      least = distance;
      nearest = sign.cwiseProduct(box.shape->half);
      is_of_first = is_first;
    }
  };
  offer(true);
  offer(false);
  const ClearanceShape point;
  const PlacedShape<S>& of = is_of_first ? first : second;
  const PlacedShape<S> corner{&point, of.R, of.p + of.R * nearest.template cast<S>()};
  Separation<S> out = segment_and_box(corner, is_of_first ? second : first);
  if (!is_of_first) out.normal = -out.normal;
  return out;
}

/// A box's edge along one of its axes as a segment along z.
template <class S>
struct BoxEdge {
  ClearanceShape segment;
  Matrix3<S> R;
  Vector3<S> p;

  PlacedShape<S> placed() const { return {&segment, R, p}; }
};

/// The edges along an axis that are furthest along a direction: two where a face is normal to it.
template <class S>
std::array<BoxEdge<S>, 2> furthest_edges(const PlacedShape<S>& box, const Vector3d& direction,
                                         int along, std::size_t& count) {
  std::array<BoxEdge<S>, 2> out;
  out[0].segment.half.z() = box.shape->half[along];
  for (int i = 0; i < 3; ++i) out[0].R.col(i) = box.R.col((along + 1 + i) % 3);
  out[0].p = support<S>(box, direction, along);
  count = 1;
  for (int i = 0; i < 2; ++i) {
    const Vector3d axis = plain<S>(out[0].R.col(i));
    const double slope = axis.dot(direction);
    if (std::abs(slope) > kSameGap) continue;
    out[1] = out[0];
    out[1].p -= out[0].R.col(i) * S(2 * sign_of(slope) * box.shape->half[(along + 1 + i) % 3]);
    count = 2;
  }
  return out;
}

/// The 15 axes that may separate two boxes: the faces' normals and the products of their edges.
struct WidestGap {
  double gap = -kInfinity;
  int i = -1, j = -1;  ///< of the first and the second box; -1: none
  /// Along the products of edges; -inf where they are parallel.
  std::array<std::array<double, 3>, 3> of_edges{};
};

template <class S>
WidestGap widest_gap(const PlacedShape<S>& first, const PlacedShape<S>& second) {
  const Matrix3d A = plain_axes<S>(first.R), B = plain_axes<S>(second.R);
  const Vector3d c = plain<S>(first.p) - plain<S>(second.p);
  const Matrix3d cosines = A.transpose() * B, sizes = cosines.cwiseAbs();
  const Vector3d c_A = A.transpose() * c, c_B = B.transpose() * c;
  const Vector3d &a = first.shape->half, &b = second.shape->half;
  const Vector3d of_first = c_A.cwiseAbs() - a - sizes * b;
  const Vector3d of_second = c_B.cwiseAbs() - b - sizes.transpose() * a;
  WidestGap out;
  const auto offer = [&](double gap, int i, int j) {
    if (!(gap > out.gap + 1e-12)) return;
    out.gap = gap;
    out.i = i;
    out.j = j;
  };
  for (int i = 0; i < 3; ++i) offer(of_first[i], i, -1);
  for (int j = 0; j < 3; ++j) offer(of_second[j], -1, j);
  for (int i = 0; i < 3; ++i) {
    const int k = (i + 1) % 3, l = (i + 2) % 3;
    for (int j = 0; j < 3; ++j) {
      // The product has the parts -cosines(l, j) and cosines(k, j) along the axes k and l of the
      // first box, and such ones along those of the second.
      const int m = (j + 1) % 3, n = (j + 2) % 3;
      const double length =
          std::sqrt(cosines(k, j) * cosines(k, j) + cosines(l, j) * cosines(l, j));
      const double apart = std::abs(c_A[l] * cosines(k, j) - c_A[k] * cosines(l, j));
      const double halves =
          a[k] * sizes(l, j) + a[l] * sizes(k, j) + b[m] * sizes(i, n) + b[n] * sizes(i, m);
      double& gap = out.of_edges[i][j];
      gap = length > 1e-6 ? (apart - halves) / length : -kInfinity;
      offer(gap, i, j);
    }
  }
  return out;
}

/// Of two boxes, as a distance: never above it, and negative where they overlap.
template <class S>
Separation<S> gap_of_boxes(const PlacedShape<S>& first, const PlacedShape<S>& second,
                           const WidestGap& widest) {
  using std::sqrt;
  const Vector3d c = plain<S>(first.p) - plain<S>(second.p);
  Separation<S> out;
  if (widest.j < 0) {
    const Vector3<S> axis = first.R.col(widest.i);
    out.normal = axis * S(sign_of(plain<S>(axis).dot(c)));
    out.point = support<S>(second, plain<S>(out.normal), -1);
    out.distance = out.normal.dot(first.p - out.point) - S(first.shape->half[widest.i]);
    return out;
  }
  if (widest.i < 0) {
    const Vector3<S> axis = second.R.col(widest.j);
    out.normal = axis * S(sign_of(plain<S>(axis).dot(c)));
    out.point = support<S>(first, -plain<S>(out.normal), -1);
    out.distance = out.normal.dot(out.point - second.p) - S(second.shape->half[widest.j]);
    return out;
  }
  const Vector3<S> u = first.R.col(widest.i), v = second.R.col(widest.j);
  Vector3<S> axis = u.cross(v);
  axis *= S(sign_of(plain<S>(axis).dot(c)));
  out.normal = axis / S(sqrt(axis.squaredNorm()));
  const Vector3d direction = plain<S>(out.normal);
  const Vector3<S> on_first = support<S>(first, -direction, widest.i);
  const Vector3<S> w = support<S>(second, direction, widest.j) - on_first;
  out.distance = -out.normal.dot(w);
  const S uv = u.dot(v);
  out.point = on_first + u * ((u.dot(w) - uv * v.dot(w)) / (S(1) - uv * uv));
  return out;
}

/// Two boxes that are apart: the distance of a corner from the other box or of two edges that
/// cross, and then it is the gap along the product of the two: only such edges are compared.
template <class S>
Separation<S> distance_of_boxes(const PlacedShape<S>& first, const PlacedShape<S>& second,
                                const WidestGap& widest) {
  Separation<S> out = nearest_corner(first, second);
  const Vector3d c = plain<S>(first.p) - plain<S>(second.p);
  for (int i = 0; i < 3; ++i) {
    for (int j = 0; j < 3; ++j) {
      if (!(widest.of_edges[i][j] > widest.gap - kSameGap)) continue;
      Vector3d axis = plain<S>(first.R.col(i)).cross(plain<S>(second.R.col(j))).normalized();
      axis *= sign_of(axis.dot(c));
      std::size_t of_first = 0, of_second = 0;
      const auto edges = furthest_edges<S>(first, -axis, i, of_first);
      const auto others = furthest_edges<S>(second, axis, j, of_second);
      for (std::size_t k = 0; k < of_first; ++k) {
        for (std::size_t l = 0; l < of_second; ++l) {
          const Separation<S> found = between_segments<S>(edges[k].placed(), others[l].placed());
          if (found.distance < out.distance) out = found;
        }
      }
    }
  }
  return out;
}

}  // namespace closed_form

/// Two shapes, each as a box or as what is round about its segment.
/// The boxes about cylinders have their widest gap: a lower bound is enough there.
template <class S>
Separation<S> separate_as(const PlacedShape<S>& first, bool first_is_box,
                          const PlacedShape<S>& second, bool second_is_box) {
  if (first_is_box && second_is_box) {
    const closed_form::WidestGap widest = closed_form::widest_gap(first, second);
    const bool is_exact = first.shape->is_box && second.shape->is_box && widest.gap > 0;
    return is_exact ? closed_form::distance_of_boxes(first, second, widest)
                    : closed_form::gap_of_boxes(first, second, widest);
  }
  if (!first_is_box && !second_is_box) return closed_form::between_segments(first, second);
  if (second_is_box) return closed_form::segment_and_box(first, second);
  Separation<S> out = closed_form::segment_and_box(second, first);
  out.normal = -out.normal;
  return out;
}

/// A capsule about a shape, its axis from one end to the other.
struct CapsuleAbout {
  Vector3d p, half_axis;
  double radius;
};
inline CapsuleAbout capsule_about(const PlacedShape<double>& shape) {
  const Vector3d& half = shape.shape->half;
  if (!shape.shape->is_box) return {shape.p, shape.R.col(2) * half.z(), shape.shape->radius};
  int longest = 0;
  half.maxCoeff(&longest);
  return {shape.p, shape.R.col(longest) * half[longest],
          std::sqrt(half.squaredNorm() - half[longest] * half[longest])};
}

/// Whether separate() is surely above a distance that is not negative, by simpler shapes about the
/// two: a sphere about one of them and a box, capsules.
inline bool is_beyond(const PlacedShape<double>& first, const PlacedShape<double>& second,
                      double distance) {
  const auto by_sphere = [distance](const PlacedShape<double>& box,
                                    const PlacedShape<double>& other) {
    return box.shape->is_box &&
           closed_form::box_distance(box.R.transpose() * (other.p - box.p), box.shape->half) -
                   other.shape->reach() >
               distance;
  };
  if (by_sphere(first, second) || by_sphere(second, first)) return true;
  const CapsuleAbout a = capsule_about(first), b = capsule_about(second);
  const closed_form::SegmentChoice nearest =
      closed_form::nearest_on_segments(a.p, a.half_axis, b.p, b.half_axis);
  const Vector3d apart = a.p + nearest.s * a.half_axis - b.p - nearest.t * b.half_axis;
  return apart.norm() - a.radius - b.radius > distance;
}

/// A cylinder is the intersection of the capsule and the box about it, so that neither of the two
/// is farther away from anything than the cylinder: the larger distance counts.
template <class S>
Separation<S> separate(const PlacedShape<S>& first, const PlacedShape<S>& second) {
  Separation<S> best;
  bool has_best = false;
  for (const bool a : {false, true}) {
    if (!first.shape->may_count_as(a)) continue;
    for (const bool b : {false, true}) {
      if (!second.shape->may_count_as(b)) continue;
      const Separation<S> found = separate_as<S>(first, a, second, b);
      if (has_best && !(found.distance > best.distance)) continue;
      best = found;
      has_best = true;
    }
  }
  return best;
}

}  // namespace stillbase
