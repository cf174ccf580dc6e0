// Moves onto the constraints: where they end.
#include <catch2/catch.hpp>

#include <stillbase/core/random.hpp>
#include <stillbase/formulation/formulation.hpp>

#include "formulation/projection.hpp"
#include "support/shipped_problem.hpp"

namespace stillbase {
namespace {

struct ProjectionEnds {
  int arrived = 0;
  long evaluations = 0;  ///< of those that do not
};

ProjectionEnds ends_of(const Formulation& formulation, const ProjectionOptions& options) {
  ProjectionEnds out;
  for (int i = 0; i < 200; ++i) {
    const Eigen::VectorXd start =
        formulation.start_point(low_discrepancy_point(i, formulation.num_variables(), 3));
    const long before = formulation.evaluations();
    const ProjectionResult end = project_onto_constraints(formulation, start, false, 15, options);
    if (end.violation <= 1e-3) {
      ++out.arrived;
    } else {
      out.evaluations += formulation.evaluations() - before;
    }
  }
  return out;
}

}  // namespace

TEST_CASE("a projection ends where the constraints are out of reach") {
  for (const char* name : {"deos_client_224", "iiwa_cone"}) {
    INFO(name);
    const Formulation formulation(test::shipped(name));
    ProjectionOptions to_the_end;
    to_the_end.slow_steps = 15;
    const ProjectionEnds all = ends_of(formulation, to_the_end), early = ends_of(formulation, {});
    CHECK(all.arrived > 20);
    CHECK(10 * early.arrived >= 9 * all.arrived);
    CHECK(10 * early.evaluations < 6 * all.evaluations);
  }
}

TEST_CASE("a projection that arrives loses no digit to its last steps") {
  const Formulation formulation(test::shipped("iiwa_cone"));
  int arrived = 0;
  for (int i = 0; i < 50; ++i) {
    const Eigen::VectorXd start =
        formulation.start_point(low_discrepancy_point(i, formulation.num_variables(), 3));
    const ProjectionResult end = project_onto_constraints(formulation, start, false, 40);
    if (end.violation > 1e-3) continue;
    ++arrived;
    CHECK(end.violation < 1e-13);
  }
  CHECK(arrived > 5);
}

}  // namespace stillbase
