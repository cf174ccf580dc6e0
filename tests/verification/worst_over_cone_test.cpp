// The verifier's own maximum over a cone of directions.
#include <catch2/catch.hpp>

#include "verification/objective.hpp"

namespace stillbase::verification {

TEST_CASE("a narrow maximum on the rim is found beside a wide one that is nearly as large") {
  const Vector3d n = Vector3d::UnitZ();
  constexpr double kHalfAngle = 0.35;
  const auto bump = [](const Vector3d& d, const Vector3d& top, double width) {
    return std::exp(-(d - top).squaredNorm() / (width * width));
  };
  const auto on_rim = [&](double azimuth) {
    return cone_direction(n, std::nullopt, kHalfAngle, azimuth);
  };
  for (const double azimuth : {1.1, 2.0, 3.3, 4.6}) {
    const Vector3d wide = on_rim(azimuth + 2.5), narrow = on_rim(azimuth);
    const auto value = [&](const Vector3d& d) {
      return bump(d, wide, 0.3) + 1.0003 * bump(d, narrow, 0.03);
    };
    const WorstDirection worst = worst_over_cone(value, n, kHalfAngle, std::nullopt, 4000);
    INFO("azimuth " << azimuth);
    CHECK(worst.value >= value(narrow) * (1 - 1e-9));
    CHECK((worst.direction - narrow).norm() < 0.01);
  }
}

}  // namespace stillbase::verification
