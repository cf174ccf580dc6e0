// The worst case over a cone of impulse directions.
//
// Hand and posture fixed; the direction varies within the cone about the predicted one, and the
// impulse is recomputed by the contact law for every direction. The maximum can lie inside the
// cone.
#pragma once

#include <stillbase/capture/formulation.hpp>

namespace stillbase {

struct WorstCase {
  double value = 0;                       ///< max |y| over the cone, in the objective's unit
  Vector3d direction = Vector3d::Zero();  ///< where, unit, in B
};

/// Largest |y| over the problem's uncertainty cone at a configuration. A scan of rings (planar: of
/// the wedge) followed by local refinement of the best places.
WorstCase worst_case(const CaptureProblem& problem, const Formulation& formulation,
                     const Configuration& configuration);

/// |y| at the predicted direction.
double nominal_value(const CaptureProblem& problem, const Formulation& formulation,
                     const Configuration& configuration);

}  // namespace stillbase
