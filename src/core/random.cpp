#include <stillbase/core/random.hpp>

#include <cassert>
#include <cmath>

#include <stillbase/core/constants.hpp>

namespace stillbase {

namespace {

// splitmix64 (Steele, Lea, Flood, OOPSLA 2014).
std::uint64_t splitmix64(std::uint64_t& state) {
  std::uint64_t z = (state += 0x9e3779b97f4a7c15u);
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

std::uint64_t rotate_left(std::uint64_t x, int k) { return (x << k) | (x >> (64 - k)); }

// The positive root of x^(d+1) = x + 1: the golden ratio's generalisation to d dimensions.
double generalised_golden_ratio(int dimension) {
  static thread_local int last_dimension = -1;  // a search draws thousands of points of one
  static thread_local double last_ratio = 0;
  if (dimension == last_dimension) return last_ratio;
  double x = 2;
  for (int i = 0; i < 64; ++i) x = std::pow(1 + x, 1.0 / (dimension + 1));
  last_dimension = dimension;
  return last_ratio = x;
}

}  // namespace

Random::Random(std::uint64_t seed, std::uint64_t stream) : state_{} {
  // The seed is mixed before the stream enters, so that (1, 2) and (2, 1) are unrelated.
  std::uint64_t key = seed;
  key = splitmix64(key) ^ (stream * 0xd1342543de82ef95u + 0x2545f4914f6cdd1du);
  for (std::uint64_t& word : state_) word = splitmix64(key);
}

// xoshiro256++ (Blackman, Vigna, 2019).
std::uint64_t Random::next() {
  const std::uint64_t result = rotate_left(state_[0] + state_[3], 23) + state_[0];
  const std::uint64_t t = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= t;
  state_[3] = rotate_left(state_[3], 45);
  return result;
}

double Random::uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }

double Random::uniform(double lower, double upper) { return lower + (upper - lower) * uniform(); }

double Random::normal() {
  const double radius = std::sqrt(-2 * std::log(1 - uniform()));  // 1 - u is in (0, 1]
  return radius * std::cos(2 * kPi * uniform());
}

Vector3d Random::unit_vector() {
  for (;;) {
    const double x = normal(), y = normal(), z = normal();
    const Vector3d v(x, y, z);
    const double length = v.norm();
    if (length > 1e-6) return v / length;
  }
}

int Random::index(int count) {
  assert(count > 0);
  const auto n = static_cast<std::uint64_t>(count);
  // The last, incomplete run of n numbers is thrown away, or small indices would be favoured.
  const std::uint64_t limit = UINT64_MAX - UINT64_MAX % n;
  for (;;) {
    const std::uint64_t x = next();
    if (x < limit) return static_cast<int>(x % n);
  }
}

Eigen::VectorXd low_discrepancy_point(int index, int dimension, std::uint64_t seed) {
  assert(index >= 0 && dimension >= 0);
  const double ratio = generalised_golden_ratio(dimension);
  Random random(seed);
  Eigen::VectorXd point(dimension);
  double step = 1;
  for (int i = 0; i < dimension; ++i) {
    step /= ratio;
    const double x = random.uniform() + step * (index + 1.0);
    point[i] = x - std::floor(x);
  }
  return point;
}

}  // namespace stillbase
