#include <stillbase/plan/quantities.hpp>

#include <algorithm>

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

}  // namespace

const std::vector<QuantityRow>& quantities() {
  using Quantity = ObjectiveQuantity;
  using Part = ResponsePart;
  static const std::vector<QuantityRow> rows = {
      {Quantity::BaseAngularMomentum, "base_angular_momentum", "N m s",
       "|Htilde_omega Delta omega|: angular momentum that the base keeps", false, false,
       one_part<Part::BaseAngularMomentum>},
      {Quantity::BaseAngularVelocity, "base_angular_velocity", "rad/s",
       "|Delta omega|: angular velocity of the base", false, false, one_part<Part::BaseRate>},
      {Quantity::TotalAngularMomentum, "total_angular_momentum", "N m s",
       "|Delta L_g|: angular momentum of the whole robot about its centroid", false, false,
       one_part<Part::TotalAngularMomentum>},
      {Quantity::BaseMomentum, "base_momentum", "N s",
       "|[P; L / length]|, [P; L] = H_b Delta Omega of (1): linear and angular momentum that the "
       "base receives",
       true, false, received_momentum},
      {Quantity::ImpulseMagnitude, "impulse_magnitude", "N s", "p: magnitude of the impulse", false,
       false, one_part<Part::Impulse>},
      {Quantity::JointRateNorm, "joint_rate_norm", "rad/s", "|Delta phidot|: rates of the joints",
       false, false, one_part<Part::JointRates>},
      {Quantity::AttitudeTurned, "attitude_turned", "rad",
       "rotation angle of the base from the impact to `after` later under the first controller, at "
       "most pi; pi where the simulation breaks off",
       false, true, nullptr}};
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
