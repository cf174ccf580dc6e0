// What the planner asks of a prover: which solutions a problem has, and how much better than the
// best one known any configuration could be. The library stillbase::proof answers with intervals.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <stillbase/core/interrupt.hpp>
#include <stillbase/plan/plan.hpp>
#include <stillbase/plan/scenario.hpp>

namespace stillbase {

/// What the limits on rates, singular values and clearances say of a solution.
enum class WithinLimits { Yes, No, Undecided };

struct ProofOptions {
  /// Boxes examined before the remaining ones are called undecided; about 30 us each, 150 us with
  /// seven joints that move. A count, so that the answer is the same on every machine. Three free
  /// joints of a 7-joint arm have been seen to take 6000 to 70000.
  long max_boxes = 100000;
  double min_width = 1e-8;  ///< rad (times: of about a radian of the target): below, undecided
  StopCondition stop = {};  ///< boxes that remain then are undecided
  /// Judges a solution by these limits; asked only about boxes of at most `judged_width`, the
  /// others are undecided. Empty: problems with such limits are not applicable.
  std::function<WithinLimits(const JointBox&)> judge = {};
  double judged_width = 1e-8;  ///< rad, s: a few times the width of a solution's box
};

/// An encounter of a worst case and its value, in the unit of the measure.
struct WorstEncounter {
  Scenario scenario;
  double value = 0;
};

struct MinimumOptions {
  double relative_gap = 1e-3;  ///< of the best known value: good enough
  /// Boxes examined, about 100 us each with three joints; of more joints, or of means over many
  /// samples, fewer, for each costs more. A count, so that the answer is the same on every machine.
  long max_boxes = 400000;
  StopCondition stop = {};  ///< the bound that was reached counts
  std::function<void(long boxes)> on_progress = {};
  /// The measure at a configuration, infinite where a constraint is violated. Where it is below the
  /// best value by more than the gap the proof ends: that one is better. May be empty.
  std::function<double(const Configuration&)> value_at = {};
  /// Of a worst case: the encounters within the cone along its worst directions at a configuration,
  /// the first one the worst. Asked for where the known ones stay below the goal. May be empty.
  std::function<std::vector<WorstEncounter>(const Configuration&)> worst_at = {};
  int jobs = 0;  ///< threads; 0: one per processor. The bound does not depend on it
};

/// What a bound says, in words and numbers.
struct MinimumBound {
  std::string statement;       ///< what was proven, or what was not, without "proven: "
  double lower_bound = 0;      ///< of the problem's measure, in its unit; zero: nothing was proven
  double gap = 0;              ///< best candidate's measure minus the lower bound
  long boxes = 0;              ///< examined
  bool limit_reached = false;  ///< of boxes or by the stop condition
  /// Where a search should start: a better configuration that was found, or, where the limit was
  /// reached, those of which least is known.
  std::vector<Configuration> suspects;
};

/// The functions of a prover; stillbase/proof states what each of them proves.
struct Prover {
  Proof (*prove)(const CaptureProblem&, const ProofOptions&) = nullptr;
  std::string (*minimum_objection)(const CaptureProblem&) = nullptr;
  MinimumBound (*prove_minimum)(const CaptureProblem&, const std::vector<Scenario>&,
                                const Proof& enclosed, double best,
                                const MinimumOptions&) = nullptr;
};

/// The prover that planners use by default; null until use_prover() is called.
const Prover* default_prover();
/// To be called before the first plan, e.g. at the beginning of main(): see enable_proofs() of
/// stillbase/proof/proof.hpp.
void use_prover(const Prover& prover);

}  // namespace stillbase
