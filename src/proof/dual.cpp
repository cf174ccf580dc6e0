#include "proof/dual.hpp"

#include <algorithm>
#include <limits>

namespace stillbase::proof {
namespace {

/// f(x) from its value and its slope over x.
Dual chained(const Dual& x, const Interval& value, const Interval& slope) {
  Dual out(value);
  out.count = x.count;
  for (int i = 0; i < x.count; ++i) out.d[i] = slope * x.d[i];
  return out;
}

}  // namespace

Dual Dual::unbounded() {
  const double end = std::numeric_limits<double>::infinity();
  Dual out(Interval(-end, end));
  out.count = kMaxVariables;
  out.d.fill(out.v);
  return out;
}

Dual& Dual::operator+=(const Dual& o) {
  v += o.v;
  for (int i = 0; i < o.count; ++i) d[i] += o.d[i];
  count = std::max(count, o.count);
  return *this;
}

Dual& Dual::operator-=(const Dual& o) {
  v -= o.v;
  for (int i = 0; i < o.count; ++i) d[i] -= o.d[i];
  count = std::max(count, o.count);
  return *this;
}

Dual& Dual::operator*=(const Dual& o) {
  count = std::max(count, o.count);
  for (int i = 0; i < count; ++i) {
    d[i] = i < o.count ? d[i] * o.v + v * o.d[i] : d[i] * o.v;
  }
  v *= o.v;
  return *this;
}

Dual& Dual::operator/=(const Dual& o) {
  v /= o.v;
  for (int i = 0; i < o.count; ++i) d[i] -= v * o.d[i];
  count = std::max(count, o.count);
  for (int i = 0; i < count; ++i) d[i] /= o.v;
  return *this;
}

Dual operator-(const Dual& a) {
  Dual out(-a.v);
  out.count = a.count;
  for (int i = 0; i < a.count; ++i) out.d[i] = -a.d[i];
  return out;
}

Dual square(const Dual& x) {
  Dual out(boost::numeric::square(x.v));
  out.count = x.count;
  for (int i = 0; i < x.count; ++i) out.d[i] = x.v * x.d[i] * 2.0;
  return out;
}

Dual inverse_of(const Dual& x) { return contains_zero(x.v) ? Dual::unbounded() : Dual(1.0) / x; }

Dual quotient(const Dual& x, const Dual& y, const Dual&) {
  return contains_zero(y.v) ? Dual::unbounded() : x / y;
}

Dual sin(const Dual& x) { return chained(x, sine(x.v), cosine(x.v)); }

Dual cos(const Dual& x) { return chained(x, cosine(x.v), -sine(x.v)); }

}  // namespace stillbase::proof
