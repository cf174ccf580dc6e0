#include <stillbase/stillbase.hpp>

int main() {
  const auto problem = stillbase::read_problem("problems/planar_two_link_c2_a.yaml");
  const stillbase::Plan plan = stillbase::make_plan(problem);
  return plan.status == stillbase::PlanStatus::Optimal ? 0 : 1;
}
