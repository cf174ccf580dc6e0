// Judgement of candidates: collisions at the contact, limits after it, certificates of those that
// the search did not find.
#pragma once

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <stillbase/collision/scene.hpp>
#include <stillbase/core/interrupt.hpp>
#include <stillbase/core/phase_clock.hpp>
#include <stillbase/encounter/encounter.hpp>
#include <stillbase/formulation/formulation.hpp>

#include "encounter/encounter_motions.hpp"

namespace stillbase {

/// Judges candidates of one problem by which bodies touch while the robot waits there and the
/// target comes in. Several threads may use one.
class CollisionJudge {
 public:
  /// @param problem outlives this
  /// @param known the motion in its encounter_model(), if there is one
  explicit CollisionJudge(const CaptureProblem& problem,
                          const std::optional<TargetMotion>& known = {})
      : problem_(problem), scene_(problem), motions_(problem, known) {}

  /// Sets `collision` and `collision_free`.
  void judge(Candidate& candidate) const;
  /// The same for all of them. @param jobs threads
  /// @param stop reached: the others are not judged, and not free of collision
  void judge_all(int jobs, const StopCondition& stop, std::vector<Candidate>& candidates) const;
  bool is_free(const Configuration& configuration) const {
    return first_collision(configuration).empty();
  }
  /// Of the target towards a configuration; nothing: there is none.
  std::optional<TargetMotion> target_towards(const Configuration& configuration) const {
    return motions_.towards(configuration);
  }

 private:
  /// The bodies that touch; empty: none do.
  std::string first_collision(const Configuration& configuration) const;

  const CaptureProblem& problem_;
  const CollisionScene scene_;
  const EncounterMotions motions_;
};

/// Whether the base's pose at the contact follows from the path instead of the search.
bool base_follows_path(const CaptureProblem& problem);

/// Whether the configuration is found together with the path.
bool path_decides(const CaptureProblem& problem);

/// The problem as the path leaves the base: that at the contact is not the stated one.
CaptureProblem at_contact(const CaptureProblem& problem, const Configuration& configuration);

/// Judges configurations by the time after the impact, see post_impact_failure(). Each is simulated
/// once, however often it is asked about.
class AfterImpactJudge {
 public:
  /// @param problem outlives this
  /// @param jobs threads of judge_all()
  /// @param clock takes the seconds; may be null
  AfterImpactJudge(const CaptureProblem& problem, const StopCondition& stop, int jobs,
                   PhaseClock* clock)
      : AfterImpactJudge(problem, encounter_model(problem), stop, jobs, clock) {}
  /// @param model encounter_model() of the problem
  AfterImpactJudge(const CaptureProblem& problem, const EncounterModel& model,
                   const StopCondition& stop, int jobs, PhaseClock* clock)
      : problem_(problem), model_(model), stop_(stop), jobs_(jobs), clock_(clock) {}

  /// The first limit that is exceeded; empty: none. What is not known when the stop is reached is
  /// not judged, and keeps no limits.
  std::string failure(const Configuration& configuration);
  bool keeps_limits(const Configuration& configuration) { return failure(configuration).empty(); }
  /// Simulates those that nothing is known of yet, several at a time, until the stop is reached.
  void judge_all(const std::vector<Configuration>& configurations);
  /// The same of the candidate at a place, if it touches nothing, and of as many of those behind it
  /// as take little more time than it takes alone.
  void judge_from(std::size_t place, const std::vector<Candidate>& candidates);

 private:
  std::optional<std::string> known(const Configuration& configuration);
  std::vector<std::string> simulate(const std::vector<Configuration>& configurations);

  const CaptureProblem& problem_;
  const EncounterModel model_;
  const StopCondition stop_;
  const int jobs_;
  PhaseClock* const clock_;
  std::mutex mutex_;  // of what follows
  std::vector<std::pair<Configuration, std::string>> known_;
};

/// Order in which approaches are tried. Candidates are judged when they are asked about: a plan
/// says nothing of those that it does not need.
class CandidateOrder {
 public:
  /// Judges up to the first candidate that holds. All arguments outlive this.
  CandidateOrder(const CaptureProblem& problem, const std::vector<Candidate>& candidates,
                 AfterImpactJudge& after);

  /// Judges all that count as good beside the best one that holds, and those before them.
  void judge_good_ones(double factor);
  void judge_all() { judge_up_to(candidates_.size()); }

  /// Those judged so far that touch nothing and keep the problem's limits after the impact, best
  /// first.
  const std::vector<std::size_t>& holding() const { return holding_; }
  /// The best that holds; where none does, the best that touches nothing, else the best.
  std::size_t first() const;
  /// The candidate at a place: those that hold, then the other ones free of collision. Where the
  /// base's pose follows from the path, collisions at the stated pose say little, and all others
  /// follow. Judges as far as it takes. Nothing: there are no more; first() is always there.
  std::optional<std::size_t> at(std::size_t place);
  /// Why one judged so far does not hold: what it collides with, or the limit that it exceeds.
  const std::map<std::size_t, std::string>& excluded() const { return excluded_; }

 private:
  void judge_up_to(std::size_t end);
  /// Judges up to the next one that holds, or to the end.
  void judge_on();
  void take_next();

  const CaptureProblem& problem_;
  const std::vector<Candidate>& candidates_;
  AfterImpactJudge& after_;
  std::size_t judged_ = 0;  ///< how many of the first ones
  std::vector<std::size_t> holding_, others_, colliding_;
  std::map<std::size_t, std::string> excluded_;
};

/// A configuration beside those that the search found, with everything that a plan states about it.
struct CertifiedCandidate {
  Candidate candidate;
  Certificate certificate;
  std::vector<ConstraintValue> constraints;
};

/// Evaluates and certifies the configuration of the variables x.
/// @param problem as it is at the contact, and its formulation
/// @param candidate, certificate of the candidate that it replaces or stands beside; what does not
///   depend on the configuration is kept
CertifiedCandidate certify_candidate(const CaptureProblem& problem, const Formulation& formulation,
                                     const Eigen::VectorXd& x, const Candidate& candidate,
                                     const Certificate& certificate);

}  // namespace stillbase
