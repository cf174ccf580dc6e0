#include <stillbase/proof/minimum.hpp>

#include <algorithm>
#include <cassert>
#include <cmath>

#include "proof/bound.hpp"
#include "proof/objective_kernel.hpp"

namespace stillbase {

namespace proof {
namespace {

/// By which the planner's own postures may miss their constraints, with some to spare: m, rad.
constexpr double kFeasible = 2e-9;
/// The best known value is right to this.
constexpr double kBestIsKnownTo = 1e-6;
/// Directions are unit vectors but for rounding.
constexpr double kUnitVector = 1e-12;

/// How the variables of the search become a posture. One that is not needed stays at zero. Where
/// base or time are variables as well, impulses and the hand's point become forms here.
template <int N>
class JointMap {
 public:
  explicit JointMap(const MinimumProblem& problem) : problem_(problem) {}

  template <class S>
  JointVector<S> posture(const std::array<S, N>& x) const {
    JointVector<S> phi = problem_.start.template cast<S>();
    for (std::size_t i = 0; i < problem_.free.size(); ++i) phi[problem_.free[i]] = x[i];
    return phi;
  }

  std::vector<Box<N>> domain() const {
    std::vector<Box<N>> out;
    for (const JointBox& place : problem_.places) {
      Box<N> box;
      for (int i = 0; i < size(); ++i) {
        const int k = problem_.free[static_cast<std::size_t>(i)];
        box[i] = Interval(place.lower[k], place.upper[k]) + Interval(-kFeasible, kFeasible);
      }
      out.push_back(box);
    }
    if (out.empty()) out.push_back(limits());
    return out;
  }

 private:
  int size() const { return static_cast<int>(problem_.free.size()); }

  Box<N> limits() const {
    Box<N> box;
    for (int i = 0; i < size(); ++i) {
      const auto index = static_cast<std::size_t>(i);
      const int k = problem_.free[index];
      const bool turns =
          problem_.robot.joints[static_cast<std::size_t>(k)].type == JointType::Continuous;
      box[i] = turns ? Interval(-kPi.upper(), kPi.upper())
                     : Interval(problem_.lower[index], problem_.upper[index]) +
                           Interval(-kFeasible, kFeasible);
    }
    return box;
  }

  const MinimumProblem& problem_;
};

template <int N>
class ImpactProgram final : public Program<N> {
 public:
  explicit ImpactProgram(const MinimumProblem& problem)
      : problem_(problem), map_(problem), basis_(problem.impulses) {}

  const JointMap<N>& map() const { return map_; }

  void evaluate(const std::array<Form<N>, N>& x, std::vector<Form<N>>& equations,
                std::vector<Fraction<N>>& values) const override {
    using S = Form<N>;
    const ImpactForms<N> forms(problem_, basis_, map_.posture(x));
    if (problem_.has_hand_point) {
      for (int i = 0; i < 3; ++i) {
        S off = forms.hand()[i] - S(problem_.hand_point[i]);
        off.r += kFeasible;
        equations.push_back(off);
      }
    }
    for (std::size_t k = 0; k < problem_.impulses.size(); ++k) {
      values.push_back(forms.square_of(problem_.impulses[k], basis_.coefficients[k]));
    }
  }

 private:
  const MinimumProblem& problem_;
  JointMap<N> map_;
  WrenchBasis basis_;
};

template <int N>
BoundedMinimum bound(const MinimumProblem& problem, double best, const MinimumOptions& options) {
  const double cut = best * (1 + kBestIsKnownTo), goal = best * (1 - options.relative_gap);
  const ImpactProgram<N> program(problem);
  const Bound found = bound_below<N>(program, program.map().domain(),
                                     {.cut = cut * cut,
                                      .goal = goal * goal * (1 + 4 * kUnitVector),
                                      .max_boxes = options.max_boxes,
                                      .stop = options.stop});
  BoundedMinimum out;
  out.boxes = found.boxes;
  out.limit_reached = found.limit_reached;
  out.nothing_as_good = found.nothing_below_cut;
  if (found.lower > 0) {  // the root is rounded up
    out.lower_bound =
        std::nextafter(std::nextafter(std::sqrt(found.lower), 0.0) * (1 - kUnitVector), 0.0);
  }
  return out;
}

}  // namespace
}  // namespace proof

int max_minimum_joints() { return kMaxJointsOf<proof::Form<2>>; }

BoundedMinimum bound_minimum(const MinimumProblem& problem, double best,
                             const MinimumOptions& options) {
  assert(problem.robot.n() <= max_minimum_joints());
  assert(!problem.impulses.empty() && best > 0);
  const proof::RoundUpward upward;
  switch (problem.free.size()) {
    case 1:
    case 2:
      return proof::bound<2>(problem, best, options);
    case 3:
      return proof::bound<3>(problem, best, options);
    default:
      assert(!"one to three free joints");
      return {};
  }
}

}  // namespace stillbase
