// The objective over a whole box of postures at once, by Taylor models.
//
// The arm is solved by articulated bodies (articulated_forms.hpp), the base by its articulated
// inertia K:
//   K [v; omega] = b,  b what of the wrench the joints pass on,
//   F' W_h F = sum over the joints of z_k^2 / D_k + b' K^-1 b.
// by elimination.hpp: b' K^-1 b = sum z_i^2 / D_i. No part of the sum is negative.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "dynamics/rigid_inertia.hpp"
#include "proof/articulated_forms.hpp"
#include "proof/bound.hpp"
#include "proof/elimination.hpp"
#include "proof/encounter_forms.hpp"
#include "proof/minimum_problem.hpp"

namespace stillbase::proof {

/// Wrenches whose combinations the impulses are: the one itself, or unit wrenches. Everything is
/// linear in them.
struct WrenchBasis {
  std::vector<Vector6d> wrenches;
  std::vector<std::vector<double>> coefficients;  ///< per impulse, exact

  explicit WrenchBasis(const std::vector<ImpulseCase>& impulses) {
    if (impulses.size() == 1) {
      wrenches = {impulses.front().F};
      coefficients = {{1.0}};
      return;
    }
    coefficients.resize(impulses.size());
    for (int i = 0; i < 6; ++i) {
      bool counts = false;
      for (const ImpulseCase& impulse : impulses) counts = counts || impulse.F[i] != 0;
      if (!counts) continue;
      wrenches.push_back(Vector6d::Unit(i));
      for (std::size_t k = 0; k < impulses.size(); ++k) {
        coefficients[k].push_back(impulses[k].F[i]);
      }
    }
  }
};

/// What one box of configurations says about every impulse.
template <int N>
class ImpactForms {
 public:
  using S = Form<N>;

  ImpactForms(const MinimumProblem& problem, const WrenchBasis& basis, const EncounterRange<S>& at)
      : problem_(problem),
        encounter_(at),
        arm_(problem.where.robot, at.phi, problem.where.added_inertia, problem.where.locked,
             needs_composite()),
        hand_(arm_.hand_position()) {
    if (needs_composite()) {
      const S& mass = arm_.composite.M(0, 0);
      const Matrix3<S>& h = arm_.composite.H;  // -m skew(r_bg)
      r_bg_ = Vector3<S>(h(1, 2), h(2, 0), h(0, 1)) * inverse_of(mass);
      Htilde_omega_ = arm_.composite.J - parallel_axis<S>(mass, r_bg_);
    }
    base_ = Elimination<S, 6>(6, [&](int i, int j) { return arm_.articulated.column(j)[i]; });
    for (const Vector6d& F_E : basis.wrenches) {
      Vector6<S> F;
      F << at.R_BE * Vector3<S>(F_E.head<3>().cast<S>()),
          at.R_BE * Vector3<S>(F_E.tail<3>().cast<S>());
      responses_.push_back(respond(F));
    }
  }

  /// Of the hand, in B, m.
  const Vector3<S>& hand() const { return hand_; }
  Matrix3<S> hand_axes() const { return arm_.hand_axes(); }

  /// |y|^2 after an impulse, with the sizes of its terms. Of a contact law
  ///   p = scale / divisor, divisor = F' W_h F + target_inverse_mass.
  Fraction<N> square_of(const ImpulseCase& impulse, const std::vector<double>& coefficients) const {
    const Response at = combined(coefficients);
    const S scale = scale_of(impulse);
    Fraction<N> out;
    for (const ObjectiveTerm& term : problem_.objective) {
      const S factor = scale / S(term.size);
      for_each_component(term, at, [&](const S& y) {
        if (!y.is_zero()) out.numerator += square(y * factor);
      });
    }
    if (!impulse.target_inverse_mass) return out;
    out.denominator = square(divisor_of(impulse, at));
    const Interval least(*impulse.target_inverse_mass);
    out.least_denominator = (least * least).lower();
    return out;
  }

 private:
  using Column = std::array<S, 6>;

  struct Response {
    PerBody<S, S> u;   ///< of the wrench along joint k, the joints beyond it free
    Column z;          ///< base_.forward(b)
    Vector6<S> base;   ///< twist of the base, [v; omega]
    Vector3<S> total;  ///< L
  };

  /// Of an impulse by a contact law: (1+e) v_n; of a given one the impulse itself.
  S scale_of(const ImpulseCase& impulse) const {
    S scale(impulse.numerator);
    if (!impulse.closing) return scale;
    const Vector3<S> d = Vector3d(impulse.F.head<3>()).cast<S>();
    const S speed = d.dot(velocity_in_T<S>(encounter_, impulse.closing->point));
    return scale * positive_part(speed + S(impulse.closing->offset));
  }

  /// F' W_h F + target_inverse_mass
  S divisor_of(const ImpulseCase& impulse, const Response& at) const {
    S divisor(*impulse.target_inverse_mass);
    for (const int k : arm_.joints_of_hand()) {
      if (arm_.moves[k]) divisor += square(at.u[k]) * arm_.inverse_D[k];
    }
    for (int i = 0; i < 6; ++i) divisor += square(at.z[i]) * base_.inverse_pivots()[i];
    return divisor;
  }

