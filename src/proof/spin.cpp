#include "proof/spin.hpp"

#include <algorithm>
#include <limits>

#include <stillbase/core/linear_algebra.hpp>
#include <stillbase/core/rotation.hpp>

namespace stillbase::proof {
namespace {

// Lengths of L and of R's rows are kept but for the rounding of the points that steps begin at.
constexpr double kSlack = 1.001;
constexpr double kSqrtTwoTimesNorm = 2.5;  // > sqrt(2) times the Frobenius norm of R

double magnitude(const Interval& x) { return boost::numeric::norm(x); }

/// std::sqrt rounds upwards in the mode that is set.
Interval root(const Interval& x) {
  const double low = std::sqrt(std::fmax(0, x.lower()));
  return Interval(low > 0 ? std::nextafter(low, 0.0) : 0.0, std::sqrt(std::fmax(0, x.upper())));
}

template <class Vector>
Interval length(const Vector& v) {
  Interval sum(0.0);
  for (int i = 0; i < 3; ++i) sum += boost::numeric::square(v[i].v);
  return root(sum);
}

/// Bounds the spectral norm: the largest sum of magnitudes over rows and columns.
double norm_bound(const Matrix3<Dual>& M) {
  double largest = 0;
  for (int i = 0; i < 3; ++i) {
    double row = 0, column = 0;
    for (int j = 0; j < 3; ++j) {
      row += magnitude(M(i, j).v);
      column += magnitude(M(j, i).v);
    }
    largest = std::fmax(largest, std::fmax(row, column));
  }
  return largest;
}

Matrix3<Dual> inverse_of(const Matrix3<Dual>& M) {
  const Vector3<Dual> a = M.col(0), b = M.col(1), c = M.col(2);
  const Vector3<Dual> bc = b.cross(c), ca = c.cross(a), ab = a.cross(b);
  const Dual det = a.dot(bc);
  Matrix3<Dual> out;
  for (int j = 0; j < 3; ++j) {
    out(0, j) = bc[j] / det;
    out(1, j) = ca[j] / det;
    out(2, j) = ab[j] / det;
  }
  return out;
}

/// x^k of a number that is not negative, rounded upwards.
double power(double x, int k) {
  double out = 1;
  for (int i = 0; i < k; ++i) out *= x;
  return out;
}

/// s^k for |s| <= r.
Interval power_of_span(double r, int k) {
  const double high = power(r, k);
  return Interval(k % 2 == 0 ? (k == 0 ? 1.0 : 0.0) : -high, high);
}

template <class Matrix>
void widen(Matrix& M, double by) {
  for (Eigen::Index i = 0; i < M.size(); ++i) M.data()[i].v += Interval(-by, by);
}

template <class Matrix>
void cut(Matrix& M, double bound) {
  const Interval whole(-bound, bound);
  for (Eigen::Index i = 0; i < M.size(); ++i) {
    Interval& x = M.data()[i].v;
    x = is_disjoint(x, whole) ? whole : boost::numeric::intersect(x, whole);
  }
}

template <class Matrix>
void fill(Matrix& M, double bound) {
  for (Eigen::Index i = 0; i < M.size(); ++i) M.data()[i] = Dual(Interval(-bound, bound));
}

/// Moves every entry to a double in its middle. @return sum of what they were apart from it
template <class Matrix>
double to_middle(Matrix& M) {
  double apart = 0;
  for (Eigen::Index i = 0; i < M.size(); ++i) {
    Interval& x = M.data()[i].v;
    const double m = middle(x);
    apart += magnitude(x - m);
    x = Interval(m);
  }
  return apart;
}

/// sum_k c_k s^k by Horner's rule.
template <class Matrix>
Matrix sum_at(const std::vector<Matrix>& c, const Interval& s) {
  Matrix out = c.back();
  for (std::size_t k = c.size() - 1; k-- > 0;) out = out * Dual(s) + c[k];
  return out;
}

/// The sum and its derivative for |s| <= r.
template <class Matrix>
void sum_over(const std::vector<Matrix>& c, double r, Matrix& value, Matrix& rate) {
  value = c[0];
  rate.setZero();
  for (std::size_t k = 1; k < c.size(); ++k) {
    const int order = static_cast<int>(k);
    value += c[k] * Dual(power_of_span(r, order));
    rate += c[k] * Dual(power_of_span(r, order - 1) * static_cast<double>(k));
  }
}

/// A rotation about a constant axis at a constant rate.
struct RotationAtRate {
  Matrix3<Dual> R, rate;
};

/// exp([omega x] dt) and its derivative.
RotationAtRate rotation_at_rate(const Vector3<Dual>& omega, const Interval& dt) {
  const Interval speed = length(omega);
  if (speed.upper() == 0) return {Matrix3<Dual>::Identity(), Matrix3<Dual>::Zero()};
  Matrix3<Dual> K = skew<Dual>(omega);
  for (int i = 0; i < 9; ++i) K.data()[i] /= Dual(speed);
  const Matrix3<Dual> K2 = K * K;
  const Dual angle(speed * dt);
  const Dual s = sin(angle), c = cos(angle);
  RotationAtRate out;
  out.R = K * s + K2 * (Dual(1.0) - c);
  for (int i = 0; i < 3; ++i) out.R(i, i) += Dual(1.0);
  out.rate = Matrix3<Dual>(K * c + K2 * s) * Dual(speed);
  return out;
}

/// Index of the axis of symmetry of a body whose principal axes are those of T; -1: it has none.
int axis_of_symmetry(const Matrix3d& I) {
  if (!I.isDiagonal(0)) return -1;
  for (int e = 0; e < 3; ++e) {
    if (I((e + 1) % 3, (e + 1) % 3) == I((e + 2) % 3, (e + 2) % 3)) return e;
  }
  return -1;
}

}  // namespace

SpinEnclosure::SpinEnclosure(const TargetBody& body, const TargetState& estimate, double lower,
                             double upper, const SpinOptions& options)
    : options_(options), start_(estimate.time), lower_(lower), upper_(upper) {
  const Eigen::Quaterniond q = estimate.pose.orientation.normalized();
  R_0_ = q.toRotationMatrix();
  const bool rotates =
      !body.is_point_mass && !body.inertia.isZero(0) && !estimate.angular_velocity.isZero(0);
  bool has_constant_rate = true;
  double between = 0;  // smallest and largest moment, inverted
  if (rotates) {
    // Constant up to rounding: as the planner decides it.
    const Vector3d w = q.conjugate() * estimate.angular_velocity;
    const Vector3d L = body.inertia * w;
    has_constant_rate =
        w.cross(L).norm() <= 8 * std::numeric_limits<double>::epsilon() * w.norm() * L.norm();
    const Vector3d moments = principal_moments(body.inertia);
    between = (1 / moments[0] + 1 / moments[2]) / 2;
  }

  const RoundUpward upward;
  omega_0_.setZero();
  nutation_.setZero();
  const Matrix3<Dual> R_0 = R_0_.cast<Dual>();
  if (rotates) {
    omega_0_ = R_0.transpose() * Vector3<Dual>(estimate.angular_velocity.cast<Dual>());
    rate_ = length(omega_0_).upper();
  }
  precession_ = omega_0_;
  if (has_constant_rate) return;
  I_ = body.inertia.cast<Dual>();
  const int symmetry = axis_of_symmetry(body.inertia);
  if (symmetry >= 0) {
    const double across = body.inertia((symmetry + 1) % 3, (symmetry + 1) % 3);
    const double along = body.inertia(symmetry, symmetry);
    nutation_[symmetry] = omega_0_[symmetry] * (Dual(along) - Dual(across)) / Dual(across);
    precession_ = omega_0_ + nutation_;
    if (length(nutation_).lower() > 0) return;
  }
  has_closed_form_ = false;
  J_ = inverse_of(I_);
  const State start{I_ * omega_0_, R_0};
  momentum_ = kSlack * length(start.L).upper();
  rate_ = norm_bound(J_) * momentum_;
  Matrix3<Dual> spread = J_;
  for (int i = 0; i < 3; ++i) spread(i, i) -= Dual(between);
  parting_ = norm_bound(spread) * momentum_;
  step_ = options_.turn_per_step / rate_;
  if (upper > start_) is_valid_ = march(start, upper, ahead_);
  if (lower < start_) is_valid_ = is_valid_ && march(start, lower, behind_);
}

SpinEnclosure::Coefficients SpinEnclosure::expand(const Matrix3<Dual>& R,
                                                  const Vector3<Dual>& first, int terms) const {
  Coefficients out{{R}, {first}, {}};
  if (!has_closed_form_) {
    out.L = {first};
    out.omega = {J_ * first};
  }
  for (int k = 0; k + 1 < terms; ++k) {
    const Dual divisor(static_cast<double>(k + 1));
    Vector3<Dual> next = Vector3<Dual>::Zero();
    Matrix3<Dual> R_next = Matrix3<Dual>::Zero();
    for (int j = 0; j <= k; ++j) {
      const auto a = static_cast<std::size_t>(j), b = static_cast<std::size_t>(k - j);
      if (!has_closed_form_) next += out.L[a].cross(out.omega[b]);
      R_next += out.R[a] * skew<Dual>(out.omega[b]);
    }
    if (has_closed_form_) next = nutation_.cross(out.omega.back());
    for (int i = 0; i < 3; ++i) next[i] /= divisor;
    for (int i = 0; i < 9; ++i) R_next.data()[i] /= divisor;
    out.R.push_back(R_next);
    if (!has_closed_form_) out.L.push_back(next);
    out.omega.push_back(has_closed_form_ ? next : Vector3<Dual>(J_ * next));
  }
  return out;
}

SpinEnclosure::State SpinEnclosure::sum_of(const Node& node, const Interval& s, double apart_L,
                                           double apart_R) const {
  const double remainder = power(rate_ * magnitude(s), options_.terms);
  State out{sum_at(node.at.L, s), sum_at(node.at.R, s)};
  widen(out.L, momentum_ * remainder + apart_L);
  widen(out.R, kSlack * remainder + apart_R);
  return out;
}

bool SpinEnclosure::march(const State& start, double end, std::vector<Node>& nodes) const {
  const double direction = end > start_ ? 1 : -1;
  State point = start;
  double apart_L = to_middle(point.L), apart_R = to_middle(point.R);
  double time = start_;
  for (int steps = 0; direction * (end - time) > 0; ++steps) {
    if (steps > options_.max_steps) return false;
    const double next = time + direction * step_;
    const Interval h = Interval(next) - Interval(time);
    Node node;
    node.time = time;
    node.at = expand(point.R, point.L, options_.terms);
    // At most turn_per_step: exp(x) <= 1 + x + x^2.
    const double x = parting_ * magnitude(h);
    node.apart_L = apart_L * (1 + x + x * x);
    node.apart_R = apart_R + magnitude(h) * kSqrtTwoTimesNorm * (norm_bound(J_) * node.apart_L);
    point = sum_of(node, h, 0, 0);
    apart_L = node.apart_L + to_middle(point.L);
    apart_R = node.apart_R + to_middle(point.R);
    bool keeps_length = length(point.L).upper() <= momentum_;
    for (int i = 0; i < 3; ++i) {
      keeps_length = keeps_length && length(Vector3<Dual>(point.R.row(i))).upper() <= kSlack;
    }
    if (!keeps_length || !(apart_R <= options_.max_apart)) return false;
    // The steps before the span are needed no more.
    const bool reached = direction > 0 ? next >= lower_ : next <= upper_;
    if (reached) nodes.push_back(std::move(node));
    time = next;
  }
  return true;
}

SpinEnclosure::State SpinEnclosure::at_instant(double time) const {
  const bool is_ahead = time > start_ || behind_.empty();
  const std::vector<Node>& nodes = is_ahead ? ahead_ : behind_;
  const double passed = std::abs(time - nodes.front().time) / step_;
  std::size_t i = std::min(nodes.size() - 1, static_cast<std::size_t>(passed));
  const auto lies_before = [&](std::size_t k) {
    return is_ahead ? nodes[k].time <= time : nodes[k].time >= time;
  };
  while (i > 0 && !lies_before(i)) --i;
  while (i + 1 < nodes.size() && lies_before(i + 1)) ++i;
  const Interval s = Interval(time) - Interval(nodes[i].time);
  return sum_of(nodes[i], s, nodes[i].apart_L, nodes[i].apart_R);
}

SpinRange SpinEnclosure::closed_form(const Interval& time) const {
  const Interval dt = time - start_;
  const Matrix3<Dual> R_0 = R_0_.cast<Dual>();
  const RotationAtRate outer = rotation_at_rate(precession_, dt);
  const RotationAtRate inner = rotation_at_rate(nutation_, dt);
  const Matrix3<Dual> back = inner.R.transpose(), back_rate = inner.rate.transpose();
  SpinRange out;
  out.R = R_0 * Matrix3<Dual>(outer.R * back);
  out.R_rate = R_0 * (Matrix3<Dual>(outer.rate * back) + Matrix3<Dual>(outer.R * back_rate));
  out.omega = inner.R * omega_0_;
  out.omega_rate = nutation_.cross(out.omega);
  return out;
}

SpinRange SpinEnclosure::over(const Interval& time) const {
  if (has_closed_form_) return closed_form(time);
  SpinRange out;
  const double c = middle(time);
  const double r = std::fmax(magnitude(time - c), 0);
  const double x = rate_ * r;
  // For the values, their rates, and the same of omega: bounds that hold at any time.
  const std::array<double, 4> any_time{kSlack, kSlack * rate_, rate_, rate_ * rate_};
  const auto bound_all = [&](const auto& bound) {
    bound(out.R, any_time[0]);
    bound(out.R_rate, any_time[1]);
    bound(out.omega, any_time[2]);
    bound(out.omega_rate, any_time[3]);
  };
  const bool is_inside = time.lower() >= lower_ && time.upper() <= upper_;
  if (!is_inside || !(x <= options_.worth_expanding)) {
    bound_all([](auto& M, double bound) { fill(M, bound); });
    return out;
  }
  const int terms = options_.terms_over_span;
  const State state = at_instant(c);
  const Coefficients at = expand(state.R, state.L, terms);
  sum_over(at.R, r, out.R, out.R_rate);
  sum_over(at.omega, r, out.omega, out.omega_rate);
  // Remainders: coefficients of R, omega at any time are at most rate^k, rate^(k+1).
  const double last = power(x, terms), before = terms * power(x, terms - 1);
  widen(out.R, kSlack * last);
  widen(out.R_rate, kSlack * (rate_ * before));
  widen(out.omega, rate_ * last);
  widen(out.omega_rate, rate_ * (rate_ * before));
  bound_all([](auto& M, double bound) { cut(M, bound); });
  return out;
}

SpinSeries SpinEnclosure::series(double about, const Interval& time) const {
  const auto expand_from = [this](const SpinRange& at) {
    const Vector3<Dual> first = has_closed_form_ ? at.omega : Vector3<Dual>(I_ * at.omega);
    return expand(at.R, first, SpinSeries::kTerms);
  };
  SpinSeries out;
  out.whole = over(time);
  const Coefficients there = expand_from(over(Interval(about))), anywhere = expand_from(out.whole);
  std::copy(there.R.begin(), there.R.end(), out.R.begin());
  std::copy(there.omega.begin(), there.omega.end(), out.omega.begin());
  out.R.back() = anywhere.R.back();
  out.omega.back() = anywhere.omega.back();
  return out;
}

}  // namespace stillbase::proof
