// The result of `predict`.
#include "io/fields/results.hpp"

namespace stillbase::io {

static void fields(Table& t, PredictedFeature& feature) {
  const bool is_known = feature.covariance.has_value();
  const Eigen::MatrixXd covariance = feature.covariance.value_or(Eigen::MatrixXd::Zero(9, 9));
  t("name", Text(feature.name), "", kNeeded);
  t("point", Vector(feature.point), "", needed("m", "N"));
  t("normal", Vector(feature.normal), "outward, norm 1", needed("1", "N"));
  t("velocity", Vector(feature.velocity), "of the material point", needed("m/s", "N"));
  t("closing_speed", Number(feature.closing_speed), "normal . velocity: to a hand at rest",
    needed("m/s"));
  t("covariance", WrittenIf(Rows(covariance), is_known),
    "second moments of the errors of point, normal (its rotation vector) and velocity, 9 rows; the "
    "bias of the mean is counted in",
    {.unit = "m, rad, m/s", .frame = "N", .without = "none stated of the estimate"});
}

static void fields(Table& t, PredictedInstant& instant) {
  TargetState& state = instant.state;
  t("time", Number(state.time), "", needed("s"));
  t("position", Vector(state.pose.position), "of the centroid", needed("m", "N"));
  t("orientation", Orientation(state.pose.orientation), "of T", needed("", "N"));
  t("linear_velocity", Vector(state.linear_velocity), "of the centroid", needed("m/s", "N"));
  t("angular_velocity", Vector(state.angular_velocity), "", needed("rad/s", "N"));
  t("features", maps_of(instant.features), "of the target, in its order", kNeeded);
}

void prediction_fields(Table& t, TargetPrediction& prediction) {
  format_fields(t, "stillbase.prediction");
  t("target", Text(prediction.target), "its name", kNeeded);
  t("instants", maps_of(prediction.instants), "by time", kNeeded);
}

}  // namespace stillbase::io
