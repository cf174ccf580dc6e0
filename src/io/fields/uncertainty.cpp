// The section `uncertainty`.
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
  double confidence = uncertainty.cone_confidence.value_or(0.95);
  // A schema cannot know which of the two angles is stated.
  t("confidence",
    WrittenIf(Number(confidence, {.lower = 0, .upper = 0.9999, .is_lower_open = true}),
              from_covariance),
    "beside `from_covariance`", {.without = "0.95"});
  MapReader* map = t.reader();
  if (map == nullptr) return;
  if (from_covariance) {
    uncertainty.cone_confidence = confidence;
  } else if (map->has("confidence") && !map->was_refused("cone_half_angle")) {
    map->refuse("confidence", "not-used", "is stated only beside cone_half_angle: from_covariance");
  }
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
  t("closing_speed", Number(spread.closing_speed, Dimension::Velocity, kSpeed),
    "half range of a uniform distribution, as the next six; they count for samples alone");
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
