#include "formulation/objectives/jump_objective.hpp"

#include "formulation/objectives/jump_objective_kernel.hpp"

namespace stillbase {

template JointVectord JumpObjective::value(const Term&, const PostureImpact<double>&,
                                           const ImpactResponse<double>&);
template void JumpObjective::add_weights(const Term&, const JointVectord&,
                                         const PostureImpact<double>&,
                                         const ImpactResponse<double>&, ResponseWeights<double>&);
template double JumpObjective::objective(const PostureImpact<double>&,
                                         const ScenarioImpact<double>&, double) const;
template ScalarGradient<double> JumpObjective::gradient(const CaptureModel&,
                                                        const PostureImpact<double>&,
                                                        const ScenarioImpact<double>&,
                                                        double) const;

JumpObjective::JumpObjective(const CaptureProblem& problem) {
  for (const ObjectiveTerm& term : problem.objective) {
    const QuantityRow& row = row_of(term.quantity);
    if (row.is_simulated()) continue;
    terms_.emplace_back();
    for (const QuantityBlock& block : row.blocks(term, problem.robot)) {
      terms_.back().push_back(
          {block.part, block.map * (1 / block.divisor) * (1 / row.power.length(term.size))});
    }
  }
}

BatchObjective JumpObjective::metrics(double unit) const {
  BatchObjective out;
  for (const Term& term : terms_) {
    for (const Block& block : term) {
      out[block.part] += block.map.transpose() * block.map * (1 / (unit * unit));
    }
  }
  return out;
}

}  // namespace stillbase
