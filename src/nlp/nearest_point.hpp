// Is there a feasible point near a violated one? Asked when a solver gave up.
#pragma once

#include <stillbase/nlp/optimizer.hpp>

namespace stillbase::nlp {

struct NearestPoint {
  Eigen::VectorXd x;
  int evaluations = 0;
};

/// Local minimum of V(x) = 1/2 sum violation^2 in the box, from x0, by nlopt-slsqp. V has a
/// continuous gradient (J^T violation), which is all that is needed. Exceptions of the problem pass
/// through.
NearestPoint nearest_point(const Problem& problem, const Eigen::VectorXd& x0, int max_evaluations,
                           const OptimizeOptions& options);

}  // namespace stillbase::nlp
