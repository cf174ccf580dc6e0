#include "proof/variable_encounter.hpp"

#include "proof/taylor.hpp"

namespace stillbase::proof {
namespace {

/// Attitude and rate of the target over a span of time.
template <class S>
struct TargetAttitude {
  Matrix3<S> R_NT;
  Vector3<S> omega;  ///< in T, rad/s
};

/// A function of time over the box of `time`, from enclosures of it and of its rate.
template <int Rows, int Cols>
Eigen::Matrix<Dual, Rows, Cols> in_time(const Eigen::Matrix<Dual, Rows, Cols>& value,
                                        const Eigen::Matrix<Dual, Rows, Cols>& rate,
                                        const Dual& time) {
  Eigen::Matrix<Dual, Rows, Cols> out = value;
  for (Eigen::Index k = 0; k < out.size(); ++k) {
    Dual& entry = out.data()[k];
    entry.count = time.count;
    for (int i = 0; i < time.count; ++i) entry.d[i] = rate.data()[k].v * time.d[i];
  }
  return out;
}

/// The target's attitude and rate with their derivatives.
TargetAttitude<Dual> attitude_over(const SpinEnclosure& spin, const Dual& time) {
  const SpinRange range = spin.over(time.v);
  return {in_time(range.R, range.R_rate, time), in_time(range.omega, range.omega_rate, time)};
}

/// The target's attitude and rate to fourth order in time, about the middle of the box.
template <int N, int K>
TargetAttitude<Taylor<N, K>> attitude_over(const SpinEnclosure& spin, const Taylor<N, K>& time) {
  const SpinSeries motion = spin.series(time.c(), time.range());
  const auto entry = [&](const auto& f, const auto& whole, Eigen::Index i) {
    std::array<Interval, SpinSeries::kTerms> terms;
    for (std::size_t k = 0; k < terms.size(); ++k) terms[k] = f[k].data()[i].v;
    return series(time, terms, whole.data()[i].v);
  };
  TargetAttitude<Taylor<N, K>> out;
  for (Eigen::Index i = 0; i < 9; ++i) {
    out.R_NT.data()[i] = entry(motion.R, motion.whole.R, i);
  }
  for (Eigen::Index i = 0; i < 3; ++i) {
    out.omega.data()[i] = entry(motion.omega, motion.whole.omega, i);
  }
  return out;
}

/// Rotation by `angle` about a constant unit axis: E + sin K + (1 - cos) K^2.
template <class S>
Matrix3<S> rotation_about(const Vector3d& axis, const S& angle) {
  const Matrix3<S> K = skew<double>(axis).template cast<S>();
  Matrix3<S> R = K * sin(angle) + Matrix3<S>(K * K) * (S(1.0) - cos(angle));
  for (int i = 0; i < 3; ++i) R(i, i) += S(1.0);
  return R;
}

}  // namespace

template <class S>
EncounterRange<S> encounter_over(const VariableEncounter& model, std::span<const S> x) {
  EncounterRange<S> out;
  out.phi = model.start.template cast<S>();
  out.R_NB = model.R_NB.template cast<S>();
  Vector3<S> sigma = Vector3<S>::Zero();
  S time(0.0);
  for (std::size_t i = 0; i < model.variables.size(); ++i) {
    const Variable& variable = model.variables[i];
    switch (variable.kind) {
      case VariableKind::Joint:
        out.phi[variable.joint] = x[i];
        break;
      case VariableKind::BaseAngle:
        out.R_NB = rotation_about<S>(variable.axis, x[i]) * out.R_NB;
        break;
      case VariableKind::BaseParameter:
        sigma += Vector3<S>(variable.axis.template cast<S>()) * x[i];
        out.parameters_squared += square(x[i]);
        break;
      case VariableKind::Time:
        time = x[i] * S(model.time_unit);
    }
  }
  if (model.has(VariableKind::BaseParameter)) {
    out.R_NB = rotation_by<S>(sigma, out.parameters_squared) * out.R_NB;
  }

  out.closing_speed = S(model.stated.closing_speed);
  if (!model.follows_target()) {
    out.contact = contact_kinematics<S>(model, out.R_NB);
  } else if (model.has(VariableKind::Time)) {
    const TargetAttitude<S> attitude = attitude_over(*model.spin, time);
    const Vector3<S> velocity = model.estimate.linear_velocity.template cast<S>();
    const Vector3<S> position = Vector3<S>(model.estimate.pose.position.template cast<S>()) +
                                velocity * (time - S(model.estimate.time));
    const TargetKinematics<S> target{attitude.R_NT, position, velocity, attitude.omega};
    out.contact = contact_kinematics<S>(model, out.R_NB, target);
    out.closing_speed = speed_along<S>(out.contact, model.n, model.r);
  } else {
    out.contact.R_EB = Matrix3<S>(model.R_NT.transpose().template cast<S>()) * out.R_NB;
    out.contact.point = model.stated.contact.point.template cast<S>();
  }
  out.contact_point =
      model.hand_point ? Vector3<S>(model.hand_point->template cast<S>()) : out.contact.point;
  if (model.is_fixed()) {
    out.F = model.stated.F.template cast<S>();
    out.hand_point = model.stated_hand_point.template cast<S>();
    return out;
  }
  out.F = unit_wrench<S>(out.contact.R_EB, model.n, model.moment);
  if (model.hand_point && model.hand_frame == Frame::Base) {
    out.hand_point = out.contact_point;
  } else {
    out.hand_point =
        out.R_NB.transpose() *
        Vector3<S>(out.contact_point - Vector3<S>(model.base_position.template cast<S>()));
  }
  return out;
}

template EncounterRange<Dual> encounter_over(const VariableEncounter&, std::span<const Dual>);
template EncounterRange<Quadratic<2>> encounter_over(const VariableEncounter&,
                                                     std::span<const Quadratic<2>>);
template EncounterRange<Quadratic<3>> encounter_over(const VariableEncounter&,
                                                     std::span<const Quadratic<3>>);
template EncounterRange<Form<2>> encounter_over(const VariableEncounter&, std::span<const Form<2>>);
template EncounterRange<Form<3>> encounter_over(const VariableEncounter&, std::span<const Form<3>>);

}  // namespace stillbase::proof
