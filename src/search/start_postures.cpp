#include "search/start_postures.hpp"

#include <utility>

#include <stillbase/core/parallel.hpp>
#include <stillbase/core/random.hpp>

#include "search/screening.hpp"

namespace stillbase {

StartPostures::StartPostures(const CaptureProblem& problem, const Formulation& formulation,
                             const SearchOptions& options, bool isolated, int jobs)
    : problem_(problem),
      formulation_(formulation),
      options_(options),
      isolated_(isolated),
      jobs_(jobs),
      drawn_starts_((isolated ? options.starts_per_isolated : 1) * options.starts),
      steps_(isolated ? 60 : 15) {}

int StartPostures::starts() const {
  return drawn_starts_ + static_cast<int>(options_.more_starts.size());
}

ProjectionResult StartPostures::of(int start) const {
  if (start >= drawn_starts_) {
    return projected(options_.more_starts[static_cast<std::size_t>(start - drawn_starts_)]);
  }
  ProjectionResult best = projected(drawn(start));
  // Many random postures cannot be projected: another draw costs far less than a solve.
  for (int draw = 1;
       draw <= options_.more_draws && !isolated_ && best.violation > options_.on_constraints;
       ++draw) {
    const ProjectionResult trial = projected(drawn(start + draw * drawn_starts_));
    if (trial.violation < best.violation) best = trial;
  }
  return best;
}

Eigen::VectorXd StartPostures::drawn(int index) const {
  return formulation_.start_point(
      low_discrepancy_point(index, formulation_.num_variables(), options_.seed));
}

ProjectionResult StartPostures::projected(const Eigen::VectorXd& x) const {
  return project_onto_constraints(formulation_, x, false, steps_);
}

std::vector<Eigen::VectorXd> StartPostures::moved_onto_constraints(int count, int steps,
                                                                   bool zero_objective,
                                                                   const PointOf& start) const {
  std::vector<ProjectionResult> ends(static_cast<std::size_t>(count));
  std::vector<Eigen::VectorXd> out;
  const auto work = [&](int i) {
    ends[static_cast<std::size_t>(i)] =
        project_onto_constraints(formulation_, start(i), zero_objective, steps);
  };
  const auto take = [&](int i) {
    const ProjectionResult& end = ends[static_cast<std::size_t>(i)];
    if (end.violation <= options_.on_constraints) out.push_back(end.x);
  };
  for_each_index(jobs_, count, options_.stop, work, take);
  return out;
}

MeasureStarts StartPostures::first(std::vector<Eigen::VectorXd> postures,
                                   std::vector<Eigen::VectorXd> solutions, bool in_rounds) const {
  const std::vector<Eigen::VectorXd> drawn = drawn_postures(0);
  postures.insert(postures.end(), drawn.begin(), drawn.end());
  const int kept = options_.minima.first;
  return {best(postures, kept), in_rounds ? best(solutions, kept) : std::move(solutions)};
}

std::vector<Eigen::VectorXd> StartPostures::best(const std::vector<Eigen::VectorXd>& points,
                                                 int kept) const {
  return best_by_screening(problem_, formulation_, points, kept, options_.screening);
}

std::vector<Eigen::VectorXd> StartPostures::drawn_postures(int batch) const {
  const int first = drawn_starts_ * (1 + options_.more_draws) + batch * options_.screening.drawn;
  return moved_onto_constraints(options_.screening.drawn, steps_, false,
                                [&](int i) { return drawn(first + i); });
}

std::vector<Eigen::VectorXd> StartPostures::fresh(int round) {
  const PhaseClock::Phase phase(options_.clock, "search.screening");
  const std::vector<Eigen::VectorXd> postures = drawn_postures(1 + round);
  std::vector<Eigen::VectorXd> zeros;
  if (may_be_zero_) {
    zeros = moved_onto_constraints(static_cast<int>(postures.size()), 10, true,
                                   [&](int i) { return postures[static_cast<std::size_t>(i)]; });
    may_be_zero_ = !zeros.empty();
  }
  const int kept = options_.minima.fresh;
  std::vector<Eigen::VectorXd> out = best(postures, kept);
  for (Eigen::VectorXd& x : best(walk_along_zeros(zeros, round), kept)) out.push_back(std::move(x));
  return out;
}

std::vector<Eigen::VectorXd> StartPostures::walk_along_zeros(std::vector<Eigen::VectorXd> zeros,
                                                             int round) const {
  const MeasureSearchOptions& effort = options_.minima;
  if (zeros.empty()) return zeros;
  zeros = best(zeros, effort.fresh);
  Eigen::VectorXd values = screen(problem_, formulation_, zeros, options_.screening);
  Random random(options_.seed, 2 + static_cast<std::uint64_t>(round));
  for (int step = 0; step < effort.self_motion_steps && !options_.stop.reached(); ++step) {
    std::vector<Eigen::VectorXd> moved;
    std::vector<bool> is_zero;
    for (const Eigen::VectorXd& zero : zeros) {
      const Eigen::VectorXd there = hopped(zero, random, effort);
      const ProjectionResult end = project_onto_constraints(formulation_, there, true, 10);
      is_zero.push_back(end.violation <= options_.on_constraints);
      moved.push_back(end.x);
    }
    const Eigen::VectorXd trial = screen(problem_, formulation_, moved, options_.screening);
    for (std::size_t i = 0; i < zeros.size(); ++i) {
      const auto k = static_cast<Eigen::Index>(i);
      if (!is_zero[i] || !(trial[k] < values[k])) continue;
      zeros[i] = moved[i];
      values[k] = trial[k];
    }
  }
  return zeros;
}

}  // namespace stillbase
