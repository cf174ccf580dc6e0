#include "planner/approach_stage.hpp"

#include <algorithm>
#include <atomic>
#include <iterator>
#include <list>
#include <memory>
#include <set>
#include <utility>

#include <fmt/format.h>

#include <stillbase/approach/approach.hpp>
#include <stillbase/core/parallel.hpp>
#include <stillbase/planner/post_impact.hpp>

#include "plan/exclusion_words.hpp"
#include "planner/candidates.hpp"
#include "planner/contact_refinement.hpp"
#include "planner/other_forms.hpp"
#include "planner/self_motion.hpp"

namespace stillbase {

namespace {

std::string no_path_words(const Approach& approach) {
  return fmt::format("{}{}{}{}", exclusion::kNoPath, to_string(approach.status),
                     approach.detail.empty() ? "" : ", ", approach.detail);
}

class Stage {
 public:
  Stage(const CaptureProblem& problem, const EncounterModel& encounter,
        const CollisionJudge& collisions, const SearchResult& found, const Proof& proof,
        std::uint64_t seed, AfterImpactJudge& after, const PlannerOptions& options,
        std::map<std::string, long>& solver_calls)
      : problem_(problem),
        encounter_(encounter),
        collisions_(collisions),
        found_(found),
        proof_(proof),
        seed_(seed),
        after_(after),
        options_(options),
        path_options_(options.approach),
        solver_calls_(solver_calls),
        order_(problem, found.candidates, after) {
    path_options_.clock = options.clock;
    path_options_.jobs = jobs_or_processors(options.jobs);
    chosen_.candidate = order_.first();
  }

  ChosenApproach choose() {
    if (!problem_.approach.enabled) {
      without_approach();
    } else if (options_.stop.reached()) {
      chosen_.approach.status = ApproachStatus::Stopped;
    } else if (base_follows_path(problem_) || !to_any()) {
      one_by_one();
    }
    if (problem_.approach.effort == ApproachEffort::Best && chosen_.holds) go_on_to_better_ones();
    chosen_.excluded = std::move(excluded_);
    chosen_.excluded.insert(order_.excluded().begin(), order_.excluded().end());
    return chosen_;
  }

 private:
  /// A goal of a set: a candidate, another form of one, or a sample of the self-motion beside one.
  struct Goal {
    std::size_t candidate;
    std::optional<CertifiedCandidate> other;  ///< in place of the candidate, or beside it
    bool is_sample = false;
    std::optional<TargetMotion> motion;
    std::unique_ptr<ContactRefinement> contact;  ///< not of a sample
    int base_hits = 0;  ///< attempts beside other goals on which the target touches the base
  };

  void without_approach() {
    const Candidate& best = found_.candidates[chosen_.candidate];
    chosen_.holds = best.collision_free && keeps_limits(chosen_.candidate);
    if (best.collision_free) return;
    if (best.collision == exclusion::kNotJudged) {
      chosen_.approach.status = ApproachStatus::Stopped;
      return;
    }
    chosen_.approach.status = ApproachStatus::GoalInvalid;
    chosen_.approach.detail =
        fmt::format("no candidate is free of collision; the best one: {}", best.collision);
  }

  /// Whether a candidate as the search left it keeps the limits after the impact.
  bool keeps_limits(std::size_t candidate) const {
    const std::vector<std::size_t>& holding = order_.holding();
    return std::find(holding.begin(), holding.end(), candidate) != holding.end();
  }

  std::unique_ptr<ContactRefinement> contact_at(std::size_t i) const {
    return contact_at(i, found_.points[i], found_.candidates[i]);
  }
  /// @param x, candidate of candidate i, in one of its forms
  std::unique_ptr<ContactRefinement> contact_at(std::size_t i, const Eigen::VectorXd& x,
                                                const Candidate& candidate) const {
    return std::make_unique<ContactRefinement>(problem_, x, candidate, found_.certificates[i],
                                               options_.stop, options_.contact_refinement);
  }

