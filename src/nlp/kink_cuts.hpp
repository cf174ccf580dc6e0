// What sequential quadratic programming knows of kinks.
//
// A least distance of bodies, min(g_1, g_2, ...) >= c, has a kink where two of its parts are equal.
// Its gradient at a point is that of one part, so a step along the kink leads across it, is
// rejected, and shorter ones are as well: the descent gets lost where it could go on. The
// linearisation at the far end of such a step is that of the other part. As a further row of the
// quadratic program, a cut, it keeps the next step on the kink, as in a bundle method (Mifflin, "A
// modification and an extension of Lemarechal's algorithm for nonsmooth minimization", Mathematical
// Programming Study 17, 1982). Where the rows and the cuts leave no descent there is a minimum at
// the kink, which a certificate cannot show that has the gradients of one point alone. Strong
// curvature looks the same from afar, but closer and closer to a kink the normal still jumps.
#pragma once

#include <functional>
#include <vector>

#include "nlp/sqp_sides.hpp"

namespace stillbase::nlp {

struct KinkOptions {
  int most = 12;         ///< cuts
  double turned = 0.05;  ///< change of a normal, of its length, from which a cut says something
  double kink = 100;     ///< the same per distance, in variables of order one: beyond curvature
  double reach = 0.5;    ///< distance to which a cut is believed
  int idle = 10;         ///< programs in a row that a cut may not limit
  int halvings = 3;      ///< of the way to a cut, to tell a kink from curvature
  double jump = 0.25;  ///< part of the change of the normal that is left then, of a kink; curvature
                       ///< leaves an eighth
};
inline constexpr KinkOptions kKinks;

/// The linearisation of an inequality at another point, beside that at the iterate.
struct Cut {
  std::size_t side;
  Eigen::VectorXd x, normal;
  double room;   ///< at x
  int idle = 0;  ///< programs in a row that it did not limit
};

class KinkCuts {
 public:
  /// @param sides have to live as long
  explicit KinkCuts(const std::vector<Side>& sides) : sides_(sides), is_kinked_(sides.size()) {}

  void clear() { cuts_.clear(); }
  const std::vector<Cut>& all() const { return cuts_; }
  /// Room of a cut at the iterate. No part of a least distance is smaller than it.
  double room_at(const SqpPoint& here, const Cut& cut) const;
  /// @param multiplier of the cut in a quadratic program
  void count(std::size_t cut, double multiplier);

  /// Takes the row of a trial point, which a step from the iterate led to. @return whether it says
  /// what the row at the iterate does not
  bool take(std::size_t side, const SqpPoint& here, const SqpPoint& trial);
  /// After a step: finds the kinks between both points, keeps the rows of the first one there, and
  /// forgets cuts that are of no use.
  /// @param multipliers of the rows at the first one: rows that did not limit the step do not count
  void follow(const SqpPoint& before, const SqpPoint& here, const Eigen::VectorXd& multipliers);
  /// Whether follow() found a kink: the change of this normal is no curvature.
  bool is_kinked(std::size_t side) const { return is_kinked_[side]; }

  /// The cuts that limited the last program.
  std::vector<std::size_t> limiting() const;
  /// Whether a cut is one of a kink, and not of curvature.
  /// @param look evaluates a point; null where it cannot
  bool is_kink(std::size_t cut, const SqpPoint& here,
               const std::function<const SqpPoint*(const Eigen::VectorXd&)>& look) const;
  void forget(std::size_t cut);

 private:
  void add(std::size_t side, const SqpPoint& from);
  bool is_like(const Cut& cut, const SqpPoint& point) const;

  const std::vector<Side>& sides_;
  std::vector<Cut> cuts_;
  std::vector<bool> is_kinked_;
};

}  // namespace stillbase::nlp
