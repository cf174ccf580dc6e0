// The planner, linked against dynamics with one sign flipped: flipped_planner PROBLEM PLAN.
#include <stillbase/core/file.hpp>
#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/planner/planner.hpp>

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const stillbase::Plan plan = stillbase::make_plan(stillbase::read_problem(argv[1]));
  stillbase::write_file_atomically(argv[2], stillbase::plan_to_json(plan, {}), true);
  return 0;
}