  /// Other forms of a candidate as goals, those that touch nothing and keep the limits after the
  /// impact.
  std::list<Goal> other_forms(std::size_t i) {
    std::vector<Configuration> forms = other_turns_of(problem_, found_, i, options_.other_turns);
    for (Configuration& roll : other_rolls_of(problem_, found_, i, options_.other_rolls)) {
      forms.push_back(std::move(roll));
    }
    std::vector<Candidate> trials;
    std::vector<Configuration> to_judge;
    for (const Configuration& form : forms) {
      Candidate trial = found_.candidates[i];
      trial.configuration = form;
      collisions_.judge(trial);
      if (!trial.collision_free && !base_follows_path(problem_)) continue;
      trials.push_back(trial);
      to_judge.push_back(form);
    }
    after_.judge_all(to_judge);
    std::list<Goal> out;
    for (const Candidate& trial : trials) {
      if (!after_.keeps_limits(trial.configuration)) continue;
      const Eigen::VectorXd x = variables_of_form(problem_, found_, i, trial.configuration);
      CertifiedCandidate there =
          certify_candidate(problem_, formulation(), x, trial, found_.certificates[i]);
      auto contact = contact_at(i, x, there.candidate);
      auto motion = collisions_.target_towards(there.candidate.configuration);
      out.push_back({i, std::move(there), false, std::move(motion), std::move(contact)});
    }
    return out;
  }

  /// Made when first asked for. Gives no simulations up: what is certified is stated.
  const Formulation& formulation() {
    if (formulation_ == nullptr) {
      formulation_ = std::make_unique<const Formulation>(problem_, encounter_);
    }
    return *formulation_;
  }

  void count_calls(const ContactRefinement& contact) {
    if (contact.optimizer_calls() == 0) return;
    solver_calls_[problem_.search.optimizer] += contact.optimizer_calls();
  }

  /// Records an approach to a candidate, or to the configuration at its end where the path decides.
  /// @return whether it leads to a configuration whose limits hold after the impact
  bool take(const Approach& approach, std::size_t candidate, const ContactRefinement* contact) {
    const bool found = arrives(approach);
    std::optional<CertifiedCandidate> there;
    if (found && path_decides(problem_)) there = certified_end(approach, *contact);
    // A configuration that came with its path was not judged by its time after the impact yet.
    const bool holds = found && (!there || after_.keeps_limits(there->candidate.configuration));
    if (!tried_ || holds || (found && !has_fallback_)) {
      chosen_ = {candidate, approach, there, false,
                 there ? holds : found && keeps_limits(candidate)};
      has_fallback_ = found;
    }
    tried_ = true;
    return holds;
  }

  /// Tries the candidates that rank before the reached one by themselves, best first. Where the
  /// path decides on the configuration at its end, the best of these is taken, of at most
  /// `max_approaches`.
  void go_on_to_better_ones() {
    int tried = 0;
    for (std::size_t k = 0; k < order_.holding().size(); ++k) {
      const Candidate& reached =
          chosen_.certified ? chosen_.certified->candidate : found_.candidates[chosen_.candidate];
      const std::size_t i = order_.holding()[k];
      const double gained = reached.value - found_.candidates[i].value;
      if (options_.stop.reached()) return;
      if (!(gained > options_.improvement * reached.value) || tried_alone_.count(i) > 0) continue;
      if (path_decides(problem_) && tried++ == problem_.approach.max_approaches) return;
      std::unique_ptr<ContactRefinement> contact;
      const Approach approach = approach_to(i, seed_ + k, &contact);
      if (!arrives(approach)) {
        if (path_decides(problem_)) continue;
        std::list<Goal> goals = other_forms(i);
        if (goals.empty()) continue;
        const ApproachToAny any = approach_to_goals(goals, seed_ + k, path_options_);
        if (!arrives(any.approach)) continue;
        const auto form = std::next(goals.begin(), static_cast<std::ptrdiff_t>(any.goal));
        chosen_ = {i, any.approach, form->other, false, true};
        return;
      }
      if (!path_decides(problem_)) {
        chosen_ = {i, approach, std::nullopt, false, true};
        return;
      }
      CertifiedCandidate there = certified_end(approach, *contact);
      if (!there.candidate.collision_free) {
        excluded_[i] = exclusion::kAtPathEnd + there.candidate.collision;
      } else if (!(there.candidate.value < reached.value)) {
        excluded_[i] = exclusion::kNoBetterAtPathEnd;
      } else if (std::string broken = after_.failure(there.candidate.configuration);
                 !broken.empty()) {
        excluded_[i] = exclusion::kAfterPathEnd + broken;
      } else {
        chosen_ = {i, approach, std::move(there), false, true};
      }
    }
  }

