// The lines of jump_objective.hpp, for any number type.
#pragma once

#include "formulation/capture_model_kernel.hpp"
#include "formulation/objectives/jump_objective.hpp"
#include "impact/response_parts_kernel.hpp"

namespace stillbase {

template <class S>
JointVector<S> JumpObjective::value(const Term& term, const PostureImpact<S>& posture,
                                    const ImpactResponse<S>& response) {
  JointVector<S> y(0);
  ResponseWeights<S> unused;
  for (const Block& block : term) {
    const Matrix3<S> map = block.map.cast<S>();
    with_part<S>(block.part, posture, response, unused, [&](const auto& part, auto&&) {
      y.conservativeResize(y.size() + part.size());
      y.tail(part.size()) = apply_metric<S>(map, part);
    });
  }
  return y;
}

template <class S>
void JumpObjective::add_weights(const Term& term, const JointVector<S>& u,
                                const PostureImpact<S>& posture, const ImpactResponse<S>& response,
                                ResponseWeights<S>& weights) {
  Eigen::Index row = 0;
  for (const Block& block : term) {
    const Matrix3<S> transposed = block.map.transpose().cast<S>();
    with_part<S>(block.part, posture, response, weights, [&](const auto& part, auto&& weight) {
      using Part = std::decay_t<decltype(part)>;
      weight += apply_metric<S>(transposed, Part(u.segment(row, part.size())));
      row += part.size();
    });
  }
}

template <class S>
S JumpObjective::objective(const PostureImpact<S>& posture, const ScenarioImpact<S>& impact,
                           double unit) const {
  const S scale = impact.p / S(unit);
  S sum(0);
  for (const Term& term : terms_) sum += value<S>(term, posture, impact.response).squaredNorm();
  return scale * scale * sum / S(2);
}

template <class S>
ScalarGradient<S> JumpObjective::gradient(const CaptureModel& model,
                                          const PostureImpact<S>& posture,
                                          const ScenarioImpact<S>& impact, double unit) const {
  const S scale = impact.p / S(unit);
  const S s2 = scale * scale;
  S sum(0);
  ResponseWeights<S> weights;
  for (const Term& term : terms_) {
    const JointVector<S> y = value<S>(term, posture, impact.response);
    sum += y.squaredNorm();
    add_weights<S>(term, y * s2, posture, impact.response, weights);
  }
  return model.scaled_gradient<S>(posture, impact, weights, s2 * sum);
}

}  // namespace stillbase
