// a' K^-1 b over boxes, against its values and differences at points of them.
#include <catch2/catch.hpp>

#include <cmath>

#include <Eigen/LU>

#include <stillbase/core/random.hpp>

#include "proof/dual.hpp"
#include "proof/elimination.hpp"
#include "proof/taylor.hpp"

namespace stillbase::proof {
namespace {

constexpr int kSize = 6;

/// A positive definite matrix and two columns that depend on two angles.
template <class S>
S entry(int i, int j, const std::array<S, 2>& x) {
  using std::cos, std::sin;
  const S c = cos(x[0] * S(1.0 + 0.1 * (i + j))) * S(0.3), s = sin(x[1] + S(0.7 * i * j));
  return (i == j ? S(4.0 + i) : S(0.0)) + c + s * S(0.4);
}
template <class S>
S left(int i, const std::array<S, 2>& x) {
  using std::sin;
  return sin(x[0] * S(i + 1.0)) - x[1];
}
template <class S>
S right(int i, const std::array<S, 2>& x) {
  using std::cos;
  return cos(x[1] + S(0.3 * i)) * x[0] + S(1.0);
}

template <class S>
S product_over(const std::array<S, 2>& x) {
  const Elimination<S, 8> elimination(kSize, [&](int i, int j) { return entry(i, j, x); });
  typename Elimination<S, 8>::Column a{}, b{};
  for (int i = 0; i < kSize; ++i) {
    a[static_cast<std::size_t>(i)] = left(i, x);
    b[static_cast<std::size_t>(i)] = right(i, x);
  }
  return elimination.product(elimination.forward(a), elimination.forward(b));
}

double product_at(double x0, double x1) {
  const std::array<double, 2> x{x0, x1};
  using std::cos, std::sin;
  Eigen::MatrixXd K(kSize, kSize);
  Eigen::VectorXd a(kSize), b(kSize);
  for (int i = 0; i < kSize; ++i) {
    a[i] = left(i, x);
    b[i] = right(i, x);
    for (int j = 0; j <= i; ++j) K(i, j) = K(j, i) = entry(i, j, x);
  }
  return a.dot(K.partialPivLu().solve(b));
}

}  // namespace

TEST_CASE("an elimination encloses the product and its slopes at every point of the box") {
  Random random(7);
  for (int trial = 0; trial < 40; ++trial) {
    const double width = std::pow(10, -4 * random.uniform());
    const double x = random.uniform(-2, 2), y = random.uniform(-2, 2);
    double value[5], slope[5];
    for (int k = 0; k < 5; ++k) {
      const double u = x + width * random.uniform(), v = y + width * random.uniform();
      value[k] = product_at(u, v);
      slope[k] = (product_at(u + 1e-6, v) - product_at(u - 1e-6, v)) / 2e-6;
    }
    const RoundUpward upward;
    const Interval X(x, x + width), Y(y, y + width);
    const Dual dual = product_over<Dual>({Dual(X, 0, 2), Dual(Y, 1, 2)});
    const Quadratic<2> form = product_over<Quadratic<2>>({Quadratic<2>(X, 0), Quadratic<2>(Y, 1)});
    for (int k = 0; k < 5; ++k) {
      CAPTURE(width, x, y);
      CHECK(dual.v.lower() <= value[k] + 1e-12);
      CHECK(dual.v.upper() >= value[k] - 1e-12);
      CHECK(dual.d[0].lower() <= slope[k] + 1e-8);
      CHECK(dual.d[0].upper() >= slope[k] - 1e-8);
      CHECK(form.range().lower() <= value[k] + 1e-12);
      CHECK(form.range().upper() >= value[k] - 1e-12);
    }
    // Not by being wide: what is left over falls with the square of the width, for forms the cube.
    if (width > 0.01) continue;
    CHECK(width_of(dual.v) < 60 * width);
    CHECK(form.r < 1000 * width * width * width + 1e-12);
  }
}

TEST_CASE("where a pivot may vanish an elimination knows nothing, and says so") {
  const RoundUpward upward;
  const auto over = [](const auto& x) {
    using S = std::decay_t<decltype(x)>;
    const Elimination<S, 4> elimination(2, [&](int i, int j) { return i == j ? x : S(0.5); });
    const auto z = elimination.forward({S(1.0), S(2.0)});
    return elimination.product(z, z);
  };
  const Interval wide(0.4, 1.6), narrow(0.9, 1.1);
  CHECK_FALSE(width_of(over(Dual(wide, 0, 2)).v) < 1e300);
  CHECK_FALSE(over(Quadratic<2>(wide, 0)).is_bounded());
  CHECK(width_of(over(Dual(narrow, 0, 2)).v) < 10);
  CHECK(over(Quadratic<2>(narrow, 0)).is_bounded());
}

}  // namespace stillbase::proof
