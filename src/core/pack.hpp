// A few doubles side by side in one vector register, used like one double.
//
// Arithmetic is per lane. Comparisons with an operator are for shortcuts ("nothing to do when all
// weights are zero"): == holds when all lanes are equal, != when any lane differs. What depends on
// the order of two numbers is chosen per lane, by max(), min() or where(at_least(a, b), x, y).
//
// Source files that use this type are compiled for different instruction sets, so the type carries
// the set in its name: a function template on it is never merged with that of another file.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>

#include <stillbase/core/types.hpp>

namespace stillbase {

#if defined(__AVX512F__)
inline namespace avx512 {
#elif defined(__AVX2__)
inline namespace avx2 {
#else
inline namespace any_machine {
#endif

/// The compilers' own vectors of N doubles and of the integers that compare and select them.
template <int N>
struct Register;
template <>
struct Register<2> {
  typedef double Lanes __attribute__((vector_size(16)));
  typedef std::int64_t Bits __attribute__((vector_size(16)));
};
template <>
struct Register<4> {
  typedef double Lanes __attribute__((vector_size(32)));
  typedef std::int64_t Bits __attribute__((vector_size(32)));
};
template <>
struct Register<8> {
  typedef double Lanes __attribute__((vector_size(64)));
  typedef std::int64_t Bits __attribute__((vector_size(64)));
};

/// N doubles, N = 2, 4 or 8.
template <int N>
class Pack {
 public:
  static constexpr int kLanes = N;
  using Lanes = typename Register<N>::Lanes;
  using Bits = typename Register<N>::Bits;

  struct Truth {
    Bits lanes;  ///< all bits set, or none
  };

  Pack() = default;                   // not initialised, like a double
  Pack(double x) : v(x - Lanes{}) {}  // NOLINT: implicit, so that it mixes with doubles
  explicit Pack(const Lanes& lanes) : v(lanes) {}

  static Pack load(const double* x) {
    Pack out;
    std::memcpy(&out.v, x, sizeof(v));
    return out;
  }
  void store(double* x) const { std::memcpy(x, &v, sizeof(v)); }

  Pack operator-() const { return Pack(-v); }
  Pack& operator+=(const Pack& b) { return *this = *this + b; }
  Pack& operator-=(const Pack& b) { return *this = *this - b; }
  Pack& operator*=(const Pack& b) { return *this = *this * b; }
  Pack& operator/=(const Pack& b) { return *this = *this / b; }
  friend Pack operator+(const Pack& a, const Pack& b) { return Pack(a.v + b.v); }
  friend Pack operator-(const Pack& a, const Pack& b) { return Pack(a.v - b.v); }
  friend Pack operator*(const Pack& a, const Pack& b) { return Pack(a.v * b.v); }
  friend Pack operator/(const Pack& a, const Pack& b) { return Pack(a.v / b.v); }
  /// Whether a bit is set in any lane.
  static bool any(const Bits& bits) {
    // Halves, until they fit into a general register.
    if constexpr (N > 2) {
      typename Register<N / 2>::Bits low, high;
      std::memcpy(&low, &bits, sizeof(low));
      std::memcpy(&high, reinterpret_cast<const char*>(&bits) + sizeof(low), sizeof(high));
      return Pack<N / 2>::any(low | high);
    } else {
      return (bits[0] | bits[1]) != 0;
    }
  }
  friend bool operator==(const Pack& a, const Pack& b) { return !(a != b); }
  friend bool operator!=(const Pack& a, const Pack& b) { return any(a.v != b.v); }

  friend Pack sqrt(const Pack& a) {
    Pack out;
    for (int i = 0; i < N; ++i) out.v[i] = std::sqrt(a.v[i]);
    return out;
  }
  friend Pack tanh(const Pack& a) {
    Pack out;
    for (int i = 0; i < N; ++i) out.v[i] = std::tanh(a.v[i]);
    return out;
  }
  friend Pack abs(const Pack& a) { return Pack(a.v < 0 ? -a.v : a.v); }
  friend Pack max(const Pack& a, const Pack& b) { return Pack(a.v < b.v ? b.v : a.v); }
  friend Pack min(const Pack& a, const Pack& b) { return Pack(b.v < a.v ? b.v : a.v); }
  /// a >= b, a truth per lane.
  friend Truth at_least(const Pack& a, const Pack& b) { return {a.v >= b.v}; }
  /// In every lane.
  friend bool all_hold(const Truth& truth) { return !any(~truth.lanes); }
  friend Pack where(const Truth& holds, const Pack& a, const Pack& b) {
    return Pack(holds.lanes ? a.v : b.v);
  }
  /// max(a, 0) per lane.
  friend Pack positive_part(const Pack& a) { return Pack(a.v > 0 ? a.v : Lanes{}); }

  /// Sine and cosine. pi/2 is taken off in three parts (Cody and Waite, exact products up to
  /// kLargest), then the polynomials of fdlibm's k_sin.c and k_cos.c on [-pi/4, pi/4].
  friend void sin_and_cos(const Pack& x, Pack& sine_of_x, Pack& cosine_of_x) {
    constexpr double kLargest = 1e6;
    constexpr double kTwoOverPi = 6.36619772367581382433e-01;
    constexpr double kPart1 = 1.57079632673412561417e+00;  // the first 33 bits of pi/2
    constexpr double kPart2 = 6.07710050630396597660e-11;  // the next 33 bits
    constexpr double kPart3 = 2.02226624879595063154e-21;  // the remainder
    constexpr double kRounder = 6755399441055744.0;        // 1.5 * 2^52: the sum ends in an integer
    const Lanes shifted = x.v * kTwoOverPi + kRounder;
    const Lanes k = shifted - kRounder;
    Bits quadrant;
    std::memcpy(&quadrant, &shifted, sizeof(quadrant));

    // y + tail = x - k pi/2
    const Lanes a = x.v - k * kPart1;
    const Lanes w = k * kPart2;
    const Lanes b = a - w;
    const Lanes c = k * kPart3 - ((a - b) - w);
    const Lanes y = b - c;
    const Lanes tail = (b - y) - c;

    const Lanes z = y * y;
    const Lanes sin_series =
        8.33333333332248946124e-03 +
        z * (-1.98412698298579493134e-04 +
             z * (2.75573137070700676789e-06 +
                  z * (-2.50507602534068634195e-08 + z * 1.58969099521155010221e-10)));
    const Lanes z_y = z * y;
    const Lanes sine =
        y - ((z * (0.5 * tail - z_y * sin_series) - tail) - z_y * -1.66666666666666324348e-01);
    const Lanes cos_series =
        z * (4.16666666666666019037e-02 +
             z * (-1.38888888888741095749e-03 +
                  z * (2.48015872894767294178e-05 +
                       z * (-2.75573143513906633035e-07 +
                            z * (2.08757232129817482790e-09 + z * -1.13596475577881948265e-11)))));
    const Lanes half = 0.5 * z;
    const Lanes top = 1.0 - half;
    const Lanes cosine = top + (((1.0 - top) - half) + (z * cos_series - y * tail));

    const Bits odd = (quadrant & 1) != 0;
    const Bits negative_sine = (quadrant & 2) != 0;
    const Bits negative_cosine = ((quadrant + 1) & 2) != 0;
    const Lanes s = odd ? cosine : sine;
    const Lanes c_x = odd ? sine : cosine;
    sine_of_x = Pack(negative_sine ? -s : s);
    cosine_of_x = Pack(negative_cosine ? -c_x : c_x);
    const Bits is_far = (abs(x).v < kLargest) == 0;  // so is NaN
    if (!any(is_far)) return;
    for (int i = 0; i < N; ++i) {
      if (!is_far[i]) continue;
      sine_of_x.v[i] = std::sin(x.v[i]);
      cosine_of_x.v[i] = std::cos(x.v[i]);
    }
  }

  Lanes v;
};

}  // namespace avx512, avx2 or any_machine

template <int N>
inline constexpr int kMaxJointsOf<Pack<N>> = 16;

}  // namespace stillbase

/// What Eigen asks of a number type: costs and limits are those of a double.
template <int N>
struct Eigen::NumTraits<stillbase::Pack<N>> : Eigen::NumTraits<double> {
  using Real = stillbase::Pack<N>;
  using NonInteger = stillbase::Pack<N>;
  using Nested = stillbase::Pack<N>;
  using Literal = double;
};

/// Arrays of packs keep the alignment of a pack: Eigen would ask for that of its own registers,
/// which may be less, and that is an error for clang.
template <int N, int Size>
struct Eigen::internal::compute_default_alignment<stillbase::Pack<N>, Size> {
  enum { value = 0 };
};
template <int N>
struct Eigen::internal::compute_default_alignment<stillbase::Pack<N>, Eigen::Dynamic> {
  enum { value = 0 };
};
