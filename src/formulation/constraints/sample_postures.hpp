// Postures by which a property of nearly all postures is known: the rank of a matrix.
#pragma once

#include <stillbase/core/random.hpp>

#include "formulation/capture_model.hpp"

namespace stillbase {

/// Calls `use` with the PostureImpact<double> of `count` postures, the same ones every time.
template <class Use>
void for_sample_postures(const CaptureModel& model, const Use& use, int count = 8) {
  Random random(0);
  for (int sample = 0; sample < count; ++sample) {
    JointVectord phi(model.n());
    for (int k = 0; k < model.n(); ++k) phi[k] = random.uniform(-3, 3);
    use(evaluate_posture<double>(model.problem.robot, model.resistance, phi));
  }
}

}  // namespace stillbase
