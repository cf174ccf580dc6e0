#include "proof/enclose.hpp"

#include <Eigen/LU>
#include <algorithm>

#include "proof/form_bounds.hpp"

namespace stillbase::proof {
namespace {

/// A box cut by second-order forms of f.
template <int N>
struct FormCut {
  bool may_have_zero = true;
  /// Whether a test for a single zero is worth its while: no if the forms are known to bend.
  bool may_be_unique = true;
  std::array<double, N> change{};  ///< of the rows along the sides; zero: not known
};

/// By how much the values of f may miss zero.
template <int N>
struct Slack {
  std::array<double, N> of{};
  double operator[](int i) const { return of[static_cast<std::size_t>(i)]; }
};

Interval widened(const Interval& x, double slack) { return x + Interval(-slack, slack); }

template <int N>
FormCut<N> cut_by_forms(const System<N>& system, const Slack<N>& slack,
                        const EncloseOptions& options, Box<N>& X) {
  FormCut<N> out;
  std::array<Quadratic<N>, N> x, f;
  for (int j = 0; j < N; ++j) x[j] = Quadratic<N>(X[j], j);
  if (!system.evaluate(x, f)) return out;
  for (int i = 0; i < N; ++i) f[i].r += slack[i];
  Eigen::Matrix<double, N, N> J, Y;
  bool is_bounded = true, is_known = true;
  for (int i = 0; i < N; ++i) {
    is_bounded = is_bounded && f[i].is_bounded();
    is_known = is_known && f[i].r <= f[i].size_of(1) + f[i].size_of(2);
    for (int j = 0; j < N; ++j) {
      J(i, j) = f[i].a(j);
      double change = std::fabs(f[i].a(j));
      for (int k = 0; k < N; ++k) {
        change += std::fabs(f[i].q(std::min(j, k), std::max(j, k)));
      }
      out.change[j] = std::fmax(out.change[j], change);
    }
  }
  // Remainders know no variables: those behind them would never be divided.
  if (!is_known) out.change.fill(0);
  std::vector<Quadratic<N>> forms(f.begin(), f.end());
  bool is_invertible = false;
  if (is_bounded) J.computeInverseWithCheck(Y, is_invertible, 0.0);
  if (is_invertible && Y.allFinite()) {
    for (int i = 0; i < N; ++i) {
      Quadratic<N> g;
      for (int j = 0; j < N; ++j) g += f[j] * Quadratic<N>(Y(i, j));
      const bool bends = is_known && !(g.size_of(2) + g.r < options.nearly_linear);
      out.may_be_unique = out.may_be_unique && !bends;
      forms.push_back(g);
    }
  }
  Part<N> part;
  part.side.fill(Interval(-1, 1));
  for (int sweep = 0; sweep < options.sweeps; ++sweep) {
    const double before = width_of(part);
    for (const Quadratic<N>& form : forms) {
      out.may_have_zero = out.may_have_zero && cut_by_equation(form, part);
    }
    if (!out.may_have_zero) return out;
    if (width_of(part) > options.worthwhile * before) break;
  }
  for (int j = 0; j < N; ++j) {
    const Interval side = Interval(x[j].c()) + Interval(x[j].a(j)) * part[j];
    X[j] = boost::numeric::intersect(X[j], side);
    out.change[j] *= width_of(part[j]) / 2;
  }
  return out;
}

/// Value at the middle and derivatives over a box.
template <int N>
struct Linearised {
  std::array<double, N> c;
  std::array<Interval, N> f_c;
  std::array<std::array<Interval, N>, N> J;
  std::array<Interval, N> step;  ///< X - c
  bool may_have_zero = true;
};

template <int N>
Linearised<N> linearise(const System<N>& system, const Slack<N>& slack, const Box<N>& X) {
  Linearised<N> out;
  std::array<Dual, N> x, f;
  for (int j = 0; j < N; ++j) x[j] = Dual(X[j], j, N);
  system.evaluate(x, f);
  for (int i = 0; i < N; ++i) {
    out.may_have_zero = out.may_have_zero && contains_zero(widened(f[i].v, slack[i]));
    std::copy_n(f[i].d.begin(), N, out.J[i].begin());
  }
  if (!out.may_have_zero) return out;
  std::array<Dual, N> at, f_c;
  for (int j = 0; j < N; ++j) {
    out.c[j] = middle(X[j]);
    at[j] = Dual(out.c[j]);
    out.step[j] = X[j] - out.c[j];
  }
  system.evaluate(at, f_c);
  for (int i = 0; i < N; ++i) {
    out.f_c[i] = widened(f_c[i].v, slack[i]);
    Interval mean_value = out.f_c[i];
    for (int j = 0; j < N; ++j) mean_value += out.J[i][j] * out.step[j];
    out.may_have_zero = out.may_have_zero && contains_zero(mean_value);
  }
  return out;
}

/// X_j cut by each row solved for it; false: nothing is left.
template <int N>
bool contract_componentwise(const Linearised<N>& at, Box<N>& X) {
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) {
      if (contains_zero(at.J[i][j])) continue;
      Interval others = at.f_c[i];
      for (int k = 0; k < N; ++k) {
        if (k != j) others += at.J[i][k] * (X[k] - at.c[k]);
      }
      const Interval cut = Interval(at.c[j]) - others / at.J[i][j];
      if (is_disjoint(cut, X[j])) return false;
      X[j] = boost::numeric::intersect(X[j], cut);
    }
  }
  return true;
}

