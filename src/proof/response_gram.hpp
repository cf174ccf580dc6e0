// What impulses do over a box: |y|^2 and F' W_h F are quadratic in the wrench, so that their values
// for the pairs of a few basis wrenches say everything about all impulses.
//
//   F = sum c_i w_i:  |y|^2 = sum_ij c_i c_j y_i' y_j,  F' W_h F = sum_ij c_i c_j w_i' W_h w_j.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <vector>

#include "proof/minimum_problem.hpp"

namespace stillbase::proof {

/// F = sum c_i wrenches[i] per impulse, as products of its coefficients: for every pair i <= j, in
/// the order 00, 01, ..., 11, ..., c_i c_j, twice where i < j.
using PairWeights = std::vector<Interval>;

/// Wrenches of which all impulses are combinations: what an impulse does is linear in them. The
/// first one is near all impulses and the others are multiplied by what an impulse differs from it:
/// coefficients are then as small as the uncertainty, and remainders do not grow.
struct WrenchBasis {
  std::vector<Vector6d> wrenches;
  std::vector<PairWeights> weights;  ///< per impulse

  /// @pre a RoundUpward stands on the stack; impulses are not empty
  explicit WrenchBasis(const std::vector<ImpulseCase>& impulses) {
    Vector6d first = Vector6d::Zero();
    for (const ImpulseCase& impulse : impulses) first += impulse.F;
    first /= static_cast<double>(impulses.size());
    int largest = 0;
    first.head<3>().cwiseAbs().maxCoeff(&largest);
    if (impulses.size() == 1 || first[largest] == 0) {
      first = impulses.front().F;
      first.head<3>().cwiseAbs().maxCoeff(&largest);
    }
    // F = c_0 first + sum c_i e_i but for one unit wrench, which the first one takes the place of.
    std::vector<std::array<Interval, 6>> coefficients;
    std::array<bool, 6> counts{};
    for (const ImpulseCase& impulse : impulses) {
      std::array<Interval, 6> c;
      c[largest] = Interval(impulse.F[largest]) / Interval(first[largest]);
      for (int i = 0; i < 6; ++i) {
        if (i == largest) continue;
        c[i] = Interval(impulse.F[i]) - c[largest] * first[i];
        counts[i] = counts[i] || c[i].lower() != 0 || c[i].upper() != 0;
      }
      coefficients.push_back(c);
    }
    std::vector<int> chosen = {largest};
    wrenches = {first};
    for (int i = 0; i < 6; ++i) {
      if (!counts[i]) continue;
      chosen.push_back(i);
      wrenches.push_back(Vector6d::Unit(i));
    }
    for (const std::array<Interval, 6>& c : coefficients) {
      PairWeights& out = weights.emplace_back();
      for (std::size_t i = 0; i < chosen.size(); ++i) {
        out.push_back(boost::numeric::square(c[chosen[i]]));
        for (std::size_t j = i + 1; j < chosen.size(); ++j) {
          out.push_back(c[chosen[i]] * c[chosen[j]] * 2.0);
        }
      }
    }
  }
};

/// @tparam T forms of any degree
template <class T>
struct ResponseGram {
  std::vector<std::vector<T>> components;    ///< per wrench, y_i with the sizes of the terms
  std::vector<T> y;                          ///< per pair, y_i' y_j
  std::vector<T> W;                          ///< per pair, w_i' W_h w_j; of a given impulse empty
  T constant;                                ///< what every impulse of size one adds to |y|^2
  Vector3<T> target_velocity, target_omega;  ///< in T; with the time free

  /// sum weights y_i' y_j + share constant: |y|^2 per unit of impulse, or of several.
  T square_of(const PairWeights& weights, const Interval& share = 1.0) const {
    return sum_of(y, weights, constant * T::any(share));
  }

  /// F' W_h F + target_inverse_mass
  T divisor_of(const ImpulseCase& impulse, const PairWeights& weights) const {
    return sum_of(W, weights, *impulse.target_inverse_mass);
  }

