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

#include <stillbase/plan/quantities.hpp>

#include "dynamics/rigid_inertia.hpp"
#include "proof/articulated_forms.hpp"
#include "proof/elimination.hpp"
#include "proof/minimum_problem.hpp"
#include "proof/response_gram.hpp"

namespace stillbase::proof {

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
    std::vector<Response> responses;
    for (const Vector6d& F_E : basis.wrenches) {
      responses.push_back(respond(unit_wrench<S>(at.contact.R_EB, F_E.head<3>(), F_E.tail<3>())));
    }
    compare(responses);
  }

  /// Of the hand, in B, m.
  const Vector3<S>& hand() const { return hand_; }
  Matrix3<S> hand_axes() const { return arm_.hand_axes(); }

  /// What the impulses do.
  const ResponseGram<S>& gram() const { return gram_; }

 private:
  using Column = std::array<S, 6>;

  struct Response {
    PerBody<S, S> u;   ///< of the wrench along joint k, the joints beyond it free
    Column z;          ///< base_.forward(b)
    Vector6<S> base;   ///< twist of the base, [v; omega]
    Vector3<S> total;  ///< L
  };

  /// Whether the objective asks for momenta of the robot as one body.
  bool needs_composite() const {
    const auto asks = [this](const ObjectiveTerm& term) {
      const std::vector<QuantityBlock> blocks = blocks_of(term);
      return std::any_of(blocks.begin(), blocks.end(), [](const QuantityBlock& block) {
        return block.part == ResponsePart::BaseAngularMomentum ||
               block.part == ResponsePart::TotalAngularMomentum ||
               block.part == ResponsePart::ReceivedLinearMomentum ||
               block.part == ResponsePart::ReceivedAngularMomentum;
      });
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
        // b - U u / D, of which the joint's own component is left with u added / D: so written,
        // nothing cancels.
        const int own = arm_.index(k);
        out.u[k] = b[own];
        const S share = quotient(out.u[k], arm_.D[k], arm_.inverse_D[k]);
        for (int i = 0; i < 6; ++i) {
          if (i != own) b[i] -= arm_.U[k][i] * share;
        }
        b[own] = share * S(problem_.where.added_inertia[k]);
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

  void compare(const std::vector<Response>& responses) {
    const bool is_given = !problem_.impulses.front().target_inverse_mass;
    std::vector<std::vector<S>>& y = gram_.components;
    for (const Response& at : responses) y.push_back(components(at));
    for (std::size_t i = 0; i < responses.size(); ++i) {
      for (std::size_t j = i; j < responses.size(); ++j) {
        S sum(0.0);
        for (std::size_t c = 0; c < y[i].size(); ++c) {
          sum += product(y[i][c], y[j][c], i == j);
        }
        gram_.y.push_back(sum);
        if (!is_given) gram_.W.push_back(inverse_mass(responses[i], responses[j], i == j));
      }
    }
    for (const ObjectiveTerm& term : problem_.objective) {
      for (const QuantityBlock& block : blocks_of(term)) {
        if (block.part != ResponsePart::Impulse) continue;
        gram_.constant += square(S(block.map(0, 0)) * inverse_of(S(term.size)));
      }
    }
    gram_.target_velocity = encounter_.contact.velocity;
    gram_.target_omega = encounter_.contact.omega;
  }

  /// x y; the square of one number has a narrower enclosure than its product with itself.
  static S product(const S& x, const S& y, bool are_same) { return are_same ? square(x) : x * y; }

  /// a' W_h b
  S inverse_mass(const Response& a, const Response& b, bool are_same) const {
    S sum(0.0);
    const auto add = [&](const S& x, const S& y, const S& inverse) {
      sum += product(x, y, are_same) * inverse;
    };
    for (const int k : arm_.joints_of_hand()) {
      if (arm_.moves[k]) add(a.u[k], b.u[k], arm_.inverse_D[k]);
    }
    for (int i = 0; i < 6; ++i) add(a.z[i], b.z[i], base_.inverse_pivots()[i]);
    return sum;
  }

  std::vector<QuantityBlock> blocks_of(const ObjectiveTerm& term) const {
    const QuantityRow& row = row_of(term.quantity);
    // minimum_objection() refuses simulated ones.
    return row.is_simulated() ? std::vector<QuantityBlock>()
                              : row.blocks(term, problem_.where.robot);
  }

  /// Of all terms that change with the wrench, with their sizes.
  std::vector<S> components(const Response& at) const {
    std::vector<S> out;
    for (const ObjectiveTerm& term : problem_.objective) {
      const S factor = inverse_of(S(row_of(term.quantity).power.length(term.size)));
      for (const QuantityBlock& block : blocks_of(term)) {
        const auto use = [&](const S& y) {
          out.push_back((block.divisor == 1 ? y : y / S(block.divisor)) * factor);
        };
        if (block.part == ResponsePart::JointRates) {
          for_each_rate(at, [&](const S& rate) { use(times(block.map(0, 0), rate)); });
        } else if (block.part != ResponsePart::Impulse) {  // which is the same for all wrenches
          const Vector3<S> part = vector_part(block.part, at);
          for (int i = 0; i < 3; ++i) use(row_times(block.map, i, part));
        }
      }
    }
    return out;
  }

  static S times(double factor, const S& x) { return factor == 1 ? x : S(factor) * x; }

  /// Row i of a matrix times a vector, without the products with zero.
  static S row_times(const Matrix3d& map, int i, const Vector3<S>& x) {
    S sum = times(map(i, i), x[i]);
    for (int j = 0; j < 3; ++j) {
      if (j != i && map(i, j) != 0) sum += times(map(i, j), x[j]);
    }
    return sum;
  }

  /// A part of three components, per unit of impulse.
  Vector3<S> vector_part(ResponsePart part, const Response& at) const {
    const Vector3<S> omega = at.base.template tail<3>();
    const auto received = [&](int first) {
      Vector3<S> momentum = Vector3<S>::Zero();
      for (int i = 0; i < 6; ++i) {
        momentum += arm_.composite.column(i).template segment<3>(first) * at.base[i];
      }
      return momentum;
    };
    switch (part) {
      case ResponsePart::BaseVelocity:
        return at.base.template head<3>();
      case ResponsePart::BaseRate:
        return omega;
      case ResponsePart::BaseAngularMomentum:
        return Htilde_omega_ * omega;
      case ResponsePart::TotalAngularMomentum:
        return at.total;
      case ResponsePart::ReceivedLinearMomentum:
        return received(0);
      case ResponsePart::ReceivedAngularMomentum:
        return received(3);
      case ResponsePart::JointRates:
      case ResponsePart::Impulse:
        break;  // no vectors of three
    }
    return Vector3<S>::Zero();
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
  ResponseGram<S> gram_;
};

}  // namespace stillbase::proof
