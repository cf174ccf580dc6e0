// The section `post_impact` of a problem.
#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include <stillbase/simulation/controllers.hpp>

#include "io/problem_reader.hpp"

namespace stillbase::io {

namespace {

// The normalised copy states every field, used or not. So a field that has no effect is refused
// where its value is not the default: a value that was chosen says something.

void read_contact(MapReader& post_impact, ContactSpec& contact) {
  const Node* node = post_impact.child("contact");
  if (node != nullptr && node->kind != Node::Kind::Map) {
    // The word alone: everything else by default.
    post_impact.choice("contact", contact.model, contact_model_names());
    return;
  }
  MapReader fields = section(post_impact, "contact");
  ReadContext& context = fields.context();
  fields.choice("model", contact.model, contact_model_names(),
                node == nullptr ? Need::Optional : Need::Required);
  // A contact must be resolved in time: half a period of 1 kg on 1e9 N/m is 0.1 ms.
  fields.number("stiffness", contact.stiffness, Dimension::LinearStiffness,
                {.lower = 1, .upper = 1e9});
  const Node* damping = fields.child("damping");
  if (damping != nullptr && damping->text != "from_restitution") {
    double value = 0;
    if (fields.number("damping", value, Dimension::LinearDamping, kNonNegative))
      contact.damping = value;
  }
  fields.number("friction", contact.friction, Dimension::None, {.lower = 0, .upper = 10});
  const ContactSpec defaults;
  const bool chosen = contact.stiffness != defaults.stiffness || contact.damping ||
                      contact.friction != defaults.friction;
  if (contact.model != ContactModel::Compliant && chosen) {
    context.add(fields.line(), "not-used",
                fmt::format("{}: stiffness, damping and friction are those of a compliant contact",
                            fields.path()));
  }
  fields.finish();
}

void read_sensor(MapReader& post_impact, PostImpactSpec& spec) {
  MapReader fields = section(post_impact, "sensor");
  SensorSpec& sensor = spec.sensor;
  const Range error{.lower = 0, .upper = 1};  // more is no measurement
  fields.number("base_rate_error", sensor.base_rate_error, Dimension::AngularVelocity, error);
  fields.number("joint_position_error", sensor.joint_position_error, Dimension::JointPosition,
                error);
  fields.number("joint_rate_error", sensor.joint_rate_error, Dimension::AngularVelocity, error);
  fields.number("delay", sensor.delay, Dimension::Time, {.lower = 0, .upper = 10});
  fields.unsigned_integer("seed", sensor.seed);
  const double periods = sensor.delay / spec.control_period;
  if (!(std::abs(periods - std::round(periods)) <= 1e-6)) {
    fields.context().add(
        fields.line_of("delay"), "out-of-range",
        fmt::format("{}: is {} s; must be a whole number of control periods of {} s",
                    fields.path_of("delay"), sensor.delay, spec.control_period));
  }
  fields.finish();
}

void read_model(MapReader& post_impact, ContactModel contact, ControllerModelSpec& model) {
  MapReader fields = section(post_impact, "model");
  const Range scale{.lower = 0.01, .upper = 100};
  fields.number("base_mass_scale", model.base_mass_scale, Dimension::None, scale);
  fields.number("arm_mass_scale", model.arm_mass_scale, Dimension::None, scale);
  fields.number("target_mass_scale", model.target_mass_scale, Dimension::None,
                {.lower = 0, .upper = 100});
  if (contact != ContactModel::Latch &&
      model.target_mass_scale != ControllerModelSpec{}.target_mass_scale) {
    fields.context().add(fields.line_of("target_mass_scale"), "not-used",
                         fmt::format("{}: the controllers know of a target only where contact "
                                     "latch holds it",
                                     fields.path_of("target_mass_scale")));
  }
  fields.number("friction_scale", model.friction_scale, Dimension::None,
                {.lower = 0, .upper = 100});
  fields.finish();
}

void read_thrusters(MapReader& post_impact, ThrusterSpec& thrusters) {
  MapReader fields = section(post_impact, "thrusters");
  fields.number("torque", thrusters.torque, Dimension::Moment, {.lower = 0, .upper = 1e6});
  fields.number("gain", thrusters.gain, Dimension::Rate, {.lower = 0, .upper = 1e3});
  fields.number("dead_band", thrusters.dead_band, Dimension::AngularVelocity, kNonNegative);
  const ThrusterSpec defaults;
  for (const auto& [key, is_chosen] :
       {std::pair("gain", thrusters.gain != defaults.gain),
        std::pair("dead_band", thrusters.dead_band != defaults.dead_band)}) {
    if (!is_chosen || thrusters.torque > 0) continue;
    fields.context().add(
        fields.line_of(key), "not-used",
        fmt::format("{}: there are no thrusters without torque", fields.path_of(key)));
  }
  fields.finish();
}

}  // namespace

void read_post_impact_section(MapReader& map, CaptureProblem& problem) {
  MapReader fields = section(map, "post_impact");
  ReadContext& context = map.context();
  PostImpactSpec& spec = problem.post_impact;
  const Node* list = fields.child("controllers");
  if (list != nullptr && list->kind != Node::Kind::Sequence) {
    context.add(list->line, "wrong-type",
                fmt::format("{}: must be a list of names", fields.path_of("controllers")));
  } else if (list != nullptr) {
    for (std::size_t i = 0; i < list->items.size(); ++i) {
      const std::string path = fmt::format("{}[{}]", fields.path_of("controllers"), i);
      const auto name = read_text(context, list->items[i], path);
      if (!name || !check_name(context, list->items[i].line, path, *name, controller_names(),
                               "controllers")) {
        continue;
      }
      if (std::find(spec.controllers.begin(), spec.controllers.end(), *name) !=
          spec.controllers.end()) {
        context.add(list->items[i].line, "duplicate-name",
                    fmt::format("{}: '{}' is already named", path, *name));
      }
      spec.controllers.push_back(*name);
    }
  }
  fields.number("base_rate_gain", spec.K_omega, Dimension::Rate, kNonNegative);
  fields.number("joint_rate_gain", spec.K_phi, Dimension::Rate, kNonNegative);
  // Bounds that keep a simulation within minutes.
  fields.number("control_period", spec.control_period, Dimension::Time,
                {.lower = 1e-4, .upper = 10});
  fields.number("horizon", spec.horizon, Dimension::Time, {.lower = 1e-3, .upper = 3600});
  fields.flag("joint_friction", spec.joint_friction);
  fields.number("stop_restitution", spec.stop_restitution, Dimension::None,
                {.lower = 0, .upper = 0.99});
  fields.number("wheel_torque", spec.wheel_torque, Dimension::Moment, kNonNegative);
  fields.number("wheel_momentum", spec.wheel_momentum, Dimension::AngularImpulse, kNonNegative);
  fields.number("handback_start", spec.handback_start, Dimension::Time, kNonNegative);
  fields.number("handback_gain", spec.handback_gain, Dimension::Rate, kNonNegative);
  read_contact(fields, spec.contact);
  read_sensor(fields, spec);
  read_model(fields, spec.contact.model, spec.model);
  read_thrusters(fields, spec.thrusters);
  const Need need = spec.controllers.empty() ? Need::Optional : Need::Required;
  fields.number("residual_base_rate_max", spec.residual_base_rate_max, Dimension::AngularVelocity,
                kNonNegative, need);
  fields.number("attitude_change_max", spec.attitude_change_max, Dimension::Angle, kNonNegative,
                need);
  fields.finish();
}

}  // namespace stillbase::io
