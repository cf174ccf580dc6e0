#include "planner/candidates.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include <stillbase/core/parallel.hpp>
#include <stillbase/formulation/measures/robust.hpp>
#include <stillbase/nlp/certificate.hpp>
#include <stillbase/planner/post_impact.hpp>

#include "formulation/measures/measure.hpp"
#include "plan/exclusion_words.hpp"
#include "planner/after_impact.hpp"
#include "planner/choice.hpp"
#include "planner/self_motion.hpp"

namespace stillbase {

// A hand that moves is there at the contact alone: its run to it is judged with the path.
std::string CollisionJudge::first_collision(const Configuration& configuration) const {
  const auto kinematics = compute_kinematics<double>(problem_.robot, configuration.phi);
  const std::optional<TargetMotion> motion = target_towards(configuration);
  // The approach keeps its clearance up to the contact, so a candidate must offer it.
  const double margin = problem_.approach.enabled ? least_distance(problem_.approach) : 0;
  if (!motion) {
    const auto hit = scene_.first_hit(kinematics, configuration.base, nullptr, margin);
    return hit ? to_string(*hit) : "";
  }
  // From the contact backwards: what is reported is the collision nearest to it.
  const double wait = problem_.hand_motion.moves() ? 0 : problem_.approach.wait;
  const double speed =
      std::max(1e-3, motion->state(configuration.contact_time).linear_velocity.norm());
  const int steps = static_cast<int>(std::clamp(std::ceil(wait * speed / 0.01), 1.0, 2000.0));
  const auto pose = [&](int i) {
    return motion->state(configuration.contact_time - wait * i / steps).pose;
  };
  const auto hit =
      scene_.first_hit_of_each(kinematics, configuration.base, steps + 1, pose, margin);
  return hit ? to_string(*hit) : "";
}

void CollisionJudge::judge(Candidate& candidate) const {
  candidate.collision = first_collision(candidate.configuration);
  candidate.collision_free = candidate.collision.empty();
}

void CollisionJudge::judge_all(int jobs, const StopCondition& stop,
                               std::vector<Candidate>& candidates) const {
  for (Candidate& candidate : candidates) {
    candidate.collision = exclusion::kNotJudged;
    candidate.collision_free = false;
  }
  for_each_index(jobs, static_cast<int>(candidates.size()), stop,
                 [&](int i) { judge(candidates[static_cast<std::size_t>(i)]); });
}

bool base_follows_path(const CaptureProblem& problem) {
  return problem.approach.enabled && problem.approach.base == BaseMode::Floating &&
         !problem.approach.station_free;
}

bool path_decides(const CaptureProblem& problem) {
  const bool within_null_space = problem.approach.base == BaseMode::ReactionNull;
  return base_follows_path(problem) || (problem.approach.enabled && within_null_space);
}

CaptureProblem at_contact(const CaptureProblem& problem, const Configuration& configuration) {
  CaptureProblem at = problem;
  if (base_follows_path(problem)) at.base = configuration.base;
  return at;
}

std::optional<std::string> AfterImpactJudge::known(const Configuration& configuration) {
  const std::lock_guard lock(mutex_);
  const auto at = std::find_if(known_.begin(), known_.end(), [&](const auto& one) {
    return is_same_configuration(one.first, configuration);
  });
  return at != known_.end() ? std::optional(at->second) : std::nullopt;
}

std::vector<std::string> AfterImpactJudge::simulate(
    const std::vector<Configuration>& configurations) {
  std::vector<ImpactSummary> impacts;
  impacts.reserve(configurations.size());
  for (const Configuration& at : configurations) {
    impacts.push_back(impact_at(problem_, model_, encounter_at(model_, at), at.phi));
  }
  auto failures = post_impact_failures(problem_, model_, configurations, impacts, stop_);
  const std::lock_guard lock(mutex_);
  for (std::size_t i = 0; i < failures.size(); ++i) {
    if (failures[i] != exclusion::kNotJudged) known_.emplace_back(configurations[i], failures[i]);
  }
  return failures;
}

std::string AfterImpactJudge::failure(const Configuration& configuration) {
  if (const auto failure = known(configuration)) return *failure;
  if (stop_.reached()) return exclusion::kNotJudged;
  const PhaseClock::Phase phase(clock_, "after_impact");
  return simulate({configuration}).front();
}

void AfterImpactJudge::judge_all(const std::vector<Configuration>& configurations) {
  const PhaseClock::Phase phase(clock_, "after_impact");
  std::vector<Configuration> open;
  for (const Configuration& at : configurations) {
    const bool repeats = std::any_of(open.begin(), open.end(), [&](const Configuration& other) {
      return is_same_configuration(other, at);
    });
    if (!repeats && !known(at)) open.push_back(at);
  }
  const int count = static_cast<int>(open.size());
  const int together = size_of_group(count, jobs_);
  for_each_index(jobs_, (count + together - 1) / together, stop_, [&](int i) {
    const int before = i * together;
    const auto first = open.begin() + before;
    simulate({first, first + std::min(together, count - before)});
  });
}

void AfterImpactJudge::judge_from(std::size_t place, const std::vector<Candidate>& candidates) {
  if (!candidates[place].collision_free || known(candidates[place].configuration)) return;
  const auto most =
      static_cast<std::size_t>(jobs_) * static_cast<std::size_t>(simulated_together(problem_));
  std::vector<Configuration> to_judge;
  for (std::size_t i = place; i < candidates.size() && to_judge.size() < most; ++i) {
    if (candidates[i].collision_free) to_judge.push_back(candidates[i].configuration);
  }
  judge_all(to_judge);
}

CandidateOrder::CandidateOrder(const CaptureProblem& problem,
                               const std::vector<Candidate>& candidates, AfterImpactJudge& after)
    : problem_(problem), candidates_(candidates), after_(after) {
  judge_on();
}

void CandidateOrder::judge_on() {
  const std::size_t before = holding_.size();
  while (judged_ < candidates_.size() && holding_.size() == before) {
    after_.judge_from(judged_, candidates_);
    take_next();
  }
}

void CandidateOrder::take_next() {
  const std::size_t i = judged_++;
  const Candidate& candidate = candidates_[i];
  if (!candidate.collision_free) {
    excluded_[i] = exclusion::kAtContact + candidate.collision;
    colliding_.push_back(i);
    return;
  }
  const std::string failure = after_.failure(candidate.configuration);
  if (!failure.empty()) excluded_[i] = exclusion::kAfterImpact + failure;
  (failure.empty() ? holding_ : others_).push_back(i);
}

void CandidateOrder::judge_up_to(std::size_t end) {
  std::vector<Configuration> to_judge;
  for (std::size_t i = judged_; i < end; ++i) {
    if (candidates_[i].collision_free) to_judge.push_back(candidates_[i].configuration);
  }
  after_.judge_all(to_judge);
  while (judged_ < end) take_next();
}

void CandidateOrder::judge_good_ones(double factor) {
  if (holding_.empty()) return;  // all are judged
  const Candidate& best = candidates_[holding_.front()];
  std::size_t end = candidates_.size();
  while (end > judged_ && !is_good(problem_, candidates_[end - 1], best, factor)) --end;
  judge_up_to(end);
}

std::size_t CandidateOrder::first() const {
  if (!holding_.empty()) return holding_.front();
  return others_.empty() ? 0 : others_.front();
}

std::optional<std::size_t> CandidateOrder::at(std::size_t place) {
  while (holding_.size() <= place && judged_ < candidates_.size()) judge_on();
  std::vector<std::size_t> all = holding_;
  all.insert(all.end(), others_.begin(), others_.end());
  if (base_follows_path(problem_)) all.insert(all.end(), colliding_.begin(), colliding_.end());
  if (all.empty()) all.push_back(first());
  return place < all.size() ? std::optional(all[place]) : std::nullopt;
}

CertifiedCandidate certify_candidate(const CaptureProblem& problem, const Formulation& formulation,
                                     const Eigen::VectorXd& x, const Candidate& candidate,
                                     const Certificate& certificate) {
  Measure measure(problem, formulation);
  CertifiedCandidate out{candidate, certificate, formulation.report(x)};
  out.candidate.configuration = formulation.configuration(x);
  out.candidate.objective = nominal_value(problem, formulation, out.candidate.configuration);
  out.candidate.worst_case = worst_case(problem, formulation, out.candidate.configuration).value;
  out.candidate.value = measure.reported(x);
  out.candidate.max_violation = 0;
  for (const ConstraintValue& value : out.constraints) {
    out.candidate.max_violation = std::max(out.candidate.max_violation, value.violation);
  }
  out.certificate.max_violation = out.candidate.max_violation;
  const nlp::Certificate kkt = measure.certify(x);
  out.certificate.kkt_residual = kkt.kkt_residual;
  out.certificate.reduced_hessian_min_eigenvalue = kkt.reduced_hessian_min_eigenvalue;
  return out;
}

}  // namespace stillbase
