#include "proof/solution_reach.hpp"

#include <optional>

#include "proof/plan_boxes.hpp"
#include "proof/row_system.hpp"

namespace stillbase::proof {
namespace {

/// Half the widths of the boxes about a solution that are tried, rad: from those that are enough
/// for most on to what two solutions that are told apart leave between them.
constexpr double kAbout[] = {1e-2, 1e-3, 3e-4};

template <int N>
bool is_inside_of(const Box<N>& A, const Box<N>& B) {
  for (int i = 0; i < N; ++i) {
    if (!is_strictly_inside(A[i], B[i])) return false;
  }
  return true;
}

/// The points within the tolerance that are connected with the solution. None is on the sides of
/// the box in which they are enclosed, so that there are no others.
template <int N>
std::optional<Box<N>> reach_of(const System<N>& system, const Box<N>& solution) {
  for (const double about : kAbout) {
    Box<N> domain = solution;
    for (Interval& side : domain.side) side += Interval(-about, about);
    const Enclosure<N> found = enclose_zeros<N>(system, domain, {});
    if (found.complete() && found.zeros.size() == 1 &&
        is_inside_of(found.zeros.front().reach, domain)) {
      return found.zeros.front().reach;
    }
  }
  return std::nullopt;
}

template <int N>
std::vector<JointBox> reach_of_solutions(const ZeroProblem& problem,
                                         const std::vector<JointBox>& solutions) {
  const VariableEncounter& encounter = problem.encounter;
  const Survey<N> survey = survey_of<N>(problem, all_rows(problem));
  if (survey.rows.size() != N) return {};
  const RowSystem<N> system(problem, survey.rows, domain_of<N>(encounter));
  std::vector<JointBox> out;
  for (const JointBox& solution : solutions) {
    Box<N> box;
    for (std::size_t i = 0; i < N; ++i) {
      box.side[i] = side_of(encounter.variables[i], solution, encounter.time_unit);
    }
    const std::optional<Box<N>> reach = reach_of(system, box);
    if (!reach) return {};
    out.push_back(joint_box(encounter, *reach));
  }
  return out;
}

}  // namespace

std::vector<JointBox> reach_of_solutions(const ZeroProblem& problem,
                                         const std::vector<JointBox>& solutions) {
  const RoundUpward upward;
  switch (problem.encounter.num_variables()) {
    case 1:
      return reach_of_solutions<1>(problem, solutions);
    case 2:
      return reach_of_solutions<2>(problem, solutions);
    case 3:
      return reach_of_solutions<3>(problem, solutions);
    default:
      return {};
  }
}

}  // namespace stillbase::proof
