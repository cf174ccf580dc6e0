// Rows that are flat wherever presolve looks.
#include <catch2/catch.hpp>

#include "formulation/formulation_parts.hpp"
#include "formulation/presolve/presolve.hpp"
#include "support/capture_problems.hpp"

namespace stillbase {

TEST_CASE("of rows that are flat at all samples distances alone are reported") {
  Random random(83);
  const Formulation formulation(
      point_mass_problem(random_planar_robot(random, 3), Vector3d(0.6, 0.8, 0)));
  const auto flat = []<class S>(const ConstraintPoint<S>&, ScalarGradient<S>*) -> S {
    return S(0.3);
  };
  ConstraintSet set;
  const auto add = [&](const char* name, const char* unit, double least, bool is_distance) {
    add_constraint(set.rows,
                   {.name = name,
                    .unit = unit,
                    .lower = least,
                    .upper = kInfinity,
                    .is_limit = true,
                    .has_kinks = is_distance},
                   flat);
  };
  add("rate", "rad/s", 0.1, false);
  add("distance", "m", 0.1, true);
  add("too_near", "m", 0.5, true);
  const SelectedRows rows = select_independent_rows(formulation.parts().model, set);
  REQUIRE(rows.reported.size() == 1);
  CHECK(rows.reported[0]->name == "distance");
  CHECK(rows.redundant.size() == 2);
  REQUIRE(rows.kept.size() == 1);
  CHECK(rows.kept[0]->name == "too_near");
}

}  // namespace stillbase
