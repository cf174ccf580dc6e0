#include "planner/best_possible.hpp"

#include <algorithm>
#include <cmath>

#include <stillbase/capture/robust.hpp>
#include <stillbase/proof/minimum.hpp>

#include "planner/candidates.hpp"

namespace stillbase {

namespace {

/// Of the objective's typical size: as good as zero.
constexpr double kZero = 1e-9;

/// Directions within the cone, in B: its middle, its rim and some between.
std::vector<Vector3d> spread_directions(const CaptureProblem& problem, const Vector3d& n) {
  std::vector<Vector3d> out;
  const double alpha = problem.uncertainty.cone_half_angle;
  const auto add = [&](const Vector3d& side, double angle) {
    out.push_back(std::cos(angle) * n + std::sin(angle) * side);
  };
  if (problem.uncertainty.cone_plane_normal) {
    constexpr int kEachSide = 6;
    const Vector3d side = problem.uncertainty.cone_plane_normal->cross(n).normalized();
    for (int i = 1; i <= kEachSide; ++i) {
      add(side, alpha * i / kEachSide);
      add(side, -alpha * i / kEachSide);
    }
    return out;
  }
  constexpr int kSpokes = 12;
  const Vector3d u = n.unitOrthogonal(), v = n.cross(u);
  for (int spoke = 0; spoke < kSpokes; ++spoke) {
    const double azimuth = 2 * M_PI * spoke / kSpokes;
    const Vector3d side = std::cos(azimuth) * u + std::sin(azimuth) * v;
    add(side, alpha);
    if (spoke % 2 == 0) add(side, alpha / 2);
  }
  return out;
}

/// Where the cone's maxima are at the best candidates, in B: there the bound has to be sharp.
std::vector<Vector3d> active_directions(const CaptureProblem& problem,
                                        const Formulation& formulation, const SearchResult& found,
                                        double best, const Encounter& encounter) {
  constexpr double kNearlyBest = 1.02;
  constexpr int kMostCandidates = 6;
  constexpr double kNearlyActive = 0.95;
  std::vector<Vector3d> out;
  int looked_at = 0;
  for (const Candidate& candidate : found.candidates) {
    if (candidate.value > kNearlyBest * best || ++looked_at > kMostCandidates) continue;
    const auto maxima = cone_maxima(problem, formulation, candidate.configuration);
    for (const ConeMaximum& maximum : maxima) {
      if (maximum.value < kNearlyActive * maxima.front().value) continue;
      out.push_back(encounter.R_EB.transpose() * maximum.scenario.direction);
    }
  }
  return out;
}

/// The impulse of the contact law along a direction of the cone.
ImpulseCase impulse_along(const CaptureProblem& problem, const Encounter& encounter,
                          const Vector3d& direction) {
  ImpulseCase out;
  out.F << direction, encounter.F.tail<3>();
  if (encounter.magnitude_given) {
    out.numerator = problem.impulse.magnitude;
    return out;
  }
  const double speed =
      encounter.speed_stated ? encounter.closing_speed : direction.dot(encounter.velocity);
  out.numerator = (1 + problem.impulse.restitution) * std::max(speed, 0.0);
  const Vector3d lever = encounter.r.cross(direction);
  out.target_inverse_mass =
      1 / encounter.target_mass + lever.dot(encounter.target_inverse_inertia * lever);
  return out;
}

std::vector<ImpulseCase> impulses_of(const CaptureProblem& problem, const Formulation& formulation,
                                     const SearchResult& found, double best) {
  const Configuration stated{problem.start, problem.base, problem.variables.contact_time_lower};
  const Encounter encounter = formulation.encounter(stated);
  const Vector3d n = encounter.F.head<3>();
  std::vector<ImpulseCase> out = {impulse_along(problem, encounter, n)};
  const bool is_cone = problem.uncertainty.cone_half_angle > 0;
  if (problem.measure.kind != RiskMeasure::WorstCase || !is_cone) return out;
  std::vector<Vector3d> directions =
      active_directions(problem, formulation, found, best, encounter);
  for (const Vector3d& direction : spread_directions(problem, n)) directions.push_back(direction);
  std::vector<Vector3d> known = {n};
  for (const Vector3d& direction : directions) {
    // A little inside, so that rounding does not put it outside of the cone.
    constexpr double kInside = 1e-10, kSame = 1e-6;
    const Vector3d inside = (direction + kInside * n).normalized();
    const auto is_same = [&](const Vector3d& other) { return (other - inside).norm() < kSame; };
    if (std::any_of(known.begin(), known.end(), is_same)) continue;
    known.push_back(inside);
    out.push_back(impulse_along(problem, encounter, inside));
  }
  return out;
}

}  // namespace

void add_bound(const CaptureProblem& problem, const Formulation& formulation,
               const SearchResult& found, const StopCondition& stop, Proof& proof) {
  // A path that decides where the robot is hit leads to other encounters.
  if (!minimum_objection(problem).empty() || path_decides(problem)) return;
  std::optional<double> best;
  for (std::size_t c = 0; c < found.candidates.size(); ++c) {
    if (status_of(found.certificates[c]) == PlanStatus::Infeasible) continue;
    const double value = found.candidates[c].value;
    best = best ? std::min(*best, value) : value;
  }
  if (!best || *best <= kZero * formulation.objective_unit()) return;
  const MinimumBound bound = prove_minimum(problem, impulses_of(problem, formulation, found, *best),
                                           proof, *best, {.stop = stop});
  proof.boxes += bound.boxes;
  const bool is_proven = bound.lower_bound > 0;
  if (proof.status != ProofStatus::NotApplicable) {
    proof.statement += "; " + bound.statement;
  } else if (is_proven) {
    proof.statement = "proven: " + bound.statement;
  } else {
    proof.statement += "; " + bound.statement;
  }
  if (!is_proven) return;
  proof.lower_bound = bound.lower_bound;
  proof.gap = bound.gap;
}

}  // namespace stillbase
