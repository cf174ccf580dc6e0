// The attitude of the target over a span of time: the exact motion, enclosed.
//
// Without torque the angular momentum L in T and the attitude R = R_NT obey
//   L' = L x omega,  R' = R [omega x],  omega = I^-1 L.
// About a principal axis omega is constant and the rotation is written down. So it is for a body
// with an axis of symmetry e and the moments A along and B across it (both principal axes of T):
// with nutation = (A - B)/B (omega_0 . e) e and precession = L_0/B = omega_0 + nutation
//   R(t) = R_0 exp([precession x] t) exp(-[nutation x] t),  omega(t) = exp([nutation x] t) omega_0.
// Otherwise the motion is enclosed step by step:
//  - From a point (a pair of doubles) one step of length h is a Taylor sum in interval arithmetic.
//    |L| and the rows of R keep their length, so with a = |I^-1| |L| the k-th Taylor coefficients
//    are at most a^k |L| and a^k at all times (induction over the recurrence): the remainder after
//    p terms is at most (a h)^p of that.
//  - The true motion starts within delta of that point. Two motions L_1, L_2 part no faster than
//    d/dt |L_1 - L_2| <= mu |L_1 - L_2|, mu = |L| |I^-1 - c E| for any c, for
//    (L_1 - L_2) . (L_1' - L_2') = (L_1 - L_2) . (L_1 x (omega_1 - omega_2)),
//    and attitudes part by |R_1 - R_2|' <= sqrt(2) |R| |omega_1 - omega_2|.
//    Distances are propagated, not boxes: nothing wraps.
// Over a wider span the Taylor sum about its middle is taken (Moore, Interval Analysis, 1966).
//
// The planner's own motion (target/target.hpp) is the same one integrated in floating point; it
// stays within 1e-9 of these enclosures (tests/proof).
#pragma once

#include <array>
#include <vector>

#include <stillbase/target/target.hpp>

#include "proof/dual.hpp"

namespace stillbase::proof {

/// Enclosures over one span of time.
struct SpinRange {
  Matrix3<Dual> R;           ///< R_NT
  Matrix3<Dual> R_rate;      ///< 1/s
  Vector3<Dual> omega;       ///< in T, rad/s
  Vector3<Dual> omega_rate;  ///< in T, rad/s^2
};

/// Taylor's series about an instant: coefficients of orders 0 to 4 there, and the one of order 5
/// over a span of time, which makes the sum exact for every time of the span.
struct SpinSeries {
  static constexpr std::size_t kTerms = 6;
  std::array<Matrix3<Dual>, kTerms> R;      ///< R_NT, 1/s^k
  std::array<Vector3<Dual>, kTerms> omega;  ///< in T, rad/s^(k+1)
  SpinRange whole;                          ///< over the span
};

/// Accuracy of the enclosure of a motion that has no closed form.
struct SpinOptions {
  double turn_per_step = 0.1;  ///< rad: a h of a step
  int terms = 16;              ///< of a step: turn_per_step^16 is below the rounding
  int terms_over_span = 8;     ///< about the middle of a span
  /// a r of a span, beyond which the sum says less than |R_ij| <= 1.
  double worth_expanding = 2;
  int max_steps = 20000;
  double max_apart = 1e-7;  ///< of an attitude: solutions could hardly be told apart
};

class SpinEnclosure {
 public:
  /// @param estimate its attitude at its time as the rotation matrix of doubles; its rate
  /// @param lower, upper of the times to be enclosed, s
  SpinEnclosure(const TargetBody& body, const TargetState& estimate, double lower, double upper,
                const SpinOptions& options = {});

  /// No: the target tumbles so often that its attitude is not enclosed to SpinOptions::max_apart.
  bool is_valid() const { return is_valid_; }
  /// Bound on |omega|, rad/s.
  double rate() const { return rate_; }
  /// @param time where it leaves the span, only bounds that hold at all times come back
  /// @pre a RoundUpward stands on the stack; is_valid()
  SpinRange over(const Interval& time) const;
  /// @param about an instant within the span
  SpinSeries series(double about, const Interval& time) const;

 private:
  /// Taylor coefficients from a point. L only of a motion without a closed form.
  struct Coefficients {
    std::vector<Matrix3<Dual>> R;
    std::vector<Vector3<Dual>> omega, L;
  };
  /// A step, and how far the true motion may be from its sums.
  struct Node {
    double time = 0;
    Coefficients at;
    double apart_L = 0, apart_R = 0;  ///< during the step that begins here
  };
  struct State {
    Vector3<Dual> L;
    Matrix3<Dual> R;
  };
  /// @param first L, or omega of a motion in closed form
  Coefficients expand(const Matrix3<Dual>& R, const Vector3<Dual>& first, int terms) const;
  /// Steps away from the estimate until `end`; false: the enclosure has become too wide.
  bool march(const State& start, double end, std::vector<Node>& nodes) const;
  /// The sums at s after the node's time, with their remainders and what the motions are apart.
  State sum_of(const Node& node, const Interval& s, double apart_L, double apart_R) const;
  State at_instant(double time) const;
  SpinRange closed_form(const Interval& time) const;

  SpinOptions options_;
  bool is_valid_ = true;
  double start_ = 0;  ///< time of the estimate
  double lower_ = 0, upper_ = 0;
  /// Constant rate (precession omega_0, no nutation) or an axis of symmetry.
  bool has_closed_form_ = true;
  Vector3<Dual> precession_, nutation_;  ///< in T, rad/s
  Vector3<Dual> omega_0_;                ///< in T
  Matrix3d R_0_;
  Matrix3<Dual> I_, J_;               ///< inertia and its inverse, in T
  double momentum_ = 0;               ///< bound on |L|
  double rate_ = 0;                   ///< bound on |omega|: |I^-1| momentum_
  double parting_ = 0;                ///< mu, 1/s
  double step_ = 0;                   ///< s
  std::vector<Node> ahead_, behind_;  ///< of the estimate, nearest first
};

}  // namespace stillbase::proof
