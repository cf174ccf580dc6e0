#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>

#include <stillbase/core/random.hpp>

#include "proof/form_bounds.hpp"

namespace stillbase::proof {
namespace {

using Wide = long double;

/// A function of two variables, as a form and in long double.
template <class F>
struct Written {
  std::function<F(const F&, const F&)> form;
  std::function<Wide(Wide, Wide)> exact;
};

/// So many of the functions() are as smooth as a form knows of.
constexpr std::size_t kSmooth = 5;

template <class F>
std::vector<Written<F>> functions() {
  return {{[](const F& x, const F& y) { return x * y - x + 0.3; },
           [](Wide x, Wide y) { return x * y - x + 0.3L; }},
          {[](const F& x, const F& y) { return sin(x) * cos(y + x); },
           [](Wide x, Wide y) { return std::sin(x) * std::cos(y + x); }},
          {[](const F& x, const F& y) { return (sin(x) + 2.0) / (cos(x * y) + 3.0); },
           [](Wide x, Wide y) { return (std::sin(x) + 2) / (std::cos(x * y) + 3); }},
          {[](const F& x, const F& y) { return square(sin(x * 2.0) - y) * 0.7; },
           [](Wide x, Wide y) {
             const Wide d = std::sin(2 * x) - y;
             return d * d * Wide(0.7);
           }},
          {[](const F& x, const F& y) { return inverse_of(x * x + y * y + 0.1); },
           [](Wide x, Wide y) { return 1 / (x * x + y * y + Wide(0.1)); }},
          {[](const F& x, const F& y) { return (x - y * 0.5).positive_part(); },
           [](Wide x, Wide y) { return std::max(x - y / 2, Wide(0)); }},
          {[](const F& x, const F& y) {
             const F z = x + y;
             const Interval s = sine(Interval(z.c())), c = cosine(Interval(z.c()));
             const std::array<Interval, 4> f = {s, c, -s / 2.0, -cosine(z.range()) / 6.0};
             return series(z, f, sine(z.range()));
           },
           [](Wide x, Wide y) { return std::sin(x + y); }}};
}

/// The part of a form that does not say "about", at eps.
template <int N, int K, class Point>
Wide polynomial(const Taylor<N, K>& form, const Point& eps) {
  Wide sum = 0;
  for (std::size_t k = 0; k < form.coefficient.size(); ++k) {
    Wide term = form.coefficient[k];
    for (std::size_t i = 0; i < N; ++i) {
      for (int power = 0; power < Monomials<N, K>::kPowers[k][i]; ++power) term *= eps[i];
    }
    sum += term;
  }
  return sum;
}

/// The variables are number `first` and `second` of N.
template <int N, int K>
void holds_its_functions(int first, int second) {
  using F = Taylor<N, K>;
  const RoundUpward upward;
  Random random(5);
  const auto all_functions = functions<F>();
  for (int trial = 0; trial < 2000; ++trial) {
    const double width = std::pow(10, random.uniform(-12, 0));
    std::array<Interval, 2> box;
    std::array<F, 2> x;
    for (std::size_t i = 0; i < 2; ++i) {
      const double at = random.uniform(-4, 4);
      box[i] = Interval(at, at + width);
      x[i] = F(box[i], i == 0 ? first : second);
    }
    for (const Written<F>& f : all_functions) {
      const F form = f.form(x[0], x[1]);
      if (!form.is_bounded()) continue;
      const Interval all = form.range();
      const auto quadratic = form.folded();
      for (int k = 0; k < 5; ++k) {
        std::array<Wide, 2> point;
        std::array<Wide, N> eps{};
        for (std::size_t i = 0; i < 2; ++i) {
          const int variable = i == 0 ? first : second;
          const double u = k < 2 ? k : random.uniform();
          point[i] = std::fmin(box[i].upper(), box[i].lower() + u * width);
          eps[static_cast<std::size_t>(variable)] =
              (point[i] - Wide(x[i].c())) / Wide(x[i].a(variable));
        }
        std::fesetround(FE_TONEAREST);
        const Wide value = f.exact(point[0], point[1]);
        const Wide off = std::fabs(value - polynomial(form, eps));
        const Wide off_folded = std::fabs(value - polynomial(quadratic, eps));
        std::fesetround(FE_UPWARD);
        if (!(off <= Wide(form.r))) FAIL("off by " << double(off) << ", said " << form.r);
        if (!(off_folded <= Wide(quadratic.r))) FAIL("folded, off by " << double(off_folded));
        if (!(all.lower() <= value && value <= all.upper())) FAIL("range at width " << width);
      }
    }
  }
}

/// What is left open falls by `factor` with half the width.
template <int K>
void leaves_open(double factor) {
  using F = Taylor<2, K>;
  const RoundUpward upward;
  const auto all_functions = functions<F>();
  for (std::size_t f = 0; f < kSmooth; ++f) {
    double before = 0;
    for (const double width : {0.04, 0.02, 0.01}) {
      CAPTURE(f, width);
      const F x(Interval(0.7, 0.7 + width), 0), y(Interval(-0.4, -0.4 + width), 1);
      const double open = all_functions[f].form(x, y).r;
      if (before > 1e-12) CHECK(open < before / factor);  // else rounding alone
      before = open;
    }
  }
}

using Flat = Quadratic<2>;

}  // namespace

TEST_CASE("a form holds its function at every point of its box, however small the box") {
  holds_its_functions<2, 2>(0, 1);
  holds_its_functions<2, 4>(1, 0);
  holds_its_functions<3, 4>(2, 0);
}

TEST_CASE("what a form leaves open falls with the power of the width that its degree promises") {
  leaves_open<2>(6.5);  // third: 8
  leaves_open<4>(26);   // fifth: 32
}

TEST_CASE("products of monomials go where their powers add up") {
  using Terms = Monomials<3, 4>;
  CHECK(Terms::kSize == 35);
  CHECK(Terms::kProducts == 210);
  std::array<bool, Terms::kSize> reached{};
  for (const auto& product : Terms::kTable) {
    for (std::size_t i = 0; i < 3; ++i) {
      CHECK(Terms::kPowers[product.x][i] + Terms::kPowers[product.y][i] ==
            Terms::kPowers[product.to][i]);
    }
    reached[static_cast<std::size_t>(product.to)] = true;
  }
  CHECK(std::count(reached.begin(), reached.end(), true) == Terms::kSize);
  // The order on which a(), q() and folded() rely.
  const Taylor<3, 4> x(Interval(-1, 1), 0), y(Interval(-1, 1), 1), z(Interval(-1, 1), 2);
  const Taylor<3, 4> sum = x * y * 2.0 + y * z * 3.0 + z * z * 5.0 + z * 7.0;
  CHECK(sum.a(2) == 7);
  CHECK(sum.q(0, 1) == 2);
  CHECK(sum.q(1, 2) == 3);
  CHECK(sum.q(2, 2) == 5);
}

TEST_CASE("what is unbounded stays unbounded, and zero stays zero") {
  const RoundUpward upward;
  const Flat x(Interval(-1, 1), 0);
  CHECK_FALSE(inverse_of(x).is_bounded());
  CHECK_FALSE((Flat(1.0) / x + 3.0).is_bounded());
  CHECK_FALSE((inverse_of(x) * inverse_of(x)).is_bounded());
  CHECK((inverse_of(x) * Flat(0.0)).is_zero());
  CHECK((Flat(1e300) * x * Flat(1e300)).range().upper() >= 1e300);
  CHECK(least(inverse_of(x), Part<2>{{Interval(-1, 1), Interval(-1, 1)}}) == -kInfinity);
}

TEST_CASE("a mixture is never above the larger of both") {
  const RoundUpward upward;
  Random random(8);
  const Flat x(Interval(0.2, 0.5), 0), y(Interval(-1, -0.6), 1);
  const Flat f = sin(x) + y, g = x * y + 0.1;
  for (int k = 0; k < 100; ++k) {
    const Flat mixed = f.mixed(g, random.uniform());
    const std::array<Wide, 2> eps{Wide(random.uniform(-1, 1)), Wide(random.uniform(-1, 1))};
    const Wide larger = std::max(polynomial(f, eps) + f.r, polynomial(g, eps) + g.r);
    CHECK(polynomial(mixed, eps) - mixed.r <= larger);
  }
}

TEST_CASE("the least value over a part is below all values, and sharp where the form is convex") {
  const RoundUpward upward;
  Random random(11);
  for (int trial = 0; trial < 2000; ++trial) {
    Flat form;
    for (double& coefficient : form.coefficient) coefficient = random.uniform(-1, 1);
    const bool convex = trial % 2 == 0;
    for (const std::size_t bend : {3, 5}) {
      if (convex) form.coefficient[bend] = std::fabs(form.coefficient[bend]) + 1;
    }
    Part<2> part;
    for (int i = 0; i < 2; ++i) {
      const double a = random.uniform(-1, 1), b = random.uniform(-1, 1);
      part[i] = Interval(std::fmin(a, b), std::fmax(a, b));
    }
    const double low = least(form, part);
    double smallest = kInfinity;
    for (int i = 0; i <= 40; ++i) {
      for (int j = 0; j <= 40; ++j) {
        const std::array<Wide, 2> eps{part[0].lower() + Wide(width_of(part[0])) * i / 40,
                                      part[1].lower() + Wide(width_of(part[1])) * j / 40};
        smallest = std::fmin(smallest, static_cast<double>(polynomial(form, eps)));
      }
    }
    REQUIRE(low <= smallest + 1e-15);
    if (convex) CHECK(low > smallest - 0.01);
  }
}

TEST_CASE("cuts take away only what is not wanted") {
  const RoundUpward upward;
  Random random(13);
  for (int trial = 0; trial < 500; ++trial) {
    Flat form;
    for (std::size_t k = 0; k < 6; ++k) {
      form.coefficient[k] = random.uniform(-1, 1) * (k < 3 ? 1 : 0.3);
    }
    form.r = 0.01;
    Part<2> zeros{{Interval(-1, 1), Interval(-1, 1)}}, below = zeros;
    const bool has_zero = cut_by_equation(form, zeros), has_below = cut_above_zero(form, below);
    for (int k = 0; k < 400; ++k) {
      const std::array<double, 2> eps{random.uniform(-1, 1), random.uniform(-1, 1)};
      const double value =
          static_cast<double>(polynomial(form, std::array<Wide, 2>{eps[0], eps[1]}));
      const auto holds = [&](const Part<2>& part) {
        return eps[0] >= part[0].lower() && eps[0] <= part[0].upper() &&
               eps[1] >= part[1].lower() && eps[1] <= part[1].upper();
      };
      if (std::fabs(value) <= form.r) CHECK((has_zero && holds(zeros)));
      if (value - form.r <= 0) CHECK((has_below && holds(below)));
    }
  }
}

}  // namespace stillbase::proof
