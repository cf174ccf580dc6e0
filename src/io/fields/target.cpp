// The section `target`, and target files.
#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/io/target_file.hpp>
#include <stillbase/robot/physical_checks.hpp>

#include "io/fields/sections.hpp"

namespace stillbase {

namespace io {

void inertia_fields(Table& t, Matrix3d& inertia) {
  const std::size_t before = t.reader() == nullptr ? 0 : t.reader()->context().findings.size();
  t("ixx", Number(inertia(0, 0), Dimension::Inertia, kInertia), "", kNeeded);
  t("iyy", Number(inertia(1, 1), Dimension::Inertia, kInertia), "", kNeeded);
  t("izz", Number(inertia(2, 2), Dimension::Inertia, kInertia), "", kNeeded);
  t("ixy", Number(inertia(0, 1), Dimension::Inertia, kInertia), "");
  t("ixz", Number(inertia(0, 2), Dimension::Inertia, kInertia), "");
  t("iyz", Number(inertia(1, 2), Dimension::Inertia, kInertia), "");
  inertia = Matrix3d(inertia.selfadjointView<Eigen::Upper>());
  MapReader* map = t.reader();
  if (map == nullptr || map->context().findings.size() != before) return;
  const std::string fault = inertia_fault(inertia);
  if (fault.empty()) return;
  map->context().add(map->line(), "impossible-inertia", fmt::format("{}: {}", map->path(), fault));
}

static void fields(Table& t, TargetShape& shape) {
  pose_fields(t, shape.pose, "the shape", "T", kPlaceOnBody);
  t("geometry", geometry_of(shape.geometry), "geometry, in m", kNeeded);
}

static void fields(Table& t, ContactFeature& feature) {
  t("name", Text(feature.name), "name", kNeeded);
  t("point", Vector(feature.point, Dimension::Length, kPlaceOnBody), "place",
    {.need = Need::Required, .frame = "T"});
  t("normal", Vector(feature.normal, VectorKind::Unit), "outward normal",
    {.need = Need::Required, .frame = "T"});
}

void fields(Table& t, EstimateDeviations& deviations) {
  // Beyond these a Gaussian of the error means nothing.
  const Range angle{.lower = 0, .upper = 1}, relative{.lower = 0, .upper = 0.5};
  const auto in = [](const char* frame) { return About{.frame = frame, .without = "0"}; };
  t("position", Deviation(deviations.position, Dimension::Length, kDistance), "of the centroid",
    in("N"));
  t("orientation", Deviation(deviations.orientation, Dimension::Angle, angle),
    "of the rotation vector from the estimated to the true attitude", in("T"));
  t("linear_velocity", Deviation(deviations.linear_velocity, Dimension::Velocity, kSpeed),
    "of the centroid", in("N"));
  t("angular_velocity",
    Deviation(deviations.angular_velocity, Dimension::AngularVelocity, kSpinSize),
    "of the angular velocity", in("N"));
  t("mass", Number(deviations.mass, relative), "of the mass, relative");
  t("moments", Deviation(deviations.moments, Dimension::None, relative),
    "of the principal moments of inertia in rising order, relative; their axes count as known",
    in(""));
}

namespace {

void state_fields(Table& t, TargetState& state, std::optional<EstimateDeviations>& deviations) {
  t("time", Number(state.time, Dimension::Time, kInstant), "instant of the estimate");
  pose_fields(t, state.pose, "T, the centroid", "N", kPlace);
  t("linear_velocity", Vector(state.linear_velocity, Dimension::Velocity, kVelocity),
    "of the centroid", {.frame = "N"});
  Vector3d axis = Vector3d::UnitZ();
  double rate = 0;
  t("angular_velocity",
    Either({Shorthand(Map([&](Table& spin) {
                        spin("axis", Vector(axis, VectorKind::Direction), "axis of the rotation",
                             needed("", "N"));
                        spin("rate", Number(rate, Dimension::AngularVelocity, kSpin),
                             "rate about it", kNeeded);
                      }),
                      [&] { state.angular_velocity = axis * rate; }),
            Vector(state.angular_velocity, Dimension::AngularVelocity, kSpin)}),
    "vector, or `{axis, rate}`", {.frame = "N"});
  EstimateDeviations stated = deviations.value_or(EstimateDeviations{});
  t("covariance", Map([&](Table& m) { fields(m, stated); }, {.is_written = deviations.has_value()}),
    "how well the estimate is known: standard deviations of independent Gaussian errors, each one "
    "number for all three axes or a list of three; propagated to the contact by the unscented "
    "transform",
    {.without = "none"});
  if (t.reader() != nullptr && t.reader()->has("covariance")) deviations = stated;
}

void read_target(MapReader& map, const std::string& file, CaptureProblem& problem,
                 const ProblemSources& sources) {
  std::string full_path;
  const auto text = map.read_file("file", file, sources.folder, full_path);
  if (!text) return;
  ReadContext own{full_path, {}, {}};
  try {
    problem.target.emplace();
    Map([&](Table& t) {
      target_file_fields(t, *problem.target);
    }).read(own, parse_document(*text, own), "");
  } catch (const InputError&) {  // its findings are in `own`
  }
  std::vector<Finding>& findings = map.context().findings;
  findings.insert(findings.end(), own.findings.begin(), own.findings.end());
  std::vector<Finding>& remarks = map.context().remarks;
  remarks.insert(remarks.end(), own.remarks.begin(), own.remarks.end());
}

}  // namespace

void target_body_fields(Table& t, TargetBody& body) {
  static constexpr auto kModels = names<bool>({{"rigid_body", false}, {"point_mass", true}});
  t("name", Text(body.name), "short name", kNeeded);
  t("model", Word(body.is_point_mass, kModels), "`rigid_body` or `point_mass`", kNeeded);
  t("mass", Number(body.mass, Dimension::Mass, kSensible), "mass", kNeeded);
  t("inertia", Map([&](Table& m) { inertia_fields(m, body.inertia); }),
    "`{ixx, iyy, izz, ixy, ixz, iyz}` about the centroid; products default to 0",
    {.need = t.reader() != nullptr ? Need::Required : Need::Optional,
     .frame = "kg m^2, T",
     .without = "required of a rigid body",
     .is_used = !body.is_point_mass,
     .owner = "rigid bodies; a point mass has no inertia tensor"});
  t("shapes", maps_of(body.shapes, {}, TargetShape{{}, Sphere{0}}),
    "list of bodies for collision checks");
  t("features", maps_of(body.features, {.unique_key = "name"}),
    "list of contact features: places that may be touched or grasped");
}

void target_file_fields(Table& t, TargetBody& body) {
  format_fields(t, "stillbase.target");
  target_body_fields(t, body);
}

void target_fields(Table& t, CaptureProblem& problem, const ProblemSources& sources) {
  std::string file;
  if (t.states("file", false)) {
    t("file", Text(file), "a target file (`format: stillbase.target`) instead of the next fields",
      {.need = Need::Required, .without = "none"});
    if (t.reader() != nullptr && !file.empty()) read_target(*t.reader(), file, problem, sources);
  } else {
    TargetBody body = problem.target.value_or(TargetBody{});
    target_body_fields(t, body);
    problem.target = std::move(body);
  }
  t("state",
    Map([&](Table& m) { state_fields(m, problem.target_state, problem.target_deviations); },
        {.is_written = !problem.impulse.direction}),
    "estimated motion",
    {.without = "required when `impact.direction` is not stated, refused when it is"});
}

}  // namespace io

TargetBody read_target_text(std::string_view text, const std::string& source) {
  TargetBody body;
  io::read_map(text, source, [&](io::Table& t) { io::target_file_fields(t, body); });
  return body;
}

}  // namespace stillbase