enum class Verdict { Empty, Unique, Open };

/// Krawczyk's test on the box that `at` belongs to; X becomes K(X) cut with X.
/// @param image becomes K(X), unless it is null or there is none
template <int N>
Verdict krawczyk(const Linearised<N>& at, Box<N>& X, bool& is_regular, Box<N>* image = nullptr) {
  using Matrix = Eigen::Matrix<double, N, N>;
  Matrix M;
  for (int i = 0; i < N; ++i) {
    for (int j = 0; j < N; ++j) M(i, j) = middle(at.J[i][j]);
  }
  is_regular = false;
  Matrix Y;  // any matrix is right; a good one is sharp
  bool is_invertible = false;
  M.computeInverseWithCheck(Y, is_invertible, 0.0);
  if (!is_invertible || !Y.allFinite()) return Verdict::Open;
  bool strictly_inside = true;
  double largest_row = 0;
  Box<N> cut;
  for (int i = 0; i < N; ++i) {
    Interval K = at.c[i];
    double row = 0;
    for (int j = 0; j < N; ++j) K -= Interval(Y(i, j)) * at.f_c[j];
    for (int j = 0; j < N; ++j) {
      Interval E = i == j ? 1.0 : 0.0;
      for (int k = 0; k < N; ++k) E -= Interval(Y(i, k)) * at.J[k][j];
      row += std::max(std::abs(E.lower()), std::abs(E.upper()));
      K += E * at.step[j];
    }
    if (image != nullptr) (*image)[i] = K;
    largest_row = std::max(largest_row, row);
    const Interval x = at.step[i] + at.c[i];  // contains the box's side
    if (is_disjoint(K, x)) return Verdict::Empty;
    strictly_inside = strictly_inside && is_strictly_inside(K, X[i]);
    cut[i] = is_disjoint(K, X[i]) ? X[i] : boost::numeric::intersect(K, X[i]);
  }
  is_regular = largest_row < 1;
  X = cut;
  return strictly_inside ? Verdict::Unique : Verdict::Open;
}

/// What of a box that holds exactly one zero is within `slack` of it; without slack, the zero to
/// rounding.
template <int N>
Box<N> tighten(const System<N>& system, const Slack<N>& slack, const EncloseOptions& options,
               Box<N> X) {
  for (int round = 0; round < options.tightening_rounds; ++round) {
    const double before = width_of(X);
    bool is_regular = false;
    Box<N> next = X;
    if (krawczyk(linearise(system, slack, X), next, is_regular) == Verdict::Empty) break;
    X = next;
    // Slow at first where slopes change much, fast near the zero, and at an end by rounding.
    const bool is_slow = width_of(X) > options.tightening_slow * before;
    const bool is_stalled = width_of(X) > options.tightening_stalled * before;
    if (is_slow && (width_of(X) < options.tight_width || is_stalled)) break;
  }
  return X;
}

template <int N>
class Search {
 public:
  Search(const System<N>& system, const EncloseOptions& options)
      : system_(system), options_(options), slack_{system.tolerance()} {}

  Enclosure<N> run(const Box<N>& domain) {
    std::vector<Box<N>> open{domain};
    while (!open.empty()) {
      if (out_.boxes >= options_.max_boxes || options_.stop.reached()) {
        out_.limit_reached = true;
        out_.undecided.insert(out_.undecided.end(), open.begin(), open.end());
        break;
      }
      Box<N> X = open.back();
      open.pop_back();
      if (is_known_zero(X)) continue;
      ++out_.boxes;
      if (system_.excludes(X) || !reduce(X)) continue;
      const bool is_solution = is_within_tolerance(X);
      if (is_solution && try_about(X)) continue;
      if (is_solution || width_of(X) <= options_.min_width) {
        out_.undecided.push_back(X);
        continue;
      }
      divide(X, open);
    }
    return std::move(out_);
  }