  /// Of a contact law p = scale / divisor: (1+e) v_n; of a given impulse the impulse itself.
  T scale_of(const ImpulseCase& impulse) const {
    T out(impulse.numerator);
    if (!impulse.closing) return out;
    const Vector3<T> r = impulse.closing->point.cast<T>();
    const Vector3<T> velocity = target_velocity + target_omega.cross(r);
    const T speed = Vector3<T>(impulse.F.head<3>().cast<T>()).dot(velocity);
    return out * (speed + T(impulse.closing->offset)).positive_part();
  }

  /// What the root of square_of() is nowhere below: it is |Y| of some vector Y, and by Cauchy and
  /// Schwarz |Y| is nowhere below its part along the Y of the box's middle.
  T part_along_middle(const PairWeights& weights, const Interval& share = 1.0) const {
    // Y of the middle times Y, to be divided by the size of the former.
    const Interval square = (Interval(constant.c()) + Interval(-constant.r, constant.r)) * share;
    T along = T::any(square);
    Interval norm_squared = square;
    const std::size_t count = components.size();
    for (std::size_t c = 0; c < components.front().size(); ++c) {
      std::vector<Interval> slopes(count, Interval(0.0));
      std::size_t pair = 0;
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = i; j < count; ++j, ++pair) {
          const Interval half = weights[pair] / 2.0;
          slopes[i] += half * components[j][c].c();
          slopes[j] += half * components[i][c].c();
        }
      }
      for (std::size_t i = 0; i < count; ++i) {
        const T& component = components[i][c];
        if (component.is_zero()) continue;
        along += component * T::any(slopes[i]);
        norm_squared += slopes[i] * component.c();
      }
    }
    return along * T::any(Interval(1.0) / std::sqrt(norm_squared.upper()));  // rounded up
  }

 private:
  static T sum_of(const std::vector<T>& forms, const PairWeights& weights, T sum) {
    for (std::size_t pair = 0; pair < forms.size(); ++pair) {
      if (!forms[pair].is_zero()) sum += forms[pair] * T::any(weights[pair]);
    }
    return sum;
  }
};

template <int N>
ResponseGram<Quadratic<N>> folded(const ResponseGram<Form<N>>& gram) {
  using T = Quadratic<N>;
  const auto fold = [](const Form<N>& form) { return form.folded(); };
  const auto fold_all = [&](const std::vector<Form<N>>& forms) {
    std::vector<T> out;
    std::transform(forms.begin(), forms.end(), std::back_inserter(out), fold);
    return out;
  };
  ResponseGram<T> out;
  for (const std::vector<Form<N>>& each : gram.components) out.components.push_back(fold_all(each));
  out.y = fold_all(gram.y);
  out.W = fold_all(gram.W);
  out.constant = fold(gram.constant);
  for (int i = 0; i < 3; ++i) {
    out.target_velocity[i] = fold(gram.target_velocity[i]);
    out.target_omega[i] = fold(gram.target_omega[i]);
  }
  return out;
}

/// (|Y| / D)^2 >= 2 level |Y| / D - level^2, with equality where |Y| / D has that level: of wide
/// boxes that says more than squares do.
/// @param part what |Y| is nowhere below
template <int N>
Fraction<N> tangent(const Form<N>& part, const Form<N>& D, double least_D, double level) {
  const Interval square = Interval(level) * level;
  return {part * Form<N>(2 * level) - D * Form<N>::any(square), D, least_D, true};
}

/// The square of one impulse's y.
template <int N>
void add_square(const ResponseGram<Form<N>>& gram, const ImpulseCase& impulse,
                const PairWeights& weights, double level, std::vector<Fraction<N>>& values) {
  const Form<N> scale = gram.scale_of(impulse);
  Form<N> D = 1.0;
  double least = 1;
  if (impulse.target_inverse_mass) {
    D = gram.divisor_of(impulse, weights);
    least = *impulse.target_inverse_mass;
  }
  values.push_back({gram.square_of(weights) * square(scale), square(D),
                    (Interval(least) * Interval(least)).lower()});
  const Form<N> part = gram.part_along_middle(weights) * scale;
  values.push_back(tangent(part, D, least, level));
}

}  // namespace stillbase::proof
