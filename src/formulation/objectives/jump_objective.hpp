// The terms of the objective that are linear in the response to the impulse.
//
// Their vectors y per unit of impulse, divided by the terms' sizes, come from the catalogue
// (plan/quantities.hpp). With all of them below each other, |y| joins the objective as p |y|.
#pragma once

#include <vector>

#include <stillbase/impact/batch.hpp>

#include "formulation/capture_model.hpp"

namespace stillbase {

class JumpObjective {
 public:
  /// Components map * part of y.
  struct Block {
    ResponsePart part;
    Matrix3d map;
  };
  /// One term: its blocks below each other.
  using Term = std::vector<Block>;

  explicit JumpObjective(const CaptureProblem& problem);

  const std::vector<Term>& terms() const { return terms_; }

  /// y of a term.
  template <class S>
  static JointVector<S> value(const Term& term, const PostureImpact<S>& posture,
                              const ImpactResponse<S>& response);
  /// weights += u . dy of a term. @param u of the size of y
  template <class S>
  static void add_weights(const Term& term, const JointVector<S>& u,
                          const PostureImpact<S>& posture, const ImpactResponse<S>& response,
                          ResponseWeights<S>& weights);

  /// 1/2 |p y|^2 / unit^2 over all terms, and its gradient.
  template <class S>
  S objective(const PostureImpact<S>& posture, const ScenarioImpact<S>& impact, double unit) const;
  template <class S>
  ScalarGradient<S> gradient(const CaptureModel& model, const PostureImpact<S>& posture,
                             const ScenarioImpact<S>& impact, double unit) const;

  /// The same for postures in packs: 1/2 |y|^2 / unit^2.
  BatchObjective metrics(double unit) const;

 private:
  std::vector<Term> terms_;
};

}  // namespace stillbase
