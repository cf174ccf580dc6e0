// The terms of a polynomial in N variables up to degree K, and how the terms of two factors make
// those of their product: all of it known to the compiler.
#pragma once

#include <array>
#include <cstddef>

namespace stillbase::proof {

/// The monomials of N variables up to degree K: by degree, within one by the variables' indices in
/// ascending order (1; x, y; xx, xy, yy; ...), and how their products are sorted.
template <int N, int K>
struct Monomials {
  static constexpr int count(int degree) {  // binomial(N + degree, N)
    int out = 1;
    for (int i = 1; i <= N; ++i) out = out * (degree + i) / i;
    return out;
  }
  static constexpr int kSize = count(K);
  /// First monomial of a degree.
  static constexpr int first(int degree) { return degree == 0 ? 0 : count(degree - 1); }

  struct Product {
    int x, y, to;
  };
  static constexpr int count_products() {
    int out = 0;
    for (int d = 0; d <= K; ++d) out += (first(d + 1) - first(d)) * count(K - d);
    return out;
  }
  static constexpr int kProducts = count_products();

  /// Powers of the variables, per monomial.
  static constexpr std::array<std::array<int, N>, kSize> powers() {
    std::array<std::array<int, N>, kSize> out{};
    std::array<int, N> at{};
    int next = 0;
    for (int degree = 0; degree <= K; ++degree) {
      // Of one degree in descending lexicographic order.
      at = {};
      at[0] = degree;
      for (;;) {
        out[static_cast<std::size_t>(next++)] = at;
        int i = N - 2;
        while (i >= 0 && at[static_cast<std::size_t>(i)] == 0) --i;
        if (i < 0) break;
        const int last = at[N - 1];
        at[N - 1] = 0;
        --at[static_cast<std::size_t>(i)];
        at[static_cast<std::size_t>(i) + 1] = last + 1;
      }
    }
    return out;
  }
  static constexpr std::array<std::array<int, N>, kSize> kPowers = powers();

  /// eps_i^degree.
  static constexpr int power(int i, int degree) {
    std::array<int, N> wanted{};
    wanted[static_cast<std::size_t>(i)] = degree;
    int out = 0;
    while (kPowers[static_cast<std::size_t>(out)] != wanted) ++out;
    return out;
  }

  /// All products of degree <= K, sorted by where they go.
  static constexpr std::array<Product, kProducts> products() {
    std::array<Product, kProducts> out{};
    std::size_t filled = 0;
    for (std::size_t to = 0; to < kSize; ++to) {
      for (std::size_t x = 0; x < kSize; ++x) {
        for (std::size_t y = 0; y < kSize; ++y) {
          bool fits = true;
          for (std::size_t i = 0; i < N; ++i) {
            fits = fits && kPowers[x][i] + kPowers[y][i] == kPowers[to][i];
          }
          if (!fits) continue;
          out[filled++] = {static_cast<int>(x), static_cast<int>(y), static_cast<int>(to)};
        }
      }
    }
    return out;
  }
  static constexpr std::array<Product, kProducts> kTable = products();
};

}  // namespace stillbase::proof
