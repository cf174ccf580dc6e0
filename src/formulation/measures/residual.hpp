// Measures over the residual velocity, in closed form.
//
// At one configuration y, the terms of the objective below each other, is linear in the relative
// velocity V of target and hand: y = M V. With V = Vbar + L s, s standard normal and Sigma = L L',
//   expectation  E|y|^2 = |M Vbar|^2 + tr(M Sigma M'),
//   worst case   max |M (Vbar + k L s)| over |s| <= 1, a trust-region problem.
// A hand that moves does so as the nominal target asks, whatever the error is: y = y_0 + M V then,
// y_0 of the robot's motion before the contact.
//
// Both are values at a few scenarios (Scenario::velocity_error), so that gradients and Hessians are
// theirs: the expectation is the mean over seven of them whatever M is, the worst case has the
// gradient of the scenario at which it is taken (envelope theorem).
//
// A contact cannot pull. Velocities that separate count as if it could: both measures are upper
// bounds of those of the contact law, tight as far as such velocities are rare (separating()).
#pragma once

#include <vector>

#include <stillbase/formulation/measures/robust.hpp>

namespace stillbase {

/// Whether the problem's worst case and expectation are those over the residual velocity.
bool has_residual(const CaptureProblem& problem);

/// What a measure is a mean over: seven velocity errors for a residual velocity, the vertices of a
/// regular simplex of radius sqrt(6) (mean zero, covariance E), else draw_scenarios().
std::vector<Scenario> mean_scenarios(const CaptureProblem& problem);

/// What a worst case is looked for among at first: the nominal encounter and, for a residual
/// velocity, the ends of the ellipsoid's axes by L, else rim_scenarios().
std::vector<Scenario> outer_scenarios(const CaptureProblem& problem, int count);

/// The local maxima of |y| over the ellipsoid, the largest first.
std::vector<ConeMaximum> ellipsoid_maxima(const CaptureProblem& problem,
                                          const Formulation& formulation,
                                          const Configuration& configuration);

/// The maximum nearest to each of these velocity errors, in the same order.
std::vector<ConeMaximum> climb_ellipsoid(const CaptureProblem& problem,
                                         const Formulation& formulation,
                                         const Configuration& configuration,
                                         const std::vector<Scenario>& from);

}  // namespace stillbase
