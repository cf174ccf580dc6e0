// The section `variables`.
#include "io/fields/sections.hpp"

namespace stillbase::io {

namespace {

/// A finding where a lower end lies above an upper one.
void check_order(MapReader* map, bool is_ordered) {
  if (map == nullptr || is_ordered) return;
  map->context().add(map->line(), "out-of-range", map->path() + ": lower must not exceed upper");
}

void attitude_fields(Table& t, VariableSpec& variables) {
  t("freedom", Word(variables.base_attitude, kAttitudeFreedomNames),
    "`fixed`, `axis`, `cone` (one axis of the base stays near a direction, the roll about it is "
    "free), `free`",
    {.need = Need::Required, .decides = true});
  const bool is_cone = variables.base_attitude == AttitudeFreedom::Cone;
  const bool needs_axis = is_cone || variables.base_attitude == AttitudeFreedom::Axis;
  VariableSpec defaults;
  t("axis", Vector(variables.base_attitude_axis, VectorKind::Direction),
    "`axis`: direction of the rotation; `cone`: direction that the axis of the base has in the "
    "stated attitude",
    {.need = needs_axis ? Need::Required : Need::Optional,
     .frame = "N",
     .without = default_text(Vector(defaults.base_attitude_axis, VectorKind::Direction))});
  t("max",
    Number(variables.base_attitude_max, Dimension::Angle,
           {.lower = 0, .upper = kPi, .is_lower_open = true}),
    "largest rotation angle from the stated attitude, `cone`: of its axis from the direction",
    {.need = is_cone ? Need::Required : Need::Optional, .without = "pi; `cone`: required"});
}

void position_fields(Table& t, VariableSpec& variables) {
  t("freedom", Word(variables.base_position, kPositionFreedomNames), "`fixed`, `box`, `free`",
    {.need = Need::Required, .decides = true});
  const bool is_box = variables.base_position == PositionFreedom::Box;
  VariableSpec defaults;
  const About corner{.need = is_box ? Need::Required : Need::Optional,
                     .frame = "N",
                     .without = default_text(Vector(defaults.base_position_lower))};
  t("lower", Vector(variables.base_position_lower, Dimension::Length, kPlace),
    "`box`: lower corner", corner);
  t("upper", Vector(variables.base_position_upper, Dimension::Length, kPlace),
    "`box`: upper corner", corner);
  check_order(
      t.reader(),
      (variables.base_position_lower.array() <= variables.base_position_upper.array()).all());
}

void time_fields(Table& t, VariableSpec& variables) {
  t("lower", Number(variables.contact_time_lower, Dimension::Time, kInstant), "start of the window",
    kNeeded);
  t("upper", Number(variables.contact_time_upper, Dimension::Time, kInstant), "end of the window",
    kNeeded);
  check_order(t.reader(), variables.contact_time_lower <= variables.contact_time_upper);
}

void feature_field(Table& t, CaptureProblem& problem) {
  VariableSpec& variables = problem.variables;
  std::vector<std::string> names;
  if (problem.target) {
    for (const ContactFeature& feature : problem.target->features) names.push_back(feature.name);
  }
  if (t.reader() != nullptr && names.size() == 1) variables.feature = names[0];
  const char* const known = problem.target || t.reader() == nullptr
                                ? "features of the target"
                                : "features of the target, which is not stated";
  const auto one = [&](std::string& name) { return Text(name, names, known); };
  const bool is_choice = !variables.features.empty();
  t("feature",
    Either(
        {Instead("none", !is_choice && variables.feature.empty(), [&] { variables.feature = ""; }),
         WrittenIf(List<std::string>(variables.features, one, {.least = 1, .is_unique = true}),
                   is_choice),
         one(variables.feature)}),
    "contact feature, `none`, or a list: each is planned for, and the best plan is taken",
    {.need = names.size() > 1 ? Need::Required : Need::Optional, .without = "the only one"});
  if (t.reader() == nullptr || variables.features.empty()) return;
  variables.feature = variables.features.front();
  if (variables.features.size() == 1) variables.features.clear();
}

}  // namespace

void variables_fields(Table& t, CaptureProblem& problem) {
  VariableSpec& variables = problem.variables;
  VariableSpec defaults;
  t("joints", JointFlags(variables.joints, problem.robot), "`all`, `none` or a list of joints",
    {.without = "`all`"});
  t("base_attitude", Map([&](Table& m) { attitude_fields(m, variables); }, {.alone = "freedom"}),
    "`fixed`, `free` or a map",
    {.without = default_text(Word(defaults.base_attitude, kAttitudeFreedomNames))});
  t("base_position", Map([&](Table& m) { position_fields(m, variables); }, {.alone = "freedom"}),
    "`fixed`, `free` (the station follows the hand) or a map",
    {.without = default_text(Word(defaults.base_position, kPositionFreedomNames))});
  double instant = defaults.contact_time_lower;
  t("contact_time",
    Either(
        {Shorthand(Number(instant, Dimension::Time, kInstant),
                   [&] { variables.contact_time_lower = variables.contact_time_upper = instant; }),
         Map([&](Table& m) { time_fields(m, variables); })}),
    "an instant, or a window `{lower, upper}` (beside a stated `impact.direction` nothing depends "
    "on it: an instant alone)",
    {.without = default_text(Number(instant, Dimension::Time, kInstant))});
  feature_field(t, problem);
}

}  // namespace stillbase::io
