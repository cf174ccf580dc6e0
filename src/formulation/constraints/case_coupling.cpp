// Cases G3 and C2: the impulse leaves no coupling angular momentum Htilde_omegaphi Delta phidot.
#include <stillbase/dynamics/reaction_null_space.hpp>

#include "formulation/constraints/constraint.hpp"
#include "formulation/constraints/sample_postures.hpp"

namespace stillbase {

namespace {

/// Columns of the coupling matrix that span its range almost everywhere.
std::vector<int> spanning_columns(const CaptureModel& model) {
  int rank = 0;
  std::vector<int> columns;
  for_sample_postures(model, [&](const PostureImpact<double>& posture) {
    Matrix3Xd A = posture.tilde.Htilde_omegaphi;
    for (int k = 0; k < model.n(); ++k) {
      if (posture.factor.locked[static_cast<std::size_t>(k)]) A.col(k).setZero();
    }
    const ReactionNullSpace space = compute_reaction_null_space(A);
    if (space.rank <= rank) return;
    rank = space.rank;
    columns.clear();
    Matrix3Xd kept(3, 0);
    for (int k = 0; k < model.n() && static_cast<int>(columns.size()) < rank; ++k) {
      Matrix3Xd trial(3, kept.cols() + 1);
      trial << kept, A.col(k);
      if (compute_reaction_null_space(trial).rank == trial.cols()) {
        kept = trial;
        columns.push_back(k);
      }
    }
  });
  return columns;
}

}  // namespace

void add_case_coupling(const CaptureModel& model, ConstraintSet& out) {
  const CaseConstraint wanted = model.problem.constraints.impact_case;
  if (wanted != CaseConstraint::G3 && wanted != CaseConstraint::C2) return;
  // The coupling part lies in the range of the coupling matrix. Of rank 2, three components depend
  // on each other: rows along two columns replace them. Where these columns are nearly parallel
  // they determine little, so the components are reported.
  // After a latch it lies in the range of the matrix of robot + target, which moves with the
  // target.
  const bool is_latch = model.encounter.law == ContactLaw::Latch;
  const std::vector<int> columns = is_latch ? std::vector<int>{} : spanning_columns(model);
  const bool has_rows_along_columns = columns.size() == 2;
  for (int i = 0; i < 3; ++i) {
    // Component i in B of the coupling part per unit of impulse.
    add_constraint(has_rows_along_columns ? out.implied : out.rows,
                   {.name = "case_coupling_" + std::to_string(i + 1),
                    .unit = "m",
                    .lower = 0,
                    .upper = 0,
                    .needs_impact = true,
                    .is_of_case = true},
                   [i]<class S>(const ConstraintPoint<S>& at, ScalarGradient<S>* gradient) -> S {
                     if (gradient != nullptr) {
                       ResponseWeights<S> weights;
                       weights.total[i] = S(1);
                       weights.base = -weights.total;
                       *gradient =
                           at.model.template impact_gradient<S>(at.posture, at.impact, weights);
                     }
                     return at.impact.response.coupling()[i];
                   });
  }
  if (!has_rows_along_columns) return;
  for (const int k : columns) {
    // The coupling part along column k of the coupling matrix, per unit of impulse.
    const auto along = [k]<class S>(const ConstraintPoint<S>& at,
                                    ScalarGradient<S>* gradient) -> S {
      const Vector3<S> column = at.posture.tilde.Htilde_omegaphi.col(k);
      const Vector3<S> coupling = at.impact.response.coupling();
      if (gradient != nullptr) {
        ResponseWeights<S> weights;
        weights.total = column;
        weights.base = -column;
        *gradient = at.model.template impact_gradient<S>(at.posture, at.impact, weights);
        gradient->phi +=
            coupling_column_gradient<S>(at.model.problem.robot, at.posture, k, coupling);
      }
      return column.dot(coupling);
    };
    add_constraint(out.rows,
                   {.name = "case_coupling_column_" + std::to_string(k + 1),
                    .unit = "kg m^3",
                    .lower = 0,
                    .upper = 0,
                    .needs_impact = true,
                    .is_of_case = true},
                   along);
  }
}

}  // namespace stillbase
