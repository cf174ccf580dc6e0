#include "approach/geometric_path.hpp"

#include <algorithm>

namespace stillbase {

namespace {

Piece line(const JointVectord& from, const JointVectord& to) {
  const double length = (to - from).norm();
  const JointVectord zero = JointVectord::Zero(from.size());
  if (length == 0) return {from, zero, zero, zero, 0, false};
  return {from, (to - from) / length, zero, zero, length, false};
}

/// The corner between the directions d1 and d2, cut on both sides.
Piece parabola(const JointVectord& corner, const JointVectord& d1, const JointVectord& d2,
               double cut) {
  return {corner - cut * d1, d1,  (d2 - d1) / (4 * cut), JointVectord::Zero(corner.size()),
          2 * cut,           true};
}

bool is_clear_along(const Piece& piece, const IsClear& is_clear, int checks) {
  JointVectord last = piece.a;
  for (int i = 1; i <= checks; ++i) {
    const JointVectord next = piece.at(piece.length * i / checks);
    if (!is_clear(last, next)) return false;
    last = next;
  }
  return true;
}

}  // namespace

std::vector<Section> round_corners(const std::vector<JointVectord>& points, const IsClear& is_clear,
                                   const TimeLawOptions& options) {
  std::vector<Section> sections(1);
  sections.back().begin = points.front();
  JointVectord from = points.front();
  for (std::size_t i = 1; i < points.size(); ++i) {
    const JointVectord& corner = points[i];
    if (i + 1 == points.size()) {
      sections.back().pieces.push_back(line(from, corner));
      sections.back().end = corner;
      break;
    }
    const JointVectord in = corner - points[i - 1], out = points[i + 1] - corner;
    const JointVectord d1 = in.normalized(), d2 = out.normalized();
    double cut = std::min({options.largest_cut, 0.45 * in.norm(), 0.45 * out.norm()});
    bool rounded = false;
    // Turning straight back cannot be rounded: the parabola would stand still at its tip.
    if ((d1 + d2).norm() < 0.05) cut = 0;
    for (; cut > options.smallest_cut; cut /= 2) {
      const Piece piece = parabola(corner, d1, d2, cut);
      if (!is_clear_along(piece, is_clear, options.corner_checks)) continue;
      sections.back().pieces.push_back(line(from, piece.a));
      sections.back().pieces.push_back(piece);
      from = corner + cut * d2;
      rounded = true;
      break;
    }
    if (!rounded) {
      sections.back().pieces.push_back(line(from, corner));
      sections.back().end = corner;
      sections.emplace_back();
      sections.back().begin = corner;
      from = corner;
    }
  }
  return sections;
}

JointPath over_length(const JointPath& curve) {
  constexpr double kStill = 1e-7;  // rad, and rad per unit of the parameter
  JointPath out;
  double sigma = 0;
  for (std::size_t i = 0; i < curve.phi.size(); ++i) {
    const double speed = curve.phidot[i].norm();
    const bool is_end = i == 0 || i + 1 == curve.phi.size();
    if (i > 0) {
      const double chord = (curve.phi[i] - out.phi.back()).norm();
      if (!(chord > kStill) || (speed < kStill && !is_end)) continue;
      sigma += chord;
    }
    out.times.push_back(sigma);
    out.phi.push_back(curve.phi[i]);
    out.phidot.push_back(curve.phidot[i]);
  }
  out.phi.back() = curve.phi.back();
  // At rest the rate says nothing about the direction: there it is that of the chord.
  for (std::size_t i = 0; i < out.phi.size() && out.segments() > 0; ++i) {
    const std::size_t beside = i + 1 < out.phi.size() ? i : i - 1;
    const JointVectord chord = out.phi[beside + 1] - out.phi[beside];
    JointVectord& slope = out.phidot[i];
    slope = slope.norm() < kStill ? chord.normalized() : slope.normalized();
  }
  return out;
}

Section smooth_section(const JointPath& curve) {
  Section section;
  section.begin = curve.phi.front();
  section.end = curve.phi.back();
  for (std::size_t i = 0; i < curve.segments(); ++i) {
    const double h = curve.times[i + 1] - curve.times[i];
    const JointVectord rise = (curve.phi[i + 1] - curve.phi[i]) / h;
    const JointVectord &s0 = curve.phidot[i], &s1 = curve.phidot[i + 1];
    section.pieces.push_back(
        {curve.phi[i], s0, (3 * rise - 2 * s0 - s1) / h, (s0 + s1 - 2 * rise) / (h * h), h, true});
  }
  return section;
}

}  // namespace stillbase