  /// The configuration at the end of a path that decides on it.
  CertifiedCandidate certified_end(const Approach& approach,
                                   const ContactRefinement& contact) const {
    CertifiedCandidate there =
        contact.certify(approach.joint_positions.back(), approach.base_poses.back());
    collisions_.judge(there.candidate);
    return there;
  }

  /// The path to one candidate.
  Approach approach_to(std::size_t i, std::uint64_t seed,
                       std::unique_ptr<ContactRefinement>* contact_out = nullptr) {
    const Configuration& goal = found_.candidates[i].configuration;
    const std::optional<TargetMotion> motion = collisions_.target_towards(goal);
    std::unique_ptr<ContactRefinement> contact = contact_at(i);
    Approach approach =
        plan_approach(problem_, goal, motion ? &*motion : nullptr, seed, options_.stop,
                      solver_calls_, contact->solver(), path_options_);
    count_calls(*contact);
    tried_alone_.insert(i);
    if (!arrives(approach)) excluded_[i] = no_path_words(approach);
    if (approach.base_hits >= path_options_.base_hits) has_base_in_the_way_.insert(i);
    if (contact_out != nullptr) *contact_out = std::move(contact);
    return approach;
  }

  /// Tries each candidate, at most `max_approaches`, and other forms of the good ones before the
  /// other candidates, or behind all of them. Where one fails its neighbours mostly fail too, so
  /// that they come last.
  void one_by_one() {
    if (path_decides(problem_)) order_.judge_all();
    std::vector<std::size_t> tried;       // candidates
    std::vector<std::size_t> neighbours;  // their places in the order
    for (std::size_t place = 0; !is_over(tried.size()); ++place) {
      const std::optional<std::size_t> candidate = order_.at(place);
      if (!candidate) break;
      const bool is_new = std::none_of(tried.begin(), tried.end(), [&](std::size_t other) {
        return are_neighbours(*candidate, other);
      });
      if (!is_new) {
        neighbours.push_back(place);
        continue;
      }
      if (try_at(place, tried)) return;
    }
    for (const std::size_t place : neighbours) {
      if (is_over(tried.size())) break;
      if (try_at(place, tried)) return;
    }
    if (!is_stopped() && to_other_forms_once()) return;
    if (!is_stopped()) to_other_forms(true);
  }

  /// Of those candidates for which another form may help: where the target touches the base, a path
  /// to another roll or turn moves the base alike, so that these come last of all.
  bool to_other_forms_once() {
    return !std::exchange(are_forms_tried_, true) && to_other_forms(false);
  }

  bool is_stopped() const { return tried_ && options_.stop.reached(); }
  bool is_over(std::size_t tried) const {
    return is_stopped() || tried == static_cast<std::size_t>(problem_.approach.max_approaches);
  }

  /// Tries the candidate at a place of the order. @return as take()
  bool try_at(std::size_t place, std::vector<std::size_t>& tried) {
    if (!is_goal(place) && to_other_forms_once()) return true;
    if (is_stopped()) return false;
    const std::size_t candidate = *order_.at(place);
    progress(static_cast<int>(tried.size()));
    tried.push_back(candidate);
    std::unique_ptr<ContactRefinement> contact;
    const Approach approach = approach_to(candidate, seed_ + place, &contact);
    return take(approach, candidate, contact.get());
  }

