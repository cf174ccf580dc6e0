#include "impact/hand_motion_kernel.hpp"

namespace stillbase {

template HandMotion<double> match_hand(const PostureImpact<double>&, const HandMatch<double>&);
template HandMotionGradient<double> hand_motion_gradient(const RobotModel&,
                                                         const PostureImpact<double>&,
                                                         const HandMatch<double>&,
                                                         const HandMotion<double>&,
                                                         const HandMotionWeights<double>&);

int matched_components(MatchedPart part) {
  constexpr int kComponents[] = {0, 1, 3, 3, 6};
  return kComponents[static_cast<std::size_t>(part)];
}

}  // namespace stillbase
