#include <catch2/catch.hpp>

#include <cmath>
#include <functional>

#include <stillbase/core/random.hpp>

#include "proof/form_bounds.hpp"

namespace stillbase::proof {
namespace {

using Form = Quadratic<2>;
using Wide = long double;

/// A function of two variables, as a form and in long double.
struct Written {
  std::function<Form(const Form&, const Form&)> form;
  std::function<Wide(Wide, Wide)> exact;
};

const Written kFunctions[] = {
    {[](const Form& x, const Form& y) { return x * y - x + 0.3; },
     [](Wide x, Wide y) { return x * y - x + 0.3L; }},
    {[](const Form& x, const Form& y) { return sin(x) * cos(y + x); },
     [](Wide x, Wide y) { return std::sin(x) * std::cos(y + x); }},
    {[](const Form& x, const Form& y) { return (sin(x) + 2.0) / (cos(x * y) + 3.0); },
     [](Wide x, Wide y) { return (std::sin(x) + 2) / (std::cos(x * y) + 3); }},
    {[](const Form& x, const Form& y) { return square(sin(x * 2.0) - y) * 0.7; },
     [](Wide x, Wide y) {
       const Wide d = std::sin(2 * x) - y;
       return d * d * Wide(0.7);
     }},
    {[](const Form& x, const Form& y) { return inverse_of(x * x + y * y + 0.1); },
     [](Wide x, Wide y) { return 1 / (x * x + y * y + Wide(0.1)); }},
    {[](const Form& x, const Form& y) { return positive_part(x - y * 0.5); },
     [](Wide x, Wide y) { return std::max(x - y / 2, Wide(0)); }},
    {[](const Form& x, const Form& y) {
       const Form z = x + y;
       const Interval s = sine(Interval(z.c)), c = cosine(Interval(z.c)), whole = z.range();
       return series(z, {s, c, -s / 2.0, -cosine(whole) / 6.0}, sine(whole));
     },
     [](Wide x, Wide y) { return std::sin(x + y); }}};

/// The part of a form that does not say "about", at eps.
Wide polynomial(const Form& form, const std::array<Wide, 2>& eps) {
  Wide sum = form.c;
  for (int i = 0; i < 2; ++i) {
    sum += form.a[i] * eps[i];
    for (int j = i; j < 2; ++j) sum += form.q[Form::pair(i, j)] * eps[i] * eps[j];
  }
  return sum;
}

}  // namespace

TEST_CASE("a form holds its function at every point of its box, however small the box") {
  const RoundUpward upward;
  Random random(5);
  for (int trial = 0; trial < 4000; ++trial) {
    const double width = std::pow(10, random.uniform(-12, 0));
    std::array<Interval, 2> box;
    std::array<Form, 2> x;
    for (int i = 0; i < 2; ++i) {
      const double at = random.uniform(-4, 4);
      box[i] = Interval(at, at + width);
      x[i] = Form(box[i], i);
    }
    for (const Written& f : kFunctions) {
      const Form form = f.form(x[0], x[1]);
      if (!form.is_bounded()) continue;
      const Interval all = form.range();
      for (int k = 0; k < 5; ++k) {
        std::array<Wide, 2> point, eps;
        for (int i = 0; i < 2; ++i) {
          const double u = k < 2 ? k : random.uniform();
          point[i] = std::fmin(box[i].upper(), box[i].lower() + u * width);
          eps[i] = (point[i] - Wide(x[i].c)) / Wide(x[i].a[i]);
        }
        std::fesetround(FE_TONEAREST);
        const Wide value = f.exact(point[0], point[1]);
        const Wide off = std::fabs(value - polynomial(form, eps));
        std::fesetround(FE_UPWARD);
        if (!(off <= Wide(form.r))) FAIL("off by " << double(off) << ", said " << form.r);
        if (!(all.lower() <= value && value <= all.upper())) FAIL("range at width " << width);
      }
    }
  }
}

TEST_CASE("what a form leaves open falls with the third power of the width") {
  const RoundUpward upward;
  for (const Written& f : kFunctions) {
    double before = 0;
    for (const double width : {0.04, 0.02, 0.01}) {
      CAPTURE(&f - kFunctions, width);
      const Form x(Interval(0.7, 0.7 + width), 0), y(Interval(-0.4, -0.4 + width), 1);
      const double open = f.form(x, y).r;
      if (before > 1e-12) CHECK(open < before / 6.5);  // else rounding alone
      before = open;
    }
  }
}

TEST_CASE("what is unbounded stays unbounded, and zero stays zero") {
  const RoundUpward upward;
  const Form x(Interval(-1, 1), 0);
  CHECK_FALSE(inverse_of(x).is_bounded());
  CHECK_FALSE((Form(1.0) / x + 3.0).is_bounded());
  CHECK_FALSE((inverse_of(x) * inverse_of(x)).is_bounded());
  CHECK((inverse_of(x) * Form(0.0)).is_zero());
  CHECK((Form(1e300) * x * Form(1e300)).range().upper() >= 1e300);
  CHECK(least(inverse_of(x), Part<2>{{Interval(-1, 1), Interval(-1, 1)}}) == -kInfinite);
}

TEST_CASE("a mixture is never above the larger of both") {
  const RoundUpward upward;
  Random random(8);
  const Form x(Interval(0.2, 0.5), 0), y(Interval(-1, -0.6), 1);
  const Form f = sin(x) + y, g = x * y + 0.1;
  for (int k = 0; k < 100; ++k) {
    const Form mixed = mixture(f, g, random.uniform());
    const std::array<Wide, 2> eps{Wide(random.uniform(-1, 1)), Wide(random.uniform(-1, 1))};
    const Wide larger = std::max(polynomial(f, eps) + f.r, polynomial(g, eps) + g.r);
    CHECK(polynomial(mixed, eps) - mixed.r <= larger);
  }
}

TEST_CASE("the least value over a part is below all values, and sharp where the form is convex") {
  const RoundUpward upward;
  Random random(11);
  for (int trial = 0; trial < 2000; ++trial) {
    Form form(random.uniform(-1, 1));
    for (double& slope : form.a) slope = random.uniform(-1, 1);
    for (double& bend : form.q) bend = random.uniform(-1, 1);
    const bool convex = trial % 2 == 0;
    if (convex) form.q = {std::fabs(form.q[0]) + 1, form.q[1], std::fabs(form.q[2]) + 1};
    Part<2> part;
    for (int i = 0; i < 2; ++i) {
      const double a = random.uniform(-1, 1), b = random.uniform(-1, 1);
      part[i] = Interval(std::fmin(a, b), std::fmax(a, b));
    }
    const double low = least(form, part);
    double smallest = kInfinite;
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
    Form form(random.uniform(-1, 1));
    for (double& slope : form.a) slope = random.uniform(-1, 1);
    for (double& bend : form.q) bend = random.uniform(-0.3, 0.3);
    form.r = 0.01;
    const double cut = random.uniform(-1, 1);
    Part<2> zeros{{Interval(-1, 1), Interval(-1, 1)}}, below = zeros;
    const bool has_zero = cut_by_equation(form, zeros), has_below = cut_by_value(form, cut, below);
    for (int k = 0; k < 400; ++k) {
      const std::array<double, 2> eps{random.uniform(-1, 1), random.uniform(-1, 1)};
      const double value = static_cast<double>(polynomial(form, {eps[0], eps[1]}));
      const auto holds = [&](const Part<2>& part) {
        return eps[0] >= part[0].lower() && eps[0] <= part[0].upper() &&
               eps[1] >= part[1].lower() && eps[1] <= part[1].upper();
      };
      if (std::fabs(value) <= form.r) CHECK((has_zero && holds(zeros)));
      if (value - form.r <= cut) CHECK((has_below && holds(below)));
    }
  }
}

}  // namespace stillbase::proof
