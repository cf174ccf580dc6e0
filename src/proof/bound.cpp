#include "proof/bound.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <queue>

#include "proof/form_bounds.hpp"

namespace stillbase::proof {
namespace {

/// A box that has lost this much of its volume is looked at again before it is divided.
constexpr double kWorthwhile = 0.5;
constexpr int kMaxRounds = 6;
constexpr int kMaxMixtures = 4;
constexpr std::size_t kMaxMixed = 5;  ///< forms that are mixed

/// The equations, and what each two of them say without one of the variables.
template <int N>
std::vector<Quadratic<N>> with_eliminations(std::vector<Quadratic<N>> equations) {
  const std::size_t count = equations.size();
  for (std::size_t p = 0; p < count; ++p) {
    for (std::size_t q = p + 1; q < count; ++q) {
      for (int k = 0; k < N; ++k) {
        const double s = equations[q].a(k), t = equations[p].a(k);
        const double size = std::fmax(std::fabs(s), std::fabs(t));
        if (!(size > 0) || s == 0 || t == 0) continue;
        equations.push_back(equations[p] * Quadratic<N>(s / size) -
                            equations[q] * Quadratic<N>(t / size));
      }
    }
  }
  return equations;
}

/// f + sum lambda_j g_j + mu sum g_j^2 with the least slopes over the part (least squares), and
/// convex where the equations leave it so: what the g_j forbid costs nothing.
template <int N>
class Multipliers {
 public:
  Multipliers(const std::vector<Quadratic<N>>& equations, const Part<N>& part) : part_(part) {
    for (const Quadratic<N>& g : equations) {
      if (!g.is_bounded() || g.size_of(1) == 0 || rows_.size() == static_cast<std::size_t>(N)) {
        continue;
      }
      rows_.push_back(g);
    }
    if (rows_.empty()) return;
    const auto m = static_cast<Eigen::Index>(rows_.size());
    J_.resize(m, N);
    for (Eigen::Index j = 0; j < m; ++j) J_.row(j) = slopes(rows_[static_cast<std::size_t>(j)]);
    Eigen::MatrixXd normal = J_ * J_.transpose();
    normal.diagonal().array() += 1e-13 * normal.trace() + 1e-300;  // dependent rows are harmless
    ldlt_.compute(normal);
    // J's rows as if they were orthonormal: the squares then bend all forbidden directions alike.
    const Eigen::MatrixXd E = Eigen::MatrixXd::Identity(m, m);
    const Eigen::MatrixXd whitening = normal.llt().matrixL().solve(E);
    if (!whitening.allFinite()) return;
    for (Eigen::Index i = 0; i < m; ++i) {
      Quadratic<N> row;
      for (Eigen::Index j = 0; j <= i; ++j) {
        row += rows_[static_cast<std::size_t>(j)] * Quadratic<N>(whitening(i, j));
      }
      penalty_ += square(row);
    }
  }

  Quadratic<N> relieved(const Quadratic<N>& f) const {
    if (rows_.empty() || !f.is_bounded()) return f;
    const Eigen::VectorXd lambda = ldlt_.solve(-(J_ * slopes(f).transpose()));
    if (!lambda.allFinite()) return f;
    Quadratic<N> out = f;
    for (std::size_t j = 0; j < rows_.size(); ++j) {
      out += rows_[j] * Quadratic<N>(lambda[static_cast<Eigen::Index>(j)]);
    }
    const Quadratic<N> bent = out + penalty_ * Quadratic<N>(2 * out.size_of(2));
    const double before = least(f, part_), linear = least(out, part_), convex = least(bent, part_);
    if (convex > linear && convex > before) return bent;
    return linear > before ? out : f;
  }

 private:
  Eigen::Matrix<double, 1, N> slopes(const Quadratic<N>& form) const {
    Eigen::Matrix<double, 1, N> out;
    for (int i = 0; i < N; ++i) {
      double slope = form.a(i);
      for (int j = 0; j < N; ++j) {
        const double bend = form.q(std::min(i, j), std::max(i, j));
        slope += (i == j ? 2 : 1) * bend * middle(part_[j]);
      }
      out[i] = slope * width_of(part_[i]) / 2;
    }
    return out;
  }

  Part<N> part_;
  std::vector<Quadratic<N>> rows_;
  Quadratic<N> penalty_;
  Eigen::Matrix<double, Eigen::Dynamic, N> J_;
  Eigen::LDLT<Eigen::MatrixXd> ldlt_;
};

/// A convex combination whose least value over the part is as large as it gets by mixing one more
/// form at a time, of the few that are largest.
template <int N>
Quadratic<N> best_mixture(std::vector<Quadratic<N>> forms, const Part<N>& part) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = 0; k < forms.size(); ++k) order.emplace_back(-least(forms[k], part), k);
  std::sort(order.begin(), order.end());
  order.resize(std::min(order.size(), kMaxMixed));
  Quadratic<N> best = forms[order.front().second];
  double value = -order.front().first;
  for (int round = 0; round < kMaxMixtures && best.is_bounded(); ++round) {
    Quadratic<N> better = best;
    bool is_better = false;
    for (std::size_t k = 0; k < order.size(); ++k) {
      const Quadratic<N>& form = forms[order[k].second];
      if (!form.is_bounded()) continue;
      // Mixing is concave in t, with its bends about where a slope changes its sign.
      for (int i = 0; i < N; ++i) {
        if (!(best.a(i) * form.a(i) < 0)) continue;
        const double t = best.a(i) / (best.a(i) - form.a(i));
        if (!(t > 0 && t < 1)) continue;
        const Quadratic<N> mixed = mixture(best, form, t);
        const double reached = least(mixed, part);
        if (!(reached > value)) continue;
        better = mixed;
        value = reached;
        is_better = true;
      }
    }
    if (!is_better) break;
    best = better;
  }
  return best;
}

