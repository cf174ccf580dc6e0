#include "planner/contact_refinement.hpp"

#include <algorithm>
#include <stdexcept>

#include <stillbase/core/constants.hpp>
#include <stillbase/nlp/optimizer.hpp>

#include "formulation/measures/measure.hpp"

namespace stillbase {

namespace {

double distance(const Pose& a, const Pose& b) {
  return (a.position - b.position).norm() +
         rotation_log(a.orientation.conjugate() * b.orientation).norm();
}

}  // namespace

ContactRefinement::ContactRefinement(const CaptureProblem& problem, const Eigen::VectorXd& x,
                                     const Candidate& candidate, const Certificate& certificate,
                                     const StopCondition& stop,
                                     const ContactRefinementOptions& options)
    : problem_(problem),
      candidate_(candidate),
      certificate_(certificate),
      stop_(stop),
      options_(options),
      best_{{candidate.configuration.base, x}} {}

const Formulation& ContactRefinement::formulation() {
  if (formulation_ == nullptr) {
    formulation_ = std::make_unique<Formulation>(problem_);
    formulation_->give_up_simulations_at(stop_);
  }
  return *formulation_;
}

ContactSolver ContactRefinement::solver() {
  ContactSolver solver;
  solver.at_base = [this](const Pose& base, ContactSolve how) { return at_base(base, how); };
  solver.near_posture = [this](const JointVectord& phi, ContactSolve how) {
    return near_posture(phi, how);
  };
  solver.measure = [this](const Configuration& configuration) {
    return Measure(problem_, formulation()).reported(formulation().variables(configuration));
  };
  return solver;
}

CaptureProblem ContactRefinement::stated_at(const Pose& base) const {
  CaptureProblem problem = problem_;
  problem.base = base;
  return problem;
}

Eigen::VectorXd ContactRefinement::best_near(const Pose& base) const {
  return std::min_element(best_.begin(), best_.end(),
                          [&](const Known& a, const Known& b) {
                            return distance(a.base, base) < distance(b.base, base);
                          })
      ->x;
}

ProjectionResult ContactRefinement::optimum(const CaptureProblem& problem,
                                            const Formulation& formulation,
                                            const Eigen::VectorXd& x) {
  if (formulation.freedom() == 0) return {x, kInfinity};
  nlp::OptimizeOptions options;
  options.max_evaluations = options_.evaluations;
  options.stop = stop_;
  options.seed = problem_.search.seed;
  const auto optimizer = nlp::make_optimizer(problem_.search.optimizer);
  const MeasureSolution result = Measure(problem, formulation).finish(*optimizer, options, x);
  optimizer_calls_ += result.solver_calls;
  return project_onto_constraints(formulation, result.x, false, options_.projection_steps);
}

std::optional<Configuration> ContactRefinement::at_base(const Pose& base, ContactSolve how) {
  if (stop_.reached()) return std::nullopt;
  const CaptureProblem problem = stated_at(base);
  Formulation formulation(problem);
  formulation.give_up_simulations_at(stop_);
  const bool best = how == ContactSolve::Best;
  const Eigen::VectorXd x0 = best ? best_near(base) : best_.back().x;
  ProjectionResult solved =
      project_onto_constraints(formulation, x0, false, options_.projection_steps);
  if (best) {
    const ProjectionResult better = optimum(problem, formulation, solved.x);
    if (better.violation <= kFeasibilityTolerance) solved = better;
  }
  if (!(solved.violation <= kFeasibilityTolerance)) return std::nullopt;
  if (best) best_.push_back({base, solved.x});
  const Configuration found = formulation.configuration(solved.x);
  returned_.emplace_back(found.phi, solved.x);
  return found;
}

// The variables begin with the free joints, in their order.
std::optional<Configuration> ContactRefinement::near_posture(const JointVectord& phi,
                                                             ContactSolve how) {
  const Formulation& at_contact = formulation();
  Eigen::VectorXd x = best_.front().x;
  Eigen::Index row = 0;
  for (int k = 0; k < problem_.robot.n(); ++k) {
    if (problem_.variables.joints[static_cast<std::size_t>(k)]) x[row++] = phi[k];
  }
  ProjectionResult solved =
      project_onto_constraints(at_contact, x, false, options_.projection_steps);
  if (how == ContactSolve::Best && problem_.measure.kind != RiskMeasure::Nominal) {
    solved = optimum(problem_, at_contact, solved.x);
  } else if (how == ContactSolve::Best) {
    // Where the objective can vanish its zeros form a continuum: the nearest one is taken.
    const ProjectionResult zero =
        project_onto_constraints(at_contact, solved.x, true, options_.projection_steps);
    Eigen::VectorXd y;
    Eigen::MatrixXd slope;
    if (zero.violation <= kFeasibilityTolerance) at_contact.objective_vector(zero.x, y, slope);
    const bool vanishes = zero.violation <= kFeasibilityTolerance && y.norm() <= kZeroObjective;
    solved = vanishes ? zero : optimum(problem_, at_contact, solved.x);
  }
  if (!(solved.violation <= kFeasibilityTolerance)) return std::nullopt;
  const Configuration found = at_contact.configuration(solved.x);
  returned_.emplace_back(found.phi, solved.x);
  return found;
}

CertifiedCandidate ContactRefinement::certify(const JointVectord& phi, const Pose& base) const {
  const auto at = std::find_if(returned_.rbegin(), returned_.rend(),
                               [&](const auto& pair) { return pair.first == phi; });
  if (at == returned_.rend()) throw std::logic_error("the path ends where no contact was solved");
  const Eigen::VectorXd& x = at->second;
  const bool follows = problem_.approach.base == BaseMode::Floating;
  const CaptureProblem problem = follows ? stated_at(base) : problem_;
  return certify_candidate(problem, Formulation(problem), x, candidate_, certificate_);
}

}  // namespace stillbase