 private:
  /// Inside a box whose only zero is known.
  bool is_known_zero(const Box<N>& X) const {
    return std::any_of(out_.zeros.begin(), out_.zeros.end(),
                       [&](const Zero<N>& zero) { return is_inside(X, zero.unique); });
  }

  /// Cuts X; false: nothing of it remains.
  bool reduce(Box<N>& X) {
    for (int round = 0; round < options_.max_rounds; ++round) {
      const double before = width_of(X);
      const FormCut<N> forms = cut_by_forms(system_, slack_, options_, X);
      if (!forms.may_have_zero) return false;
      change_ = forms.change;
      if (!forms.may_be_unique) {
        if (width_of(X) > options_.worthwhile * before) break;
        continue;
      }
      const Box<N> whole = X;
      const Linearised<N> at = linearise(system_, slack_, X);
      if (!at.may_have_zero) return false;
      measure_slopes(at, X);
      bool is_regular = false;
      const Verdict verdict = krawczyk(at, X, is_regular);
      if (verdict == Verdict::Empty) return false;
      if (verdict == Verdict::Unique) {
        keep(whole, X);
        return false;
      }
      if (!contract_componentwise(at, X)) return false;
      if (is_regular && width_of(X) < options_.inflated_width && try_inflated(X)) return false;
      if (width_of(X) > options_.worthwhile * before) break;
    }
    return true;
  }

  bool try_inflated(const Box<N>& X) {
    Box<N> larger = X;
    const double margin = options_.inflated_by * width_of(X) + options_.inflated_least;
    for (Interval& side : larger.side) side += Interval(-margin, margin);
    const Linearised<N> at = linearise(system_, slack_, larger);
    if (!at.may_have_zero) return true;
    bool is_regular = false;
    Box<N> cut = larger;
    const Verdict verdict = krawczyk(at, cut, is_regular);
    if (verdict == Verdict::Unique) keep(larger, cut);
    return verdict != Verdict::Open;
  }

  /// Of a small box, whether its middle counts as a solution.
  bool is_within_tolerance(const Box<N>& X) const {
    if (!(width_of(X) <= options_.tangent_width)) return false;
    std::array<Dual, N> x, f;
    for (int j = 0; j < N; ++j) x[j] = Dual(middle(X[j]));
    system_.evaluate(x, f);
    for (int i = 0; i < N; ++i) {
      if (!(boost::numeric::norm(f[i].v) <= slack_[i])) return false;
    }
    return true;
  }

  /// Boxes that grow about X to hold all that the tolerance allows. @return whether one holds a
  /// single zero
  bool try_about(const Box<N>& X) {
    Box<N> larger = X;
    for (int k = 0; k < options_.inflations; ++k) {
      for (Interval& side : larger.side) {
        const double margin = options_.inflated_by * width_of(side) + options_.inflated_least;
        side += Interval(-margin, margin);
      }
      const Linearised<N> at = linearise(system_, slack_, larger);
      bool is_regular = false;
      Box<N> cut = larger, image = larger;
      if (!at.may_have_zero) return false;
      if (krawczyk(at, cut, is_regular, &image) == Verdict::Unique) {
        keep(larger, cut);
        return true;
      }
      if (!is_regular) return false;
      for (int i = 0; i < N; ++i) larger[i] = boost::numeric::hull(X[i], image[i]);
    }
    return false;
  }

  void keep(const Box<N>& unique, const Box<N>& cut) {
    const Box<N> tight = tighten(system_, Slack<N>{}, options_, cut);
    const Box<N> reach = tighten(system_, slack_, options_, cut);
    for (Zero<N>& known : out_.zeros) {
      // Both boxes hold one zero, and this one's zero is in the other's: the same zero.
      if (is_inside(tight, known.unique) || is_inside(known.tight, unique)) {
        if (width_of(unique) > width_of(known.unique)) known.unique = unique;
        for (int i = 0; i < N; ++i) known.reach[i] = boost::numeric::hull(known.reach[i], reach[i]);
        return;
      }
      if (!is_disjoint(tight,
                       known.tight)) {  // may be the same zero: never observed, but not excluded
        out_.undecided.push_back(reach);
        return;
      }
    }
    out_.zeros.push_back({unique, tight, reach});
  }

