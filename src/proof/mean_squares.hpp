// Means of |y|^2 over many impulses, of which a box of configurations takes little longer than of a
// single one.
#pragma once

#include <cmath>
#include <vector>

#include "proof/response_gram.hpp"

namespace stillbase::proof {

/// Lower bounds of |y_k|^2 = (scale |Y| / D)^2 of the impulses, in three ways.
///
/// As fractions of one denominator D_0^2: the divisor D of every impulse is nearly in proportion to
/// that of the first basis wrench, D_0. With D / D_0 = (1 + e) / q the numerators are multiplied by
///   q^2 / (1 + e)^2 >= q^2 / (1 + largest e)^2        a number, so that a mean is quadratic in the
///                                                     wrench as well
///                   >= q^2 (1 - 2 e + 3 e^2 - 4 e^3)  right to second order; of all e > -1
/// As numbers, where all of it changes much: |Y| >= s D at every point or not, per impulse.
template <int N>
class MeanSquares {
 public:
  using T = Quadratic<N>;

  /// @param level of the root of the mean, where it has to be sharp
  /// @param gram, impulses, weights outlive this
  MeanSquares(const ResponseGram<Form<N>>& gram, const std::vector<ImpulseCase>& impulses,
              const std::vector<PairWeights>& weights, double level,
              const MinimumTolerances& tolerances = {})
      : gram_(gram),
        low_(folded(gram)),
        impulses_(impulses),
        weights_(weights),
        level_(level),
        tolerances_(tolerances),
        least_factors_(impulses.size(), Interval(1.0)) {
    for (std::size_t k = 0; k < impulses.size(); ++k) {
      numerators_.push_back(low_.square_of(weights[k]) * square(low_.scale_of(impulses[k])));
    }
    if (is_contact()) {
      compare_divisors();
    } else {
      squares_ = numerators_;
    }
  }

  /// Per impulse, by which they may be compared.
  const std::vector<T>& squares() const { return squares_; }

  /// @param shares of the impulses, of sum one
  void add_mean(const std::vector<double>& shares, std::vector<Fraction<N>>& values) const {
    add_quick_mean(shares, values);
    if (!is_sharp_) return;
    T sum;
    for (std::size_t k = 0; k < shares.size(); ++k) {
      if (shares[k] > 0) sum += squares_[k] * T(shares[k]);
    }
    values.push_back({Form<N>(sum), square(D_0_), square_of_least()});
  }

  /// Numbers that the squares are nowhere below.
  /// @param shares of the impulses in the middle of the box
  /// @pre is_contact()
  std::vector<double> least_squares(const std::vector<double>& shares) const {
    std::vector<double> ratios;  // |y_k| at the middle
    double mean = 0;
    for (std::size_t k = 0; k < impulses_.size(); ++k) {
      const double D = divisors_[k].c();
      const double square = std::fmax(numerators_[k].c(), 0) / (D * D);
      ratios.push_back(std::sqrt(square));
      mean += shares[k] * square;
    }
    std::vector<double> out(impulses_.size(), 0.0);
    if (!(mean > 0)) return out;
    const double part_of_middle = level_ * (1 + tolerances_.above_level) / std::sqrt(mean);
    for (std::size_t k = 0; k < impulses_.size(); ++k) {
      out[k] = least_square(k, ratios[k] * part_of_middle);
    }
    return out;
  }

  bool is_contact() const { return impulses_.front().target_inverse_mass.has_value(); }

 private:
  void compare_divisors() {
    least_ = *impulses_.front().target_inverse_mass;
    D_0_ = gram_.W.front() + Form<N>(least_);
    const double least = std::fmax(D_0_.range().lower(), least_);
    const Form<N> inverse = inverse_of(D_0_);
    is_sharp_ = inverse.is_bounded() && D_0_.size_of(1) < tolerances_.nearly_constant * D_0_.c();
    const T low_D_0 = D_0_.folded(), low_inverse = inverse.folded();
    for (std::size_t k = 0; k < impulses_.size(); ++k) {
      const T D = low_.divisor_of(impulses_[k], weights_[k]);
      divisors_.push_back(D);
      double q = D_0_.c() / D.c();
      if (!(q > 0) || !std::isfinite(q)) q = 1;  // any positive number does
      const T off = D * T(q) - low_D_0;
      const T e = off * low_inverse;
      const Interval crude = Interval(std::fmax(off.range().upper(), 0.0)) / Interval(least);
      const Interval largest(std::fmin(e.range().upper(), crude.upper()));
      const Interval factor = Interval(q) / (Interval(1.0) + largest);
      least_factors_[k] = Interval((factor * factor).lower());
      if (!is_sharp_) {
        squares_.push_back(numerators_[k] * T::any(least_factors_[k]));
        continue;
      }
      const T below = square(e) * (T(3.0) - e * T(4.0)) - e * T(2.0) + T(1.0);
      squares_.push_back(numerators_[k] * below * T::any(Interval(q) * q));
    }
  }

  double square_of_least() const { return (Interval(least_) * least_).lower(); }

  /// With the least factors.
  void add_quick_mean(const std::vector<double>& shares, std::vector<Fraction<N>>& values) const {
    T of_each;
    Interval all(0.0);
    PairWeights pairs(gram_.y.size(), Interval(0.0));
    for (std::size_t k = 0; k < shares.size(); ++k) {
      if (!(shares[k] > 0)) continue;
      const Interval share = least_factors_[k] * shares[k];
      if (impulses_[k].closing) {
        of_each += numerators_[k] * T::any(share);
        continue;
      }
      const Interval factor = share * boost::numeric::square(Interval(impulses_[k].numerator));
      all += factor;
      for (std::size_t pair = 0; pair < pairs.size(); ++pair) {
        pairs[pair] += weights_[k][pair] * factor;
      }
    }
    const bool is_constant = !impulses_.front().closing;
    values.push_back({is_constant ? gram_.square_of(pairs, all) : Form<N>(of_each), square(D_0_),
                      square_of_least(), is_contact()});
    if (!is_constant) return;
    values.push_back(tangent(gram_.part_along_middle(pairs, all), D_0_, least_, level_));
  }

  /// @param s that |Y| / D will hardly be below
  double least_square(std::size_t k, double s) const {
    const double scale = std::fmax(low_.scale_of(impulses_[k]).range().lower(), 0.0);
    const T part = low_.part_along_middle(weights_[k]) * T(scale);
    const Interval off = (part - divisors_[k] * T(s)).range();
    const Interval least = Interval(s) + Interval(std::fmin(off.lower(), 0.0)) /
                                             Interval(*impulses_[k].target_inverse_mass);
    return least.lower() > 0 ? (least * least).lower() : 0;
  }

  const ResponseGram<Form<N>>& gram_;
  const ResponseGram<T> low_;
  const std::vector<ImpulseCase>& impulses_;
  const std::vector<PairWeights>& weights_;
  const double level_;
  const MinimumTolerances tolerances_;
  std::vector<T> numerators_;            ///< of the impulses' own fractions
  std::vector<T> divisors_;              ///< D; of given impulses empty
  std::vector<Interval> least_factors_;  ///< by which the numerators are multiplied at least
  std::vector<T> squares_;               ///< with D_0^2 for denominator
  bool is_sharp_ = false;                ///< that they are right to second order
  Form<N> D_0_ = 1.0;
  double least_ = 1;  ///< D_0 is nowhere below
};

}  // namespace stillbase::proof
