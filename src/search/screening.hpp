// A first judgement of many points: the measure over a few scenarios, several postures at a time.
#pragma once

#include <vector>

#include <stillbase/formulation/formulation.hpp>

namespace stillbase {

/// About the problem's measure of each point, 1/2 |y|^2 / unit^2: the largest over the nominal
/// direction and eight on the rim of the cone; mean or tail mean over the first samples.
Eigen::VectorXd screen(const CaptureProblem& problem, const Formulation& formulation,
                       const std::vector<Eigen::VectorXd>& points);

/// The best `keep` points by screen(), the best first, none nearer to a better one than `apart`.
std::vector<Eigen::VectorXd> best_by_screening(const CaptureProblem& problem,
                                               const Formulation& formulation,
                                               const std::vector<Eigen::VectorXd>& points, int keep,
                                               double apart);

}  // namespace stillbase