template <int N>
class Search {
 public:
  Search(const Program<N>& program, const BoundOptions& options)
      : program_(program), options_(options) {}

  Bound run(const std::vector<Box<N>>& domain) {
    for (const Box<N>& box : domain) look(box, -std::numeric_limits<double>::infinity());
    while (!open_.empty() && !(open_.top().lower >= options_.goal)) {
      if (out_.boxes >= options_.max_boxes || options_.stop.reached()) {
        out_.limit_reached = true;
        break;
      }
      const Node node = open_.top();
      open_.pop();
      divide(node);
    }
    double lower = set_aside_;
    if (!open_.empty()) lower = std::min(lower, open_.top().lower);
    out_.nothing_below_cut = lower >= options_.cut;
    out_.lower = std::min(lower, options_.cut);
    return out_;
  }

 private:
  struct Node {
    double lower;
    long serial;  ///< of equal bounds the first
    Box<N> box;
    bool operator<(const Node& other) const {
      return lower > other.lower || (lower == other.lower && serial > other.serial);
    }
  };

  /// Cuts the box, bounds what is left and puts it on the list.
  void look(Box<N> X, double lower) {
    for (int round = 0; round < kMaxRounds; ++round) {
      ++out_.boxes;
      Part<N> part;
      part.side.fill(Interval(-1, 1));
      if (!reduce(X, part, lower)) return;
      if (lower > options_.cut) return;
      const double before = volume(X);
      X = part_of(X, part);
      if (lower >= options_.goal || !(volume(X) <= kWorthwhile * before)) break;
    }
    if (width_of(X) <= options_.min_width) {
      set_aside_ = std::min(set_aside_, lower);
      return;
    }
    open_.push({lower, serial_++, X});
  }

  /// One evaluation; false: nothing of the box is left.
  bool reduce(const Box<N>& X, Part<N>& part, double& lower) {
    std::array<Form<N>, N> x;
    for (int i = 0; i < N; ++i) x[static_cast<std::size_t>(i)] = Form<N>(X[i], i);
    equations_.clear();
    values_.clear();
    program_.evaluate(x, equations_, values_);
    std::vector<Quadratic<N>> equations, excesses;
    for (const Form<N>& equation : equations_) equations.push_back(equation.template folded<2>());
    double weight = 0;  // largest q0 / denominator
    for (const Fraction<N>& value : values_) {
      const Interval denominators = value.denominator.range();
      const double least = std::fmax(value.least_denominator, denominators.lower());
      const double q0 = std::fmax(value.denominator.c(), least);
      const Form<N> excess = value.numerator - value.denominator * Form<N>(options_.cut);
      excesses.push_back((excess * Form<N>(1 / q0)).template folded<2>());
      weight = std::fmax(weight, q0 / least);
    }
    const std::vector<Quadratic<N>> rows = with_eliminations(equations);
    for (const Quadratic<N>& row : rows) {
      if (!cut_by_equation(row, part)) return false;
    }
    const Multipliers<N> multipliers(equations, part);
    for (Quadratic<N>& excess : excesses) excess = multipliers.relieved(excess);
    const Quadratic<N> mixed = best_mixture(excesses, part);
    if (!cut_above_zero(mixed, part)) return false;
    for (const Quadratic<N>& excess : excesses) {
      if (!cut_above_zero(excess, part)) return false;
    }
    for (const Quadratic<N>& row : rows) {
      if (!cut_by_equation(row, part)) return false;
    }
    // Of an f that is below the cut by d the excess is at most d denominator / q0 below zero.
    const double excess = least(mixed, part);
    const Interval below = Interval(options_.cut) + Interval(std::fmin(excess, 0)) * weight;
    lower = std::max(lower, below.lower());
    return true;
  }

  static Box<N> part_of(const Box<N>& X, const Part<N>& part) {
    Box<N> out;
    for (int i = 0; i < N; ++i) {
      const Quadratic<N> x(X[i], i);
      const Interval side = Interval(x.c()) + Interval(x.a(i)) * part[i];
      out[i] = is_disjoint(side, X[i]) ? X[i] : boost::numeric::intersect(side, X[i]);
    }
    return out;
  }

  static double volume(const Box<N>& X) {
    double product = 1;
    for (int i = 0; i < N; ++i) {
      if (width_of(X[i]) > 0) product *= width_of(X[i]);
    }
    return product;
  }

  void divide(const Node& node) {
    int widest = 0;
    for (int i = 1; i < N; ++i) {
      if (width_of(node.box[i]) > width_of(node.box[widest])) widest = i;
    }
    const Interval side = node.box[widest];
    const double split = middle(side);
    Box<N> left = node.box, right = node.box;
    left[widest] = Interval(side.lower(), split);
    right[widest] = Interval(split, side.upper());
    look(left, node.lower);
    look(right, node.lower);
  }

  const Program<N>& program_;
  const BoundOptions& options_;
  std::priority_queue<Node> open_;
  double set_aside_ = std::numeric_limits<double>::infinity();  ///< boxes too small to divide
  long serial_ = 0;
  std::vector<Form<N>> equations_;
  std::vector<Fraction<N>> values_;
  Bound out_;
};

}  // namespace

template <int N>
Bound bound_below(const Program<N>& program, const std::vector<Box<N>>& domain,
                  const BoundOptions& options) {
  return Search<N>(program, options).run(domain);
}

template Bound bound_below<2>(const Program<2>&, const std::vector<Box<2>>&, const BoundOptions&);
template Bound bound_below<3>(const Program<3>&, const std::vector<Box<3>>&, const BoundOptions&);

}  // namespace stillbase::proof
