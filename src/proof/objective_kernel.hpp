// The objective over a whole box of postures at once, by quadratic forms.
//
// With A = Htilde_phi + added inertia over the joints that move, h = Htilde_omegaphi, L the
// momentum impulse about the system centroid (16) and s = tau - H_vphi' f / m the jump (6) reads
//   [A h'; h Htilde_omega] [Delta phidot; Delta omega] = [s; L],
// K x = b for short, and F' W_h F = |f|^2 / m + b' K^-1 b. K is positive definite, but its entries
// cancel; so it is first taken to near the identity by the Cholesky factor of its middle,
//   (G K G') (G'^-1 x) = G b,  G any regular matrix of doubles,
// and then factorised once, G K G' = C D C': z = C^-1 G b gives b' K^-1 b = sum z_i^2 / D_i, of
// which no part is negative.
#pragma once

#include <Eigen/Cholesky>
#include <array>
#include <vector>

#include "dynamics/inertia_kernel.hpp"
#include "dynamics/kinematics_kernel.hpp"
#include "proof/encounter_forms.hpp"
#include "proof/minimum_problem.hpp"

namespace stillbase::proof {

/// Wrenches whose combinations the impulses are: the one itself, or unit wrenches. Everything is
/// linear in them. In E, so that the coefficients are the same at every point of a box.
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
template <class S>
class ImpactForms {
 public:
  ImpactForms(const MinimumProblem& problem, const WrenchBasis& basis, const EncounterRange<S>& at)
      : problem_(problem),
        robot_(problem.where.robot),
        encounter_(at),
        kinematics_(compute_kinematics<S>(robot_, at.phi)) {
    inertia_ = compute_inertia<S>(robot_, kinematics_);
    tilde_ = compute_tilde_inertia<S>(inertia_);
    factorise();
    const HandJacobian<S> jacobian = compute_hand_jacobian<S>(robot_, kinematics_);
    inverse_mass_ = inverse_of(inertia_.mass);
    for (const Vector6d& F_E : basis.wrenches) {
      Vector6<S> F;
      F.template head<3>() = at.R_BE * Vector3<S>(F_E.head<3>().cast<S>());
      F.template tail<3>() = at.R_BE * Vector3<S>(F_E.tail<3>().cast<S>());
      responses_.push_back(respond(jacobian, F));
    }
  }

  /// Of the hand, in B, m.
  const Vector3<S>& hand() const { return kinematics_.r_bh; }
  const Matrix3<S>& hand_axes() const { return kinematics_.R_hand; }

  /// |y|^2 after an impulse, with the sizes of its terms.
  S square_of(const ImpulseCase& impulse, const std::vector<double>& coefficients) const {
    const Response at = combined(coefficients);
    S scale(impulse.numerator), inverse(1.0);
    if (impulse.closing) {
      const Vector3<S> d = Vector3d(impulse.F.head<3>()).cast<S>();
      const S speed = d.dot(velocity_in_T<S>(encounter_, impulse.closing->point));
      scale *= positive_part(speed + S(impulse.closing->offset));
    }
    const bool by_law = impulse.target_inverse_mass.has_value();
    S divisor(1.0);
    if (by_law) {
      divisor = S(*impulse.target_inverse_mass);
      for (int i = 0; i < 3; ++i) divisor += square(S(impulse.F[i])) * inverse_mass_;
      for (int i = 0; i < size_; ++i) divisor += square(at.z[i]) * inverse_D_[i];
      inverse = inverse_of(divisor);
    }
    S sum(0.0);
    for (const ObjectiveTerm& term : problem_.objective) {
      const S factor = scale / S(term.size);
      for_each_component(term, at, [&](const S& y) {
        if (y.is_zero()) return;
        sum += square((by_law ? quotient(y, divisor, inverse) : y) * factor);
      });
    }
    return sum;
  }

 private:
  static constexpr int kMaxSize = kMaxJointsOf<S> + 3;
  using Column = std::array<S, kMaxSize>;

  struct Response {
    Column z, x;        ///< C^-1 G b, K^-1 b
    Vector3<S> total;   ///< L
    Vector6<S> wrench;  ///< on the base, R_bh' F
  };

  void factorise() {
    const ZeroProblem& where = problem_.where;
    for (int k = 0; k < robot_.n(); ++k) {
      const auto index = static_cast<std::size_t>(k);
      if (index >= where.locked.size() || !where.locked[index]) moving_.push_back(k);
    }
    joints_ = static_cast<int>(moving_.size());
    size_ = joints_ + 3;
    const auto entry = [&](int i, int j) -> S {
      if (i < joints_) {
        const int k = moving_[i];
        S value = tilde_.Htilde_phi(k, moving_[j]);
        if (i == j) value += S(where.added_inertia[k]);
        return value;
      }
      if (j < joints_) return tilde_.Htilde_omegaphi(i - joints_, moving_[j]);
      return tilde_.Htilde_omega(i - joints_, j - joints_);
    };
    std::array<Column, kMaxSize> K;  // lower triangle
    Eigen::MatrixXd middle(size_, size_);
    for (int i = 0; i < size_; ++i) {
      for (int j = 0; j <= i; ++j) {
        K[i][j] = entry(i, j);
        middle(i, j) = middle(j, i) = K[i][j].c;
      }
    }
    precondition(middle);
    for (int i = 0; i < size_; ++i) {
      Column GK;  // row i of G K
      for (int j = 0; j < size_; ++j) {
        for (int k = 0; k <= i; ++k) GK[j] += (k > j ? K[k][j] : K[j][k]) * S(G_(i, k));
      }
      for (int j = 0; j <= i; ++j) {
        S value(0.0);
        for (int k = 0; k <= j; ++k) value += GK[k] * S(G_(j, k));
        if (j < i) {
          for (int k = 0; k < j; ++k) value -= C_[i][k] * CD_[j][k];
          CD_[i][j] = value;
          C_[i][j] = quotient(value, D_[j], inverse_D_[j]);
        } else {
          for (int k = 0; k < j; ++k) value -= square(CD_[i][k]) * inverse_D_[k];
          D_[i] = value;
          inverse_D_[i] = inverse_of(D_[i]);
        }
      }
    }
  }