  /// Goes for other forms of the good candidates: for all at once, where one path can, then for at
  /// most `max_approaches` one by one.
  /// @param of_base_hits of the candidates on whose paths the target touches the base, else of the
  ///   others
  /// @return as take()
  bool to_other_forms(bool of_base_hits) {
    std::list<std::list<Goal>> forms;
    for (std::size_t k = 0; k < order_.holding().size() && !options_.stop.reached(); ++k) {
      if (static_cast<int>(forms.size()) == problem_.approach.max_approaches) break;
      const std::size_t candidate = order_.holding()[k];
      const bool has_base_hits = has_base_in_the_way_.count(candidate) > 0;
      if (!is_goal(k) || has_base_hits != of_base_hits) continue;
      if (forms_tried_.insert(candidate).second) forms.push_back(other_forms(candidate));
    }
    // The first form of each candidate, then the second one of each.
    std::list<Goal> goals;
    while (!forms.empty()) {
      forms.remove_if([](const auto& goals_of_one) { return goals_of_one.empty(); });
      for (auto& goals_of_one : forms) {
        goals.splice(goals.end(), goals_of_one, goals_of_one.begin());
      }
    }
    if (goals.empty()) return false;
    if (!base_follows_path(problem_) && to_any_of(goals, path_options_)) return true;
    return to_first_of(goals);
  }

  /// Goes for goals one by one, several at a time, at most `max_approaches`: the first one in their
  /// order counts.
  /// @return as take()
  bool to_first_of(const std::list<Goal>& goals) {
    struct Attempt {
      const Goal* goal;
      Approach approach;
      std::map<std::string, long> calls;
    };
    std::vector<Attempt> attempts;
    for (const Goal& goal : goals) {
      if (static_cast<int>(attempts.size()) == problem_.approach.max_approaches) break;
      attempts.push_back({&goal, {}, {}});
    }
    // Functions of the user need not stand several calls at once.
    const int jobs =
        problem_.user.empty() ? std::min(path_options_.jobs, static_cast<int>(attempts.size())) : 1;
    ApproachOptions path_options = path_options_;
    if (jobs > 1) {
      path_options.jobs = 1;
      path_options.clock = nullptr;  // threads beside each other enter no phases
    }
    const PhaseClock::Phase phase(options_.clock, "approach.path");
    std::atomic<bool> is_reached{false};
    const auto work = [&](int i) {
      if (is_reached) return;
      auto& [goal, approach, calls] = attempts[static_cast<std::size_t>(i)];
      ApproachOptions own_options = path_options;
      own_options.base_hits = std::max(1, own_options.base_hits - goal->base_hits);
      approach =
          plan_approach(problem_, configuration_of(*goal), goal->motion ? &*goal->motion : nullptr,
                        seed_, options_.stop, calls, goal->contact->solver(), own_options);
    };
    const auto take = [&](int i) {
      if (is_reached) return;
      const auto& [goal, approach, calls] = attempts[static_cast<std::size_t>(i)];
      progress(i);
      for (const auto& [name, count] : calls) solver_calls_[name] += count;
      count_calls(*goal->contact);
      is_reached = arrives(approach) && take_form(approach, *goal);
    };
    for_each_index(jobs, static_cast<int>(attempts.size()), options_.stop, work, take);
    return is_reached;
  }

  /// Records an approach to another form of a candidate. @return as take()
  bool take_form(const Approach& approach, const Goal& reached) {
    const bool holds = take(approach, reached.candidate, reached.contact.get());
    // Where the path decides, its end is certified.
    if (path_decides(problem_)) return holds;
    chosen_.certified = reached.other;
    chosen_.is_sample = reached.is_sample;
    chosen_.holds = true;
    return true;
  }

  bool are_neighbours(std::size_t a, std::size_t b) const {
    const double near = options_.neighbour_distance;
    const Configuration& first = found_.candidates[a].configuration;
    const Configuration& second = found_.candidates[b].configuration;
    return (first.phi - second.phi).cwiseAbs().maxCoeff() < near &&
           first.base.orientation.angularDistance(second.base.orientation) < near;
  }

