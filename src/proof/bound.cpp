#include "proof/bound.hpp"

#include <algorithm>
#include <optional>
#include <queue>

#include <stillbase/core/parallel.hpp>

#include "proof/dense.hpp"
#include "proof/form_bounds.hpp"

namespace stillbase::proof {
namespace {

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
  Multipliers(const std::vector<Quadratic<N>>& equations, const Part<N>& part,
              double dependent_rows)
      : part_(part) {
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
    normal_ = J_ * J_.transpose();
    normal_.diagonal().array() += dependent_rows * normal_.trace() + 1e-300;
    // J's rows as if they were orthonormal: the squares then bend all forbidden directions alike.
    const Eigen::MatrixXd whitening = inverse_cholesky_factor(normal_);
    if (whitening.size() == 0) return;
    for (Eigen::Index i = 0; i < m; ++i) {
      Quadratic<N> row;
      for (Eigen::Index j = 0; j <= i; ++j) {
        row += rows_[static_cast<std::size_t>(j)] * Quadratic<N>(whitening(i, j));
      }
      penalty_ += row.squared();
    }
  }

  Quadratic<N> relieved(const Quadratic<N>& f) const {
    if (rows_.empty() || !f.is_bounded()) return f;
    const Eigen::VectorXd lambda = solve_symmetric(normal_, -(J_ * slopes(f).transpose()));
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
  Eigen::MatrixXd normal_;  ///< J J'
};

/// A convex combination whose least value over the part is as large as it gets by mixing one more
/// form at a time, of the few that are largest.
template <int N>
Quadratic<N> best_mixture(const std::vector<Quadratic<N>>& forms, const Part<N>& part,
                          const BoundOptions& options) {
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t k = 0; k < forms.size(); ++k) order.emplace_back(-least(forms[k], part), k);
  std::sort(order.begin(), order.end());
  order.resize(std::min(order.size(), options.max_mixed));
  Quadratic<N> best = forms[order.front().second];
  double value = -order.front().first;
  for (int round = 0; round < options.max_mixtures && best.is_bounded(); ++round) {
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
        const Quadratic<N> mixed = best.mixed(form, t);
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
      : program_(program), options_(options), goal_(options.goal) {}

  Bound run(const std::vector<Box<N>>& domain) {
    std::vector<Node> boxes;
    boxes.reserve(domain.size());
    for (const Box<N>& box : domain) {
      boxes.push_back({.lower = -kInfinity, .serial = 0, .box = box});
    }
    examine_all(boxes);
    while (!open_.empty() && !(open_.top().lower >= goal_) && out_.suspects.empty()) {
      if (out_.boxes >= options_.max_boxes || options_.stop.reached()) {
        out_.limit_reached = true;
        break;
      }
      if (options_.on_progress) options_.on_progress(out_.boxes);
      // So many at a time whatever the number of threads: the same answer anywhere.
      boxes.clear();
      while (boxes.size() < options_.at_a_time && !open_.empty() && !(open_.top().lower >= goal_)) {
        if (boxes.size() < 2 * options_.asked_at_a_time) add_values(open_.top());
        divide(open_.top(), boxes);
        open_.pop();
      }
      examine_all(boxes);
    }
    double lower = undivided_;
    if (!open_.empty()) lower = std::min(lower, open_.top().lower);
    out_.nothing_below_cut = lower >= options_.cut;
    out_.lower = std::min(lower, options_.cut);
    while (out_.limit_reached && !open_.empty() && out_.suspects.size() < options_.max_suspects) {
      out_.suspects.push_back(middle_of(open_.top().box));
      open_.pop();
    }
    return out_;
  }

 private:
  struct Node {
    double lower;
    long serial;  ///< of equal bounds the first
    Box<N> box;
    std::array<double, N> bends{};   ///< of the first f_k: what halving a side would lessen
    std::array<double, N> middle{};  ///< of the box as it was examined
    double at_middle = kInfinity;    ///< upper bound of max_k f_k there
    bool is_constrained = false;     ///< there are equations: the middle need not solve them
    bool operator<(const Node& other) const {
      return lower > other.lower || (lower == other.lower && serial > other.serial);
    }
  };

  /// A box after its examination.
  struct Examined {
    Node node;
    bool is_left = true;  ///< not wholly above the cut
    long evaluations = 0;
    double first_middle = kInfinity;  ///< Node::at_middle of the whole box
    bool is_below_goal = false;       ///< so it is, and no equation forbids that point
  };

  /// Cuts boxes, bounds what remains and puts it on the list.
  void examine_all(const std::vector<Node>& boxes) {
    std::vector<Examined> results(boxes.size());
    const std::size_t worthwhile = boxes.size() / options_.boxes_per_thread;
    const int jobs = std::min(jobs_or_processors(options_.jobs), static_cast<int>(worthwhile));
    for_each_index(jobs, static_cast<int>(boxes.size()), {}, [&](int i) {
      const RoundUpward upward;  // each thread has a mode of its own
      const auto k = static_cast<std::size_t>(i);
      results[k] = examine(boxes[k]);
    });
    for (std::size_t i = 0; i < results.size(); ++i) {
      Examined& seen = results[i];
      out_.boxes += seen.evaluations;
      if (seen.is_below_goal) {
        try_point(middle_of(boxes[i].box));
        if (!options_.add_values) expect_at_most(seen.first_middle);
      }
      if (!seen.is_left) continue;
      if (width_of(seen.node.box) <= options_.min_width) {
        undivided_ = std::min(undivided_, seen.node.lower);
        continue;
      }
      seen.node.serial = serial_++;
      open_.push(seen.node);
    }
  }

  void try_point(const Eigen::VectorXd& x) {
    if (!options_.value_at || !out_.suspects.empty()) return;
    const RoundToNearest nearest;
    if (options_.value_at(x) < options_.goal) out_.suspects.push_back(x);
  }

  /// Asks for the f_k that are missing at the middle of a box.
  void add_values(const Node& node) {
    if (!options_.add_values || !out_.suspects.empty() || !(node.at_middle < goal_)) return;
    const double worth = options_.worth_adding * (options_.cut - options_.goal);
    const Eigen::VectorXd x = Eigen::Map<const Eigen::VectorXd>(node.middle.data(), N);
    const RoundToNearest nearest;
    const double largest = options_.add_values(x, node.at_middle + worth);
    if (!node.is_constrained && largest < options_.goal) expect_at_most(largest);
  }

  /// The bound will not be above the f_k of any point: as near to them is good enough.
  void expect_at_most(double value) {
    if (!(options_.goal > 0 && options_.goal < kInfinity)) return;
    const double reachable = value * (options_.goal / options_.cut);
    goal_ = std::fmin(goal_,
                      reachable > options_.worth_a_proof * options_.goal ? reachable : -kInfinity);
  }

  Examined examine(const Node& node) const {
    Examined out;
    out.node = node;
    Box<N>& X = out.node.box;
    for (int round = 0; round < options_.max_rounds; ++round) {
      ++out.evaluations;
      Part<N> part;
      part.side.fill(Interval(-1, 1));
      out.is_left = reduce(X, part, out.node);
      if (round == 0) {
        out.first_middle = out.node.at_middle;
        out.is_below_goal = !out.node.is_constrained && out.first_middle < options_.goal;
      }
      if (!out.is_left || out.node.lower > options_.cut) {
        out.is_left = false;
        break;
      }
      const double before = volume(X);
      X = part_of(X, part);
      if (out.node.lower >= options_.goal || !(volume(X) <= options_.worthwhile * before)) break;
    }
    return out;
  }

  /// One evaluation; false: nothing of the box remains.
  bool reduce(const Box<N>& X, Part<N>& part, Node& node) const {
    std::array<Form<N>, N> x;
    for (int i = 0; i < N; ++i) x[static_cast<std::size_t>(i)] = Form<N>(X[i], i);
    std::vector<Form<N>> all_equations;
    std::vector<Fraction<N>> values;
    program_.evaluate(x, all_equations, values);
    for (int i = 0; i < N; ++i) node.middle[static_cast<std::size_t>(i)] = proof::middle(X[i]);
    node.at_middle = largest_at_middle(values);
    node.is_constrained = !all_equations.empty();
    std::vector<Quadratic<N>> equations, excesses;
    for (const Form<N>& equation : all_equations) equations.push_back(equation.folded());
    double weight = 0;  // largest q0 / denominator
    for (const Fraction<N>& value : values) {
      const Interval denominators = value.denominator.range();
      const double least = std::fmax(value.least_denominator, denominators.lower());
      const double q0 = std::fmax(value.denominator.c(), least);
      const Form<N> excess = value.numerator - value.denominator * Form<N>(options_.cut);
      if (excesses.empty()) node.bends = bends_of(excess);
      excesses.push_back((excess * Form<N>(1 / q0)).folded());
      weight = std::fmax(weight, q0 / least);
    }
    const std::vector<Quadratic<N>> rows = with_eliminations(equations);
    for (const Quadratic<N>& row : rows) {
      if (!cut_by_equation(row, part)) return false;
    }
    const Multipliers<N> multipliers(equations, part, options_.dependent_rows);
    for (Quadratic<N>& excess : excesses) excess = multipliers.relieved(excess);
    const Quadratic<N> mixed = best_mixture(excesses, part, options_);
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
    node.lower = std::max(node.lower, below.lower());
    return true;
  }

  /// Infinite where it is not known.
  static double largest_at_middle(const std::vector<Fraction<N>>& values) {
    double largest = -kInfinity;
    bool is_known = false;
    for (const Fraction<N>& value : values) {
      if (value.is_rough) continue;
      is_known = true;
      const Form<N>&n = value.numerator, &d = value.denominator;
      const double divisor = std::fmax(d.c() - d.r, value.least_denominator);
      const double at_most = (n.c() + n.r) / divisor;
      if (!n.is_bounded() || !d.is_bounded() || !(divisor > 0)) return kInfinity;
      largest = std::fmax(largest, at_most);
    }
    return is_known ? largest : kInfinity;
  }

  /// Per variable, what a form is that no quadratic form can be.
  static std::array<double, N> bends_of(const Form<N>& form) {
    std::array<double, N> out{};
    using Terms = typename Form<N>::Terms;
    for (int k = Terms::first(3); k < Terms::kSize; ++k) {
      const auto index = static_cast<std::size_t>(k);
      for (std::size_t i = 0; i < N; ++i) {
        out[i] += Terms::kPowers[index][i] * std::fabs(form.coefficient[index]);
      }
    }
    return out;
  }

  static Eigen::VectorXd middle_of(const Box<N>& X) {
    Eigen::VectorXd out(N);
    for (int i = 0; i < N; ++i) out[i] = middle(X[i]);
    return out;
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

  /// Along the variable that bends f most, of the wider sides.
  void divide(const Node& node, std::vector<Node>& out) const {
    int along = 0;
    for (int i = 1; i < N; ++i) {
      if (width_of(node.box[i]) > width_of(node.box[along])) along = i;
    }
    const double widest = width_of(node.box[along]);
    for (int i = 0; i < N; ++i) {
      const bool is_wide = width_of(node.box[i]) > options_.wide_side * widest;
      if (is_wide && node.bends[i] > node.bends[along]) along = i;
    }
    const Interval side = node.box[along];
    const double split = middle(side);
    out.insert(out.end(), 2, node);
    out[out.size() - 2].box[along] = Interval(side.lower(), split);
    out[out.size() - 1].box[along] = Interval(split, side.upper());
  }

  const Program<N>& program_;
  const BoundOptions& options_;
  double goal_;  ///< the bound that is still sought
  std::priority_queue<Node> open_;
  double undivided_ = kInfinity;  ///< least bound of boxes too small to divide
  long serial_ = 0;
  Bound out_;
};

}  // namespace

template <int N>
Bound bound_below(const Program<N>& program, const std::vector<Box<N>>& domain,
                  const BoundOptions& options) {
  const ThreadCrew crew(jobs_or_processors(options.jobs));
  return Search<N>(program, options).run(domain);
}

template Bound bound_below<2>(const Program<2>&, const std::vector<Box<2>>&, const BoundOptions&);
template Bound bound_below<3>(const Program<3>&, const std::vector<Box<3>>&, const BoundOptions&);

}  // namespace stillbase::proof
