// Wrenches of which all impulses are combinations: what an impulse does is linear in them.
//
// The first one is near all impulses and the others are multiplied by what an impulse differs from
// it: coefficients are then as small as the uncertainty, and remainders do not grow.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "proof/interval.hpp"
#include "proof/minimum_problem.hpp"

namespace stillbase::proof {

/// F = sum c_i wrenches[i] per impulse, as products of its coefficients: for every pair i <= j, in
/// the order 00, 01, ..., 11, ..., c_i c_j, twice where i < j.
using PairWeights = std::vector<Interval>;

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

}  // namespace stillbase::proof
