#include "proof/taylor.hpp"

#include <utility>

namespace stillbase::proof {
namespace {

constexpr double kUnit = 0x1p-52;     ///< one rounding, of the result
constexpr double kProduct = 0x1p-47;  ///< all roundings of a product, of both factors' sizes
constexpr double kTiny = 0x1p-960;    ///< bound on what underflows

double radius_about(const Interval& x, double m) { return std::fmax(x.upper() - m, m - x.lower()); }

/// Written out: loops over the table cost five times as much.
template <int N, int K, std::size_t... I>
void add_products(const Taylor<N, K>& x, const Taylor<N, K>& y, Taylor<N, K>& out,
                  std::index_sequence<I...>) {
  constexpr auto& kTable = Monomials<N, K>::kTable;
  ((out.coefficient[static_cast<std::size_t>(kTable[I].to)] +=
    x.coefficient[static_cast<std::size_t>(kTable[I].x)] *
    y.coefficient[static_cast<std::size_t>(kTable[I].y)]),
   ...);
}

/// Terms up to degree K, r left at zero.
template <int N, int K>
Taylor<N, K> polynomial_product(const Taylor<N, K>& x, const Taylor<N, K>& y) {
  Taylor<N, K> out;
  add_products(x, y, out,
               std::make_index_sequence<static_cast<std::size_t>(Monomials<N, K>::kProducts)>());
  return out;
}

/// f^(j) / j! for j = 0 to Size - 1 of a function with f'' = -f, from f and f'.
template <std::size_t Size>
std::array<Interval, Size> wave_series(const Interval& f, const Interval& rate) {
  std::array<Interval, Size> out;
  Interval value = f, slope = rate;
  double factorial = 1;
  for (std::size_t j = 0; j < Size; ++j) {
    if (j > 1) factorial *= static_cast<double>(j);
    out[j] = value / factorial;
    const Interval next = -value;
    value = slope;
    slope = next;
  }
  return out;
}

/// A function with f'' = -f over x. @param f, rate from an interval to enclosures of f and f'
template <int N, int K, class F, class Rate>
Taylor<N, K> wave_of(const Taylor<N, K>& x, const F& f, const Rate& rate) {
  const Interval whole = x.range(), c(x.c());
  return x.expanded(wave_series<K + 1>(f(c), rate(c)), K + 1,
                    wave_series<K + 2>(f(whole), rate(whole)).back(), f(whole));
}

}  // namespace

template <int N, int K>
Taylor<N, K>::Taylor(const Interval& x, int i) : Taylor(proof::middle(x)) {
  coefficient[1 + static_cast<std::size_t>(i)] = radius_about(x, coefficient[0]);
}

template <int N, int K>
Taylor<N, K> Taylor<N, K>::any(const Interval& x) {
  Taylor out(proof::middle(x));
  out.r = radius_about(x, out.coefficient[0]);
  return out.keep_bounds();
}

template <int N, int K>
Taylor<N, K> Taylor<N, K>::unbounded() {
  Taylor out;
  out.r = std::numeric_limits<double>::infinity();
  return out;
}

/// Infinite and undefined remainders become unbounded().
template <int N, int K>
Taylor<N, K>& Taylor<N, K>::keep_bounds() {
  if (!is_bounded()) *this = unbounded();
  return *this;
}

template <int N, int K>
double Taylor<N, K>::size_of(int degree) const {
  double sum = 0;
  for (int i = Terms::first(degree); i < Terms::first(degree + 1); ++i) {
    sum += std::fabs(coefficient[static_cast<std::size_t>(i)]);
  }
  return sum;
}

template <int N, int K>
Taylor<N, 2> Taylor<N, K>::folded() const {
  Taylor<N, 2> out;
  out.r = r;
  for (std::size_t i = 0; i < coefficient.size(); ++i) {
    if (i < out.coefficient.size()) {
      out.coefficient[i] = coefficient[i];
    } else {
      out.r += std::fabs(coefficient[i]);
    }
  }
  return out;
}

template <int N, int K>
Interval Taylor<N, K>::range() const {
  Interval sum = Interval(c()) + Interval(-r, r);
  for (int i = 0; i < N; ++i) {
    // a eps + q eps^2, at its ends but for a top between them.
    const double slope = std::fabs(a(i)), bend = q(i, i);
    const bool turns = slope < 2 * std::fabs(bend);
    if (!turns) {
      sum += Interval(bend) + Interval(-slope, slope);
    } else {
      sum += Interval(-slope, slope) + Interval(std::fmin(bend, 0), std::fmax(bend, 0));
    }
    for (int j = i + 1; j < N; ++j) {
      const double both = std::fabs(q(i, j));
      sum += Interval(-both, both);
    }
  }
  for (int degree = 3; degree <= K; ++degree) {
    const double size = size_of(degree);
    sum += Interval(-size, size);
  }
  return sum;
}

template <int N, int K>
Taylor<N, K>& Taylor<N, K>::operator+=(const Taylor& o) {
  double size = 0;
  for (std::size_t i = 0; i < coefficient.size(); ++i) {
    coefficient[i] += o.coefficient[i];
    size += std::fabs(coefficient[i]);
  }
  r += o.r + kUnit * size;
  return keep_bounds();
}

template <int N, int K>
Taylor<N, K>& Taylor<N, K>::operator-=(const Taylor& o) {
  double size = 0;
  for (std::size_t i = 0; i < coefficient.size(); ++i) {
    coefficient[i] -= o.coefficient[i];
    size += std::fabs(coefficient[i]);
  }
  r += o.r + kUnit * size;
  return keep_bounds();
}

template <int N, int K>
typename Taylor<N, K>::Sizes Taylor<N, K>::sizes() const {
  Sizes out;
  for (int d = K; d >= 0; --d) {
    out.each[d] = size_of(d);
    out.from[d] = out.from[d + 1] + out.each[d];
  }
  return out;
}

template <int N, int K>
Taylor<N, K> Taylor<N, K>::times(const Taylor& o) const {
  if (is_zero() || o.is_zero()) return Taylor();
  if (is_number()) return o.times_number(*this);
  if (o.is_number()) return times_number(o);
  const Sizes size_x = sizes(), size_y = o.sizes();
  Taylor out = polynomial_product(*this, o);
  double dropped = 0;
  for (int d = 1; d <= K; ++d) dropped += size_x.each[d] * size_y.from[K - d + 1];
  out.r = dropped + (size_x.from[0] * o.r + size_y.from[0] * r + r * o.r) +
          kProduct * size_x.from[0] * size_y.from[0] + kTiny;
  return out.keep_bounds();
}

/// The product with a form that does not depend on the box.
template <int N, int K>
Taylor<N, K> Taylor<N, K>::times_number(const Taylor& k) const {
  const double factor = k.coefficient[0];
  double size = 0;
  Taylor out = *this;
  for (double& each : out.coefficient) {
    size += std::fabs(each);
    each *= factor;
  }
  out.r =
      std::fabs(factor) * r + size * k.r + r * k.r + 2 * kUnit * std::fabs(factor) * size + kTiny;
  return out.keep_bounds();
}

template <int N, int K>
Taylor<N, K> Taylor<N, K>::squared() const {
  if (is_zero()) return Taylor();
  constexpr int kLow = K / 2;
  const Sizes size = sizes();
  // (low + high + e)^2: of the terms above degree K those with a low factor may have any sign, the
  // others are the square of high + e.
  double low = 0;
  for (int d = 0; d <= kLow; ++d) low += size.each[d];
  double dropped = low * r;
  for (int d = 1; d <= kLow; ++d) dropped += size.each[d] * size.from[K - d + 1];
  const double high = size.from[kLow + 1] + r, positive = high * high / 2;
  Taylor out = polynomial_product(*this, *this);
  out.coefficient[0] += positive;
  out.r = 2 * dropped + positive + 2 * kProduct * size.from[0] * size.from[0] +
          kUnit * std::fabs(out.coefficient[0]) + kTiny;
  out.keep_bounds();
  // Of a wide form its range is all there is to say.
  const Interval whole = range();
  const double largest = std::fmax(std::fabs(whole.lower()), std::fabs(whole.upper()));
  const Taylor flat = any(Interval(0, largest * largest));
  return flat.r < out.r ? flat : out;
}

/// 1/x = sum (-d)^j / c^(j+1) + (-d)^(K+1) / (c^(K+1) x), d = x - c.
template <int N, int K>
Taylor<N, K> Taylor<N, K>::inverse() const {
  const Interval whole = range();
  if (!is_bounded() || contains_zero(whole) || c() == 0) return unbounded();
  const Interval k = Interval(1.0) / Interval(c());
  Series terms;
  terms[0] = k;
  for (std::size_t j = 1; j <= K; ++j) terms[j] = -terms[j - 1] * k;
  return expanded(terms, K + 1, -terms[K] / whole, Interval(1.0) / whole);
}

template <int N, int K>
Taylor<N, K> Taylor<N, K>::times_inverse(const Taylor& o, const Taylor& inverse_of_o) const {
  if (is_zero()) return Taylor();
  const double k = c() / o.c();
  if (!inverse_of_o.is_bounded() || !std::isfinite(k)) return unbounded();
  return (*this - o * k) * inverse_of_o + k;
}

template <int N, int K>
Taylor<N, K> Taylor<N, K>::sine() const {
  return wave_of(
      *this, [](const Interval& x) { return proof::sine(x); },
      [](const Interval& x) { return proof::cosine(x); });
}

template <int N, int K>
Taylor<N, K> Taylor<N, K>::cosine() const {
  return wave_of(
      *this, [](const Interval& x) { return proof::cosine(x); },
      [](const Interval& x) { return -proof::sine(x); });
}

template <int N, int K>
Taylor<N, K> Taylor<N, K>::positive_part() const {
  const Interval whole = range();
  if (!is_bounded() || whole.lower() >= 0) return *this;
  if (whole.upper() <= 0) return Taylor();
  if (-whole.lower() < whole.upper()) return *this + any(Interval(0, -whole.lower()));
  return any(Interval(0, whole.upper()));
}

template <int N, int K>
Taylor<N, K> Taylor<N, K>::mixed(const Taylor& o, double t) const {
  const double s = 1 - t;  // off by rounding, as the products are
  double size = 0;
  Taylor out;
  for (std::size_t i = 0; i < out.coefficient.size(); ++i) {
    const double mine = coefficient[i], other = o.coefficient[i];
    size += std::fabs(mine) + std::fabs(s * mine) + std::fabs(t * other);
    out.coefficient[i] = s * mine + t * other;
  }
  out.r = (s * r + t * o.r) + kUnit * (4 * size + r) + kTiny;
  return out.keep_bounds();
}

/// The variable of a form c + a eps_i; -1: it is another one.
template <int N, int K>
int Taylor<N, K>::only_variable() const {
  if (r != 0) return -1;
  int found = -1;
  for (int i = 1; i < kSize; ++i) {
    if (coefficient[static_cast<std::size_t>(i)] == 0) continue;
    if (i > N || found >= 0) return -1;
    found = i - 1;
  }
  return found;
}

template <int N, int K>
double Taylor<N, K>::size_about_middle() const {
  double off = r;
  for (int i = 1; i < kSize; ++i) off += std::fabs(coefficient[static_cast<std::size_t>(i)]);
  return off;
}

template <int N, int K>
Taylor<N, K> Taylor<N, K>::expanded(const Series& f, int power, const Interval& last,
                                    const Interval& whole) const {
  Taylor d = *this;
  d.coefficient[0] = 0;
  double open = boost::numeric::norm(last);
  const double off = size_about_middle();
  for (int j = 0; j < power; ++j) open *= off;
  Taylor out;
  const int single = only_variable();
  if (single >= 0) {
    Interval factor(1.0);
    for (int j = 0; j <= K; ++j) {
      const Interval exact = f[static_cast<std::size_t>(j)] * factor;
      double& each = out.coefficient[static_cast<std::size_t>(Terms::power(single, j))];
      each = proof::middle(exact);
      out.r += radius_about(exact, each);
      factor *= a(single);
    }
  } else {
    out = any(f[K]);
    for (int j = K - 1; j >= 0; --j) out = out * d + any(f[static_cast<std::size_t>(j)]);
  }
  out.r += open;
  out.keep_bounds();
  const Taylor flat = any(whole);
  return flat.r < out.r ? flat : out;
}

template struct Taylor<1, 2>;
template struct Taylor<2, 2>;
template struct Taylor<3, 2>;
template struct Taylor<2, 4>;
template struct Taylor<3, 4>;

}  // namespace stillbase::proof