  /// Whether the objective asks for momenta of the robot as one body.
  bool needs_composite() const {
    const auto asks = [](const ObjectiveTerm& term) {
      return term.quantity == ObjectiveQuantity::BaseAngularMomentum ||
             term.quantity == ObjectiveQuantity::TotalAngularMomentum ||
             term.quantity == ObjectiveQuantity::BaseMomentum;
    };
    return std::any_of(problem_.objective.begin(), problem_.objective.end(), asks);
  }

  /// @param F in B
  Response respond(const Vector6<S>& F) const {
    const Vector3<S> f = F.template head<3>();
    Response out;
    if (needs_composite()) out.total = (hand_ - r_bg_).cross(f) + F.template tail<3>();
    Vector6<S> b;  // on the body, about its origin and in its axes
    const Vector3<S> f_b = arm_.in_hand_body(f);
    const Vector3<S> lever = arm_.robot.p_hand.template cast<S>();
    b << f_b, arm_.in_hand_body(F.template tail<3>()) + lever.cross(f_b);
    for (const int k : arm_.joints_of_hand()) {
      if (arm_.moves[k]) {
        out.u[k] = b[arm_.index(k)];
        b -= arm_.U[k] * quotient(out.u[k], arm_.D[k], arm_.inverse_D[k]);
      }
      b = arm_.wrench_on_parent(k, b);
    }
    Column on_base;
    std::copy(b.begin(), b.end(), on_base.begin());
    out.z = base_.forward(on_base);
    const Column twist = base_.backward(out.z);
    std::copy(twist.begin(), twist.end(), out.base.begin());
    return out;
  }

  Response combined(const std::vector<double>& coefficients) const {
    if (coefficients.size() == 1 && coefficients.front() == 1) return responses_.front();
    Response out;
    out.total.setZero();
    out.base.setZero();
    for (std::size_t b = 0; b < coefficients.size(); ++b) {
      const S factor(coefficients[b]);
      const Response& one = responses_[b];
      for (int k = 0; k < arm_.robot.n(); ++k) out.u[k] += one.u[k] * factor;
      for (int i = 0; i < 6; ++i) out.z[i] += one.z[i] * factor;
      out.total += one.total * factor;
      out.base += one.base * factor;
    }
    return out;
  }

  /// The vector behind a term, per unit of impulse, without its size.
  template <class Use>
  void for_each_component(const ObjectiveTerm& term, const Response& at, const Use& use) const {
    const Vector3<S> omega = at.base.template tail<3>();
    switch (term.quantity) {
      case ObjectiveQuantity::BaseAngularMomentum: {
        const Vector3<S> base = Htilde_omega_ * omega;
        for (int i = 0; i < 3; ++i) use(base[i]);
        break;
      }
      case ObjectiveQuantity::BaseAngularVelocity:
        for (int i = 0; i < 3; ++i) use(omega[i]);
        break;
      case ObjectiveQuantity::TotalAngularMomentum:
        for (int i = 0; i < 3; ++i) use(at.total[i]);
        break;
      case ObjectiveQuantity::BaseMomentum: {
        Vector6<S> momentum = Vector6<S>::Zero();
        for (int i = 0; i < 6; ++i) momentum += arm_.composite.column(i) * at.base[i];
        for (int i = 0; i < 3; ++i) use(momentum[i]);
        for (int i = 3; i < 6; ++i) use(momentum[i] / S(term.length));
        break;
      }
      case ObjectiveQuantity::ImpulseMagnitude:
        use(S(1.0));
        break;
      case ObjectiveQuantity::JointRateNorm:
        for_each_rate(at, use);
        break;
      case ObjectiveQuantity::AttitudeTurned:
        break;  // simulated: minimum_objection() refuses it
    }
  }

  /// Joint rates, outwards from the base.
  template <class Use>
  void for_each_rate(const Response& at, const Use& use) const {
    std::vector<Vector6<S>> twists;
    for (int k = 0; k < arm_.robot.n(); ++k) {
      const int parent = arm_.robot.joints[k].parent;
      Vector6<S> twist = arm_.twist_from_parent(
          k, parent == kBase ? at.base : twists[static_cast<std::size_t>(parent)]);
      if (arm_.moves[k]) {
        const S left = at.u[k] - arm_.U[k].dot(twist);
        const S rate = quotient(left, arm_.D[k], arm_.inverse_D[k]);
        twist[arm_.index(k)] += rate;
        use(rate);
      }
      twists.push_back(twist);
    }
  }

  const MinimumProblem& problem_;
  const EncounterRange<S>& encounter_;
  ArticulatedForms<S> arm_;
  Vector3<S> hand_, r_bg_;
  Matrix3<S> Htilde_omega_;
  Elimination<S, 6> base_;  ///< in the articulated inertia of the base
  std::vector<Response> responses_;
};

}  // namespace stillbase::proof