  /// G, lower triangular with G middle G' near the identity.
  void precondition(const Eigen::MatrixXd& middle) {
    const Eigen::LLT<Eigen::MatrixXd> llt(middle);
    const Eigen::MatrixXd E = Eigen::MatrixXd::Identity(size_, size_);
    G_ = E;
    if (llt.info() != Eigen::Success) return;
    const Eigen::MatrixXd inverse = llt.matrixL().solve(E);
    if (inverse.allFinite() && (inverse.diagonal().array() != 0).all()) {
      G_ = inverse.triangularView<Eigen::Lower>();
    }
  }

  Response respond(const HandJacobian<S>& jacobian, const Vector6<S>& F) const {
    const Vector3<S> f = F.template head<3>();
    Response out;
    out.wrench = F;
    out.wrench.template tail<3>() += kinematics_.r_bh.cross(f);
    const Vector3<S> r_gh = kinematics_.r_bh - inertia_.r_bg;
    out.total = r_gh.cross(f) + F.template tail<3>();
    Column b, y;  // y = G'^-1 x
    for (int i = 0; i < size_; ++i) {
      if (i < joints_) {
        const int k = moving_[i];
        const Vector3<S> p = inertia_.H_bphi.template block<3, 1>(0, k);
        b[i] = jacobian.J_phi.col(k).dot(F) - p.dot(f) * inverse_mass_;
      } else {
        b[i] = out.total[i - joints_];
      }
      for (int k = 0; k <= i; ++k) out.z[i] += b[k] * S(G_(i, k));
      for (int k = 0; k < i; ++k) out.z[i] -= C_[i][k] * out.z[k];
    }
    for (int i = size_ - 1; i >= 0; --i) {
      y[i] = quotient(out.z[i], D_[i], inverse_D_[i]);
      for (int k = i + 1; k < size_; ++k) y[i] -= C_[k][i] * y[k];
    }
    for (int i = 0; i < size_; ++i) {
      for (int k = i; k < size_; ++k) out.x[i] += y[k] * S(G_(k, i));
    }
    return out;
  }

  Response combined(const std::vector<double>& coefficients) const {
    if (coefficients.size() == 1 && coefficients.front() == 1) return responses_.front();
    Response out;
    out.total.setZero();
    out.wrench.setZero();
    for (std::size_t b = 0; b < coefficients.size(); ++b) {
      const S factor(coefficients[b]);
      const Response& one = responses_[b];
      for (int i = 0; i < size_; ++i) {
        out.z[i] += one.z[i] * factor;
        out.x[i] += one.x[i] * factor;
      }
      out.total += one.total * factor;
      out.wrench += one.wrench * factor;
    }
    return out;
  }

  /// The vector behind a term, per unit of impulse, without its size.
  template <class Use>
  void for_each_component(const ObjectiveTerm& term, const Response& at, const Use& use) const {
    const Vector3<S> omega(at.x[joints_], at.x[joints_ + 1], at.x[joints_ + 2]);
    switch (term.quantity) {
      case ObjectiveQuantity::BaseAngularMomentum: {
        const Vector3<S> base = tilde_.Htilde_omega * omega;
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
        // H_b Delta Omega = R_bh' F - H_bphi Delta phidot, the upper rows of (3) as a jump.
        Vector6<S> momentum = at.wrench;
        for (int i = 0; i < joints_; ++i) momentum -= inertia_.H_bphi.col(moving_[i]) * at.x[i];
        for (int i = 0; i < 3; ++i) use(momentum[i]);
        for (int i = 3; i < 6; ++i) use(momentum[i] / S(term.length));
        break;
      }
      case ObjectiveQuantity::ImpulseMagnitude:
        use(S(1.0));
        break;
      case ObjectiveQuantity::JointRateNorm:
        for (int i = 0; i < joints_; ++i) use(at.x[i]);
        break;
      case ObjectiveQuantity::AttitudeTurned:
        break;  // simulated: minimum_objection() refuses it
    }
  }

  const MinimumProblem& problem_;
  const RobotModel& robot_;
  const EncounterRange<S>& encounter_;
  Kinematics<S> kinematics_;
  InertiaMatrices<S> inertia_;
  TildeInertia<S> tilde_;
  S inverse_mass_;
  std::vector<int> moving_;
  int joints_ = 0, size_ = 0;
  Eigen::MatrixXd G_;
  std::array<Column, kMaxSize> C_, CD_;  ///< strictly below the diagonal: C, and C D
  Column D_, inverse_D_;
  std::vector<Response> responses_;
};

}  // namespace stillbase::proof
