// The equations of a problem as a system with as many rows as variables.
#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include <stillbase/core/random.hpp>

#include "proof/case_rows.hpp"
#include "proof/enclose.hpp"

namespace stillbase::proof {

template <int N>
class RowSystem final : public System<N> {
 public:
  RowSystem(const ZeroProblem& problem, const std::vector<Row>& rows, const Box<N>& domain)
      : problem_(problem), rows_(rows) {
    const std::vector<double> tolerances = row_tolerances(problem, rows, values_over(domain));
    std::copy(tolerances.begin(), tolerances.end(), tolerance_.begin());
  }

  void evaluate(const std::array<Dual, N>& x, std::array<Dual, N>& f) const override { fill(x, f); }
  bool evaluate(const std::array<Quadratic<N>, N>& x,
                std::array<Quadratic<N>, N>& f) const override {
    if constexpr (N == 1) {
      // As forms of two variables, the second of which does not occur: one type less to compile.
      std::array<Quadratic<2>, 1> wide{x[0].c()};
      wide[0].coefficient[1] = x[0].a(0);
      const Quadratic<2> row = evaluate_rows<Quadratic<2>>(problem_, rows_, wide).front();
      f[0].coefficient = {row.c(), row.a(0), row.q(0, 0)};
      f[0].r = row.r;
    } else {
      fill(x, f);
    }
    return true;
  }
  std::array<double, N> tolerance() const override { return tolerance_; }
  bool excludes(const Box<N>& box) const override { return kept_over(box) == Kept::No; }

  /// Whether the inequalities hold over a box.
  Kept kept_over(const Box<N>& box) const {
    const bool has_time = problem_.encounter.has(VariableKind::Time);
    const EquationTolerances known;
    return keeps_inequalities(problem_, values_over(box),
                              known.feasible + (has_time ? known.integrated : 0));
  }

 private:
  static std::array<Dual, N> values_over(const Box<N>& box) {
    std::array<Dual, N> x;
    for (int i = 0; i < N; ++i) x[static_cast<std::size_t>(i)] = Dual(box[i]);
    return x;
  }

  template <class S>
  void fill(const std::array<S, N>& x, std::array<S, N>& f) const {
    const std::vector<S> values = evaluate_rows<S>(problem_, rows_, x);
    std::copy(values.begin(), values.end(), f.begin());
  }

  const ZeroProblem& problem_;
  const std::vector<Row>& rows_;
  std::array<double, N> tolerance_{};
};

/// How it is decided whether to enclose at all, in plain doubles: no proof depends on it.
struct SurveyOptions {
  int samples = 16;     ///< points at which the sizes of the rows are taken
  double zero = 1e-10;  ///< rows below this part of the largest one of their kind say nothing
  int starts = 48;      ///< of Newton's steps
  int max_steps = 30;
  double longest_step = 0.5;  ///< rad
  double pivot = 1e-15;       ///< pivots below this part of the largest count as zero
  double solved = 1e-11;      ///< residual of the scaled rows
  double rank = 1e-7;         ///< singular values below this part of the largest count as zero
  int enough = 4;             ///< solutions of deficient rank that decide
};

/// The rows that say something, with their sizes, and the variables that they depend on.
template <int N>
struct Survey {
  std::vector<Row> rows;
  std::array<bool, N> matters{};
};

/// Sizes of the rows over evenly spread points; rows that vanish everywhere are dropped.
template <int N>
Survey<N> survey_of(const ZeroProblem& problem, std::vector<Row> rows) {
  const SurveyOptions options;
  const Box<N> domain = domain_of<N>(problem.encounter);
  const std::size_t num_rows = rows.size();
  for (int i = 0; i < 3; ++i) rows.push_back({RowKind::Total, i, Vector3d::Unit(i)});
  std::vector<double> size(rows.size(), 0);
  std::vector<std::array<double, N>> slopes(rows.size(), std::array<double, N>{});
  for (int sample = 0; sample < options.samples; ++sample) {
    const Eigen::VectorXd u = low_discrepancy_point(sample, N, 0);
    std::array<Dual, N> x;
    for (int i = 0; i < N; ++i) {
      const double at = domain[i].lower() + u[i] * (domain[i].upper() - domain[i].lower());
      x[static_cast<std::size_t>(i)] = Dual(Interval(at), i, N);
    }
    const auto values = evaluate_rows<Dual>(problem, rows, x);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      size[r] = std::max(size[r], boost::numeric::norm(values[r].v));
      for (std::size_t i = 0; i < N; ++i) {
        const double slope = boost::numeric::norm(values[r].d[i]);
        size[r] = std::max(size[r], slope);
        slopes[r][i] = std::max(slopes[r][i], slope);
      }
    }
  }
  Survey<N> out;
  for (std::size_t r = 0; r < num_rows; ++r) {
    // The base part is what remains of the total.
    const bool is_part = rows[r].kind == RowKind::Base;
    double largest = 0;
    for (std::size_t q = 0; q < rows.size(); ++q) {
      const bool is_larger = is_part && rows[q].kind == RowKind::Total;
      if (rows[q].kind == rows[r].kind || is_larger) largest = std::max(largest, size[q]);
    }
    if (!(size[r] > options.zero * largest)) continue;
    rows[r].scale = std::exp2(std::round(std::log2(size[r])));  // divides without rounding
    out.rows.push_back(rows[r]);
    for (std::size_t i = 0; i < N; ++i) {
      out.matters[i] = out.matters[i] || slopes[r][i] > options.zero * size[r];
    }
  }
  return out;
}

}  // namespace stillbase::proof
