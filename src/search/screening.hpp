// A first judgement of many points: the measure over a few scenarios, several postures at a time.
#pragma once

#include <vector>

#include <stillbase/search/search.hpp>

namespace stillbase {

/// About the problem's measure of each point, 1/2 |y|^2 / unit^2: the largest over the nominal
/// direction and some on the rim of the cone; mean or tail mean over the first samples.
Eigen::VectorXd screen(const CaptureProblem& problem, const Formulation& formulation,
                       const std::vector<Eigen::VectorXd>& points,
                       const ScreeningOptions& options = {});

/// The best `kept` points by screen(), the best first, none nearer to a better one than `distance`.
std::vector<Eigen::VectorXd> best_by_screening(const CaptureProblem& problem,
                                               const Formulation& formulation,
                                               const std::vector<Eigen::VectorXd>& points, int kept,
                                               const ScreeningOptions& options = {});

}  // namespace stillbase