  /// Goes for the best one by itself, as long as that takes little: where it is reached the others
  /// need not be simulated.
  /// @return as to_any_of()
  bool to_best() {
    if (order_.holding().empty()) return false;
    std::list<Goal> best;
    best.push_back(goal_at(order_.holding().front()));
    ApproachOptions brief = path_options_;
    brief.attempts_of_set = 1;
    brief.path.most_iterations = brief.path.iterations_to_best;
    return to_any_of(best, brief);
  }

  /// Goes for all good candidates at once; when none is reached, for samples of their self-motion
  /// as well.
  /// @return whether nothing is left to try
  bool to_any() {
    if (!path_decides(problem_) && to_best()) return true;
    std::list<Goal> goals = good_candidates();
    if (goals.empty()) return false;
    // Within the null space a path to one alone is for one_by_one(); of several all were tried,
    // with their continua.
    if (path_decides(problem_) && goals.size() == 1) return false;
    if (to_any_of(goals, path_options_)) return true;
    if (path_decides(problem_)) return !has_fallback_;
    const std::size_t count = goals.size();
    add_samples(goals);
    return goals.size() > count && to_any_of(goals, path_options_);
  }

  const Candidate& candidate_of(const Goal& goal) const {
    return goal.other ? goal.other->candidate : found_.candidates[goal.candidate];
  }
  const Configuration& configuration_of(const Goal& goal) const {
    return candidate_of(goal).configuration;
  }

  /// One run of the planner for all of them.
  ApproachToAny approach_to_goals(std::list<Goal>& goals, std::uint64_t seed,
                                  const ApproachOptions& options) {
    std::vector<ApproachGoal> asked;
    const auto rank = [this](const Candidate& candidate) {
      return std::max(rank_of(problem_, candidate), kZeroRank);
    };
    const double best = rank(found_.candidates[order_.first()]);
    for (const Goal& goal : goals) {
      // A goal twice as bad is sampled a quarter as often. Zeros are equally good.
      const double part = rank(candidate_of(goal)) / best;
      asked.push_back({configuration_of(goal), goal.motion ? &*goal.motion : nullptr,
                       1 / (part * part), goal.contact ? goal.contact->solver() : ContactSolver{}});
    }
    ApproachToAny any =
        plan_approach_to_any(problem_, asked, seed, options_.stop, solver_calls_, options);
    std::size_t i = 0;
    for (Goal& goal : goals) {
      if (goal.contact) count_calls(*goal.contact);
      if (!any.base_hits.empty()) goal.base_hits = any.base_hits[i++];
    }
    return any;
  }

  /// @return whether an approach leads to a configuration whose limits hold after the impact
  bool to_any_of(std::list<Goal>& goals, const ApproachOptions& options) {
    if (options_.stop.reached()) return false;
    progress(0);
    const ApproachToAny any = approach_to_goals(goals, seed_, options);
    const Goal& reached = *std::next(goals.begin(), static_cast<std::ptrdiff_t>(any.goal));
    for (const Goal& goal : goals) {
      if (goal.other) continue;
      excluded_[goal.candidate] =
          arrives(any.approach) ? exclusion::kOtherPathFirst : no_path_words(any.approach);
    }
    if (!arrives(any.approach)) {
      if (path_decides(problem_) && !has_fallback_) chosen_.approach = any.approach;
      return false;
    }
    return reached.other ? take_form(any.approach, reached)
                         : take(any.approach, reached.candidate, reached.contact.get());
  }

  /// Whether the candidate at this place of the order is nearly as good as the best one, and keeps
  /// the limits after the impact. Within the null space, and where the base follows the path, any
  /// contact that can be reached is a goal: it is improved along the path.
  bool is_goal(std::size_t place) const {
    const std::vector<std::size_t>& holding = order_.holding();
    if (place >= holding.size()) return false;
    return path_decides(problem_) ||
           is_good(problem_, found_.candidates[holding[place]], found_.candidates[holding.front()],
                   problem_.approach.goal_factor);
  }

