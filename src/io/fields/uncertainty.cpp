// The section `uncertainty`.
#include <fmt/format.h>

#include <stillbase/encounter/direction_cone.hpp>

#include "io/fields/sections.hpp"

namespace stillbase::io {

namespace {

void cone_fields(Table& t, UncertaintySpec& uncertainty) {
  bool from_covariance = uncertainty.cone_confidence.has_value();
  t("cone_half_angle",
    Either({Instead("from_covariance", from_covariance, [&] { from_covariance = true; }),
            Number(uncertainty.cone_half_angle, Dimension::Angle, {.lower = 0, .upper = kPi / 2})}),
    "largest angle between the nominal and the true direction; or `from_covariance`: the angle "
    "about the nominal normal that holds the true one with the probability `confidence` whenever "
    "the contact is in its window, by `target.state.covariance` (Gaussian errors of the normal; "
    "Rayleigh's distribution when they are isotropic)");
  double confidence = uncertainty.cone_confidence.value_or(kDefaultConeConfidence);
  // A schema cannot know which of the two angles is stated.
  t("confidence",
    WrittenIf(Number(confidence, {.lower = 0, .upper = 0.9999, .is_lower_open = true}),
              from_covariance),
    "beside `from_covariance`", {.without = fmt::format("{}", kDefaultConeConfidence)});
  MapReader* map = t.reader();
  if (map == nullptr) return;
  if (from_covariance) {
    uncertainty.cone_confidence = confidence;
  } else if (map->has("confidence") && !map->was_refused("cone_half_angle")) {
    map->refuse("confidence", "not-used", "is stated only beside cone_half_angle: from_covariance");
  }
}

void residual_fields(Table& t, std::optional<ResidualVelocity>& stated) {
  ResidualVelocity residual = stated.value_or(ResidualVelocity{});
  const bool was_stated = stated.has_value();
  bool is_carried = was_stated && !residual.covariance;
  Matrix6d covariance = residual.covariance.value_or(Matrix6d::Zero());
  t("residual_velocity",
    Either({Instead("from_covariance", is_carried, [&] { is_carried = true; }),
            WrittenIf(Covariance(covariance), was_stated && !is_carried)}),
    "how well the relative velocity of target and hand is known at the contact, [linear; angular] "
    "at the hand: its covariance, Gaussian about the nominal velocity, 6 rows in m^2/s^2, "
    "m rad/s^2 and rad^2/s^2; or `from_covariance`: that of `target.state.covariance` carried to "
    "the contact, plus `hand_tracking`. `worst_case` and `expectation` are over this velocity "
    "then, in closed form",
    {.without = "none"});
  t("residual_frame",
    WrittenIf(Word(residual.frame, kResidualFrameNames), residual.covariance.has_value()),
    "axes of a stated residual_velocity: those of the target at the contact, or of N",
    {.without = "target"});
  t("residual_deviations",
    WrittenIf(Number(residual.deviations, {.lower = 0, .upper = 10, .is_lower_open = true}),
              was_stated),
    "of `worst_case`: the largest value over the ellipsoid of this many standard deviations",
    {.without = fmt::format("{}", ResidualVelocity{}.deviations)});
  t("hand_tracking",
    Map(
        [&](Table& m) {
          m("linear", Number(residual.linear_tracking, Dimension::Velocity, kSpeed),
            "along every axis");
          m("angular", Number(residual.angular_tracking, Dimension::AngularVelocity, kSpinSize),
            "about every axis");
        },
        {.is_written = is_carried}),
    "beside `residual_velocity: from_covariance`: standard deviations of the hand's own velocity, "
    "independent of the target's",
    {.without = "0"});
  MapReader* map = t.reader();
  if (map == nullptr || map->was_refused("residual_velocity")) return;
  const bool is_stated = map->has("residual_velocity");
  const auto needs = [map](const char* key, bool is_used, const char* beside) {
    if (!is_used && map->has(key)) {
      map->refuse(key, "not-used", fmt::format("is stated only beside {}", beside));
    }
  };
  needs("residual_frame", is_stated && !is_carried, "a matrix residual_velocity");
  needs("residual_deviations", is_stated, "residual_velocity");
  needs("hand_tracking", is_carried, "residual_velocity: from_covariance");
  if (!is_stated) return;
  if (!is_carried) residual.covariance = covariance;
  stated = residual;
}

}  // namespace

void uncertainty_fields(Table& t, CaptureProblem& problem) {
  UncertaintySpec& spread = problem.uncertainty;
  std::optional<Vector3d>& plane = spread.cone_plane_normal;
  static const auto kPlanes = names<std::optional<Vector3d>>({{"none", std::nullopt},
                                                              {"xy", Vector3d::UnitZ()},
                                                              {"yz", Vector3d::UnitX()},
                                                              {"xz", Vector3d::UnitY()}});
  cone_fields(t, spread);
  t("cone_plane",
    Either({WrittenIf(Word(plane, kPlanes), !plane), Vector(plane, VectorKind::Unit)}),
    "planar problems: `xy`, `yz`, `xz` or a normal; the cone becomes a wedge in this plane. "
    "Refused where arm, base, target or an error of its estimate may leave the plane",
    {.frame = "B"});
  residual_fields(t, spread.residual_velocity);
  t("closing_speed", Number(spread.closing_speed, Dimension::Velocity, kSpeed),
    "half range of a uniform distribution, as the next six; they count for samples and trials "
    "alone");
  t("restitution", Number(spread.restitution, {.lower = 0, .upper = 1}), "stays in [0, 1]");
  t("target_mass", Number(spread.target_mass, {.lower = 0, .upper = 0.99}), "fraction of the mass");
  t("target_inertia", Number(spread.target_inertia, {.lower = 0, .upper = 0.99}),
    "fraction of the inertia");
  t("contact_point", Number(spread.contact_point, Dimension::Length, {.lower = 0, .upper = 1000}),
    "radius of a disc normal to the direction; the hand stays, the impulse acts beside its origin");
  t("joint_position",
    JointValues(spread.joint_position, problem.robot, kJointPosition, {.lower = 0, .upper = 1}),
    "of the posture at the impact; hand and direction stay", {.without = "0"});
  t("contact_time", Number(spread.contact_time, Dimension::Time, {.lower = 0, .upper = 600}),
    "the target is this far ahead of its prediction; the hand stays");
}

}  // namespace stillbase::io
