#include <stillbase/plan/quantities.hpp>

#include <algorithm>

#include <stillbase/core/linear_algebra.hpp>

namespace stillbase {

namespace {

using Blocks = std::vector<QuantityBlock>;

/// y is one part of the response.
template <ResponsePart part>
Blocks one_part(const ObjectiveTerm&, const RobotModel&) {
  return {{part}};
}

Blocks received_momentum(const ObjectiveTerm& term, const RobotModel&) {
  return {{ResponsePart::ReceivedLinearMomentum},
          {ResponsePart::ReceivedAngularMomentum, Matrix3d::Identity(), term.length}};
}

/// |y|^2 = 1/2 m |Delta v|^2 + 1/2 Delta omega' I Delta omega: G' G = I / 2.
Blocks base_energy(const ObjectiveTerm&, const RobotModel& robot) {
  const SymmetricEigen3 half = symmetric_eigen3(robot.base.inertia / 2);
  const Matrix3d G = half.values.cwiseSqrt().asDiagonal() * half.vectors.transpose();
  return {{ResponsePart::BaseVelocity, std::sqrt(robot.base.mass / 2) * Matrix3d::Identity()},
          {ResponsePart::BaseRate, G}};
}

}  // namespace

const std::vector<QuantityRow>& quantities() {
  using Quantity = ObjectiveQuantity;
  using Part = ResponsePart;
  static const std::vector<QuantityRow> rows = {
      {.quantity = Quantity::BaseAngularMomentum,
       .name = "base_angular_momentum",
       .unit = "N m s",
       .sentence = "|Htilde_omega Delta omega|: angular momentum that the base keeps",
       .zero_momentum = Part::BaseAngularMomentum,
       .blocks = one_part<Part::BaseAngularMomentum>},
      {.quantity = Quantity::BaseAngularVelocity,
       .name = "base_angular_velocity",
       .unit = "rad/s",
       .sentence = "|Delta omega|: angular velocity of the base",
       .zero_momentum = Part::BaseAngularMomentum,
       .blocks = one_part<Part::BaseRate>},
      {.quantity = Quantity::TotalAngularMomentum,
       .name = "total_angular_momentum",
       .unit = "N m s",
       .sentence = "|Delta L_g|: angular momentum of the whole robot about its centroid",
       .zero_momentum = Part::TotalAngularMomentum,
       .blocks = one_part<Part::TotalAngularMomentum>},
      {.quantity = Quantity::BaseMomentum,
       .name = "base_momentum",
       .unit = "N s",
       .sentence = "|[P; L / length]|, [P; L] = H_b Delta Omega of (1): linear and angular "
                   "momentum that the base receives",
       .needs_length = true,
       .blocks = received_momentum},
      {.quantity = Quantity::ImpulseMagnitude,
       .name = "impulse_magnitude",
       .unit = "N s",
       .sentence = "p: magnitude of the impulse",
       .blocks = one_part<Part::Impulse>},
      {.quantity = Quantity::JointRateNorm,
       .name = "joint_rate_norm",
       .unit = "rad/s",
       .sentence = "|Delta phidot|: rates of the joints",
       .blocks = one_part<Part::JointRates>},
      {.quantity = Quantity::BaseEnergy,
       .name = "base_energy",
       .unit = "J",
       .sentence = "1/2 m |Delta v|^2 + 1/2 Delta omega' I Delta omega: kinetic energy of the base "
                   "body",
       .power = {2},
       .blocks = base_energy},
      {.quantity = Quantity::AttitudeTurned,
       .name = "attitude_turned",
       .unit = "rad",
       .sentence = "rotation angle of the base from the impact to `after` later under the first "
                   "controller, at most pi; pi where the simulation breaks off",
       .needs_time = true}};
  return rows;
}

const QuantityRow& row_of(ObjectiveQuantity quantity) {
  const std::vector<QuantityRow>& rows = quantities();
  return *std::find_if(rows.begin(), rows.end(),
                       [&](const QuantityRow& row) { return row.quantity == quantity; });
}

const QuantityRow* quantity_of_name(const std::string& name) {
  const std::vector<QuantityRow>& rows = quantities();
  const auto found = std::find_if(rows.begin(), rows.end(),
                                  [&](const QuantityRow& row) { return row.name == name; });
  return found == rows.end() ? nullptr : &*found;
}

}  // namespace stillbase