  std::list<Goal> good_candidates() {
    if (path_decides(problem_)) {
      order_.judge_all();
    } else {
      order_.judge_good_ones(problem_.approach.goal_factor);
    }
    std::list<Goal> goals;
    for (std::size_t k = 0; k < order_.holding().size(); ++k) {
      if (is_goal(k)) goals.push_back(goal_at(order_.holding()[k]));
    }
    return goals;
  }

  Goal goal_at(std::size_t candidate) const {
    const Configuration& at = found_.candidates[candidate].configuration;
    return {candidate, {}, false, collisions_.target_towards(at), contact_at(candidate)};
  }

  void add_samples(std::list<Goal>& goals) {
    // Where every solution is enclosed there is no self-motion.
    if (proof_.status != ProofStatus::NotApplicable) return;
    const std::size_t beside = goals.front().candidate;
    const Candidate& best = found_.candidates[beside];
    std::vector<Eigen::VectorXd> points;
    for (const Goal& goal : goals) points.push_back(found_.points[goal.candidate]);
    Formulation quick(problem_, encounter_);
    quick.give_up_simulations_at(options_.stop);
    std::vector<CertifiedCandidate> samples;
    std::vector<Configuration> to_judge;
    for (const Eigen::VectorXd& x :
         self_motion_samples(problem_, quick, points, best, problem_.approach.goal_factor,
                             problem_.approach.goal_samples, options_.stop, options_.self_motion)) {
      if (options_.stop.reached()) return;
      Candidate candidate = best;
      candidate.starts_reached = 0;
      candidate.family = -1;
      CertifiedCandidate sample =
          certify_candidate(problem_, formulation(), x, candidate, found_.certificates[beside]);
      collisions_.judge(sample.candidate);
      if (!sample.candidate.collision_free) continue;
      to_judge.push_back(sample.candidate.configuration);
      samples.push_back(std::move(sample));
    }
    after_.judge_all(to_judge);
    for (CertifiedCandidate& sample : samples) {
      const Configuration at = sample.candidate.configuration;
      if (options_.stop.reached()) return;
      if (!after_.keeps_limits(at)) continue;
      goals.push_back({beside, std::move(sample), true, collisions_.target_towards(at), nullptr});
    }
  }

  void progress(int done) const {
    if (options_.on_progress)
      options_.on_progress("approach", done, problem_.approach.max_approaches);
  }

  const CaptureProblem& problem_;
  const EncounterModel& encounter_;
  const CollisionJudge& collisions_;
  const SearchResult& found_;
  const Proof& proof_;
  std::uint64_t seed_;
  AfterImpactJudge& after_;
  const PlannerOptions& options_;
  std::unique_ptr<const Formulation> formulation_;
  ApproachOptions path_options_;
  std::map<std::string, long>& solver_calls_;
  CandidateOrder order_;
  ChosenApproach chosen_;
  std::map<std::size_t, std::string> excluded_;
  std::set<std::size_t> tried_alone_;          ///< candidates
  std::set<std::size_t> has_base_in_the_way_;  ///< candidates, see Approach::base_hits
  std::set<std::size_t> forms_tried_;          ///< of these candidates
  bool tried_ = false;
  bool are_forms_tried_ = false;
  bool has_fallback_ = false;  ///< an approach to a configuration that breaks a limit afterwards
};

}  // namespace

ChosenApproach choose_approach(const CaptureProblem& problem, const EncounterModel& encounter,
                               const CollisionJudge& collisions, const SearchResult& found,
                               const Proof& proof, std::uint64_t seed, AfterImpactJudge& after,
                               const PlannerOptions& options,
                               std::map<std::string, long>& solver_calls) {
  return Stage(problem, encounter, collisions, found, proof, seed, after, options, solver_calls)
      .choose();
}

}  // namespace stillbase