  void measure_slopes(const Linearised<N>& at, const Box<N>& X) {
    for (int j = 0; j < N; ++j) {
      double slope = 0;
      // Unbounded slopes: the widest side is divided.
      for (int i = 0; i < N; ++i) {
        slope = std::fmax(slope, std::fmin(boost::numeric::norm(at.J[i][j]), options_.steepest));
      }
      change_[j] = slope * width_of(X[j]);
    }
  }

  /// Halves the side over which a row changes most (the smear of Kearfott and Novoa, ACM TOMS 16,
  /// 1990).
  void divide(const Box<N>& X, std::vector<Box<N>>& open) const {
    int widest = 0;
    double largest = -1;
    const bool is_known =
        std::any_of(change_.begin(), change_.end(), [](double change) { return change > 0; });
    for (int j = 0; j < N; ++j) {
      const double smear = is_known ? change_[j] : width_of(X[j]);
      if (width_of(X[j]) <= options_.min_width || !(smear > largest)) continue;
      widest = j;
      largest = smear;
    }
    const double split =
        X[widest].lower() + options_.split * (X[widest].upper() - X[widest].lower());
    Box<N> left = X, right = X;
    left[widest] = Interval(X[widest].lower(), split);
    right[widest] = Interval(split, X[widest].upper());
    open.push_back(right);
    open.push_back(left);
  }

  const System<N>& system_;
  const EncloseOptions& options_;
  const Slack<N> slack_;
  std::array<double, N> change_{};  ///< of the rows along the sides of the box examined
  Enclosure<N> out_;
};

/// Boxes that touch become one.
template <int N>
std::vector<Box<N>> joined(std::vector<Box<N>> boxes, std::size_t max_joined) {
  if (boxes.size() > max_joined) return boxes;
  for (bool changed = true; changed;) {
    changed = false;
    for (std::size_t i = 0; i < boxes.size(); ++i) {
      for (std::size_t j = boxes.size(); j-- > i + 1;) {
        if (is_disjoint(boxes[i], boxes[j])) continue;
        for (int k = 0; k < N; ++k) {
          boxes[i][k] = boost::numeric::hull(boxes[i][k], boxes[j][k]);
        }
        boxes.erase(boxes.begin() + static_cast<long>(j));
        changed = true;
      }
    }
  }
  return boxes;
}

/// The box moved by 360 deg where that brings it nearer to the other.
template <int N>
Box<N> moved_towards(Box<N> X, const Box<N>& other, const std::array<bool, N>& periodic) {
  for (int i = 0; i < N; ++i) {
    const double apart = middle(other[i]) - middle(X[i]);
    if (periodic[i] && apart > 3) X[i] += kPi * 2.0;
    if (periodic[i] && apart < -3) X[i] -= kPi * 2.0;
  }
  return X;
}

}  // namespace

template <int N>
Enclosure<N> enclose_zeros(const System<N>& system, const Box<N>& domain,
                           const std::array<bool, N>& periodic, const EncloseOptions& options) {
  Box<N> searched = domain;
  for (int i = 0; i < N; ++i) {
    if (!periodic[i]) searched[i] += Interval(-options.edge, options.edge);
  }
  Enclosure<N> found = Search<N>(system, options).run(searched);
  Enclosure<N> out;
  out.boxes = found.boxes;
  out.limit_reached = found.limit_reached;
  for (const Zero<N>& zero : found.zeros) {
    bool outside = false, on_edge = false;
    for (int i = 0; i < N; ++i) {
      if (periodic[i]) continue;
      outside = outside || is_disjoint(zero.reach[i], searched[i]);
      on_edge = on_edge || !is_inside(zero.tight[i], domain[i]);
    }
    if (outside) continue;  // found through a box that was made larger
    if (on_edge) {
      found.undecided.push_back(zero.reach);
      continue;
    }
    const bool known = std::any_of(out.zeros.begin(), out.zeros.end(), [&](const Zero<N>& other) {
      return is_inside(moved_towards<N>(zero.tight, other.unique, periodic), other.unique) ||
             is_inside(moved_towards<N>(other.tight, zero.unique, periodic), zero.unique);
    });
    if (!known) out.zeros.push_back(zero);
  }
  out.undecided = joined(std::move(found.undecided), options.max_joined);
  return out;
}

template Enclosure<1> enclose_zeros<1>(const System<1>&, const Box<1>&, const std::array<bool, 1>&,
                                       const EncloseOptions&);
template Enclosure<2> enclose_zeros<2>(const System<2>&, const Box<2>&, const std::array<bool, 2>&,
                                       const EncloseOptions&);
template Enclosure<3> enclose_zeros<3>(const System<3>&, const Box<3>&, const std::array<bool, 3>&,
                                       const EncloseOptions&);

}  // namespace stillbase::proof
