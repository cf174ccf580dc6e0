#include <catch2/catch.hpp>

#include <stillbase/impact/cases.hpp>

namespace stillbase {

TEST_CASE("each case is told from the momenta that vanish") {
  const Vector3d a(0, 0, 2), zero = Vector3d::Zero();
  CHECK(judge_case(2 * a, a, a, 5).impact_case == ImpactCase::G1);
  CHECK(judge_case(a, zero, a, 5).impact_case == ImpactCase::G2);
  CHECK(judge_case(a, a, zero, 5).impact_case == ImpactCase::G3);
  CHECK(judge_case(zero, a, -a, 5).impact_case == ImpactCase::C1);
  CHECK(judge_case(zero, zero, zero, 5).impact_case == ImpactCase::C2);
}

TEST_CASE("what counts as zero is relative to the impulse and its lever") {
  const Vector3d a(0, 0, 1e-3);
  CHECK(judge_case(a, a, a, 1).impact_case == ImpactCase::G1);
  CHECK(judge_case(a, a, a, 1e4).impact_case == ImpactCase::C2);
  CHECK(judge_case(a, a, a, 1e4).total == Approx(1e-7));
}

TEST_CASE(
    "an impulse through the system centroid is C1 when arm and base rotate against each other") {
  const Vector3d a(0, 0, 2);
  CHECK(judge_case(Vector3d::Zero(), a, -a, 0).impact_case == ImpactCase::C1);
  CHECK(judge_case(Vector3d::Zero(), Vector3d::Zero(), Vector3d::Zero(), 0).impact_case ==
        ImpactCase::C2);
}

}  // namespace stillbase
