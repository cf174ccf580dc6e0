// The section `post_impact`.
#include <cmath>

#include <fmt/format.h>

#include <stillbase/simulation/controllers.hpp>

#include "io/defaults.hpp"
#include "io/fields/sections.hpp"

namespace stillbase::io {

namespace {

// The normalised copy states every field, used or not. So a field that has no effect is refused
// where its value is not the default: a value that was chosen says something.

void contact_fields(Table& t, ContactSpec& contact) {
  t("model", Word(contact.model, kContactModelNames),
    "`instantaneous` (the impact as planned) or `compliant` (spring-damper and Coulomb friction, "
    "finite duration, both bodies moving; needs `impact.contact: normal`, `rigid_body` and no "
    "`locked` joints)",
    {.need = Need::Required, .without = "`instantaneous`", .decides = true});
  // A contact must be resolved in time: half a period of 1 kg on 1e9 N/m is 0.1 ms.
  t("stiffness", Number(contact.stiffness, Dimension::LinearStiffness, {.lower = 1, .upper = 1e9}),
    "`compliant`");
  t("damping",
    Either({Instead("from_restitution", !contact.damping),
            Number(contact.damping, Dimension::LinearDamping, kLarge)}),
    "`compliant`; `from_restitution`: that which leaves `impact.restitution`, at least 0.001");
  t("friction", Number(contact.friction, {.lower = 0, .upper = 10}),
    "`compliant`: Coulomb coefficient");
  const ContactSpec defaults;
  const bool is_chosen = contact.stiffness != defaults.stiffness || contact.damping ||
                         contact.friction != defaults.friction;
  MapReader* map = t.reader();
  if (map == nullptr || contact.model == ContactModel::Compliant || !is_chosen) return;
  map->context().add(
      map->line(), "not-used",
      map->path() + ": stiffness, damping and friction are those of a compliant contact");
}

void sensor_fields(Table& t, SensorSpec& sensor, double control_period) {
  const Range error{.lower = 0, .upper = 1};  // more is no measurement
  t("base_rate_error", Number(sensor.base_rate_error, Dimension::AngularVelocity, error),
    "standard deviation per axis");
  t("joint_position_error", Number(sensor.joint_position_error, Dimension::JointPosition, error),
    "standard deviation");
  t("joint_rate_error", Number(sensor.joint_rate_error, Dimension::AngularVelocity, error),
    "standard deviation, in m/s of prismatic joints");
  t("delay", Number(sensor.delay, Dimension::Time, {.lower = 0, .upper = 10}),
    "a whole number of control periods");
  t("seed", Seed(sensor.seed), "same seed, same errors");
  const double periods = sensor.delay / control_period;
  if (t.reader() == nullptr || std::abs(periods - std::round(periods)) <= 1e-6) return;
  t.reader()->refuse("delay", "out-of-range",
                     fmt::format("is {} s; must be a whole number of control periods of {} s",
                                 sensor.delay, control_period));
}

void model_fields(Table& t, ControllerModelSpec& model) {
  const Range scale{.lower = 0.01, .upper = 100}, part{.lower = 0, .upper = 100};
  t("base_mass_scale", Number(model.base_mass_scale, scale),
    "factor on mass and inertia of the base");
  t("arm_mass_scale", Number(model.arm_mass_scale, scale), "factor on those of the arm's bodies");
  t("target_mass_scale", Number(model.target_mass_scale, part),
    "after a latch: factor on those of the target; 0: the controllers do not know of it");
  t("friction_scale", Number(model.friction_scale, part),
    "part of the robot file's joint friction that the controllers compensate");
}

/// Words that were contacts of the simulation once: why they are no more, with what to write.
std::string moved_contact(MapReader& map) {
  const Node* contact = map.find("contact");
  const Node* word = contact == nullptr || is_scalar(*contact) ? contact : contact->find("model");
  if (word == nullptr || !is_scalar(*word)) return "";
  if (word->text == "latch") {
    return "'latch' moved to impact.contact, where search and simulation both use it; state it "
           "there, and leave this one out";
  }
  return word->text == "jump" ? "'jump' is called 'instantaneous'" : "";
}

void thruster_fields(Table& t, ThrusterSpec& thrusters) {
  t("torque", Number(thrusters.torque, Dimension::Moment, {.lower = 0, .upper = 1e6}),
    "largest moment per axis; 0: there are none");
  t("gain", Number(thrusters.gain, Dimension::Rate, kGain), "gain of the angular velocity");
  t("dead_band", Number(thrusters.dead_band, Dimension::AngularVelocity, kSpinSize),
    "off below this base rate");
  if (t.reader() == nullptr || thrusters.torque > 0) return;
  const ThrusterSpec defaults;
  for (const auto& [key, is_chosen] :
       {std::pair("gain", thrusters.gain != defaults.gain),
        std::pair("dead_band", thrusters.dead_band != defaults.dead_band)}) {
    if (is_chosen) t.reader()->refuse(key, "not-used", "there are no thrusters without torque");
  }
}

void wheel_fields(Table& t, WheelSpec& wheels) {
  t("torque", Deviation(wheels.torque, Dimension::Moment, kLarge),
    "largest one per axis of B, three numbers or one for all; 0: there is no wheel", kNeeded);
  t("capacity", Deviation(wheels.momentum, Dimension::AngularImpulse, kLarge),
    "momentum that they can hold, per axis");
  t("preset", Vector(wheels.preset, Dimension::AngularImpulse, kLargeVector),
    "momentum that they hold before the approach and the contact, e.g. half of what is to come, "
    "with "
    "the other sign: put in by torques from outside (thrusters, magnetic torquers) on the robot at "
    "rest, whose total momentum it is then",
    {.frame = "B"});
  MapReader* map = t.reader();
  if (map == nullptr || !map->context().findings.empty()) return;
  if (!wheels.exist()) {
    map->refuse("torque", "out-of-range", "is zero on every axis; leave `wheels` out");
  }
  constexpr const char* kAxes[] = {"x", "y", "z"};
  for (int i = 0; i < 3; ++i) {
    const double preset = std::abs(wheels.preset[i]);
    if (preset > 0 && !(wheels.torque[i] > 0)) {
      map->refuse(
          "preset", "contradiction",
          fmt::format("is {} N m s about {}, where no wheel is", wheels.preset[i], kAxes[i]));
    } else if (wheels.torque[i] > 0 && !(wheels.momentum[i] > 0)) {
      map->refuse("capacity", "out-of-range",
                  fmt::format("is zero about {}, where a wheel is; must be positive, or state "
                              "torque 0 about this axis",
                              kAxes[i]));
    } else if (preset > wheels.momentum[i]) {
      map->refuse("preset", "out-of-range",
                  fmt::format("is {} N m s about {}, above the capacity of {} N m s",
                              wheels.preset[i], kAxes[i], wheels.momentum[i]));
    }
  }
}

void grip_fields(Table& t, GripSpec& grip) {
  const auto limit = [](std::optional<double>& x, Dimension dimension) {
    return WrittenIf(Number(x, dimension, kLargePositive), x.has_value());
  };
  t("force", limit(grip.force, Dimension::Force), "largest one through the hand",
    {.without = "any"});
  t("moment", limit(grip.moment, Dimension::Moment), "largest one about the hand's origin",
    {.without = "any"});
}

/// Wheels that are alike have two keys of their own, other ones a map.
void wheels_of(Table& t, WheelSpec& wheels) {
  const bool are_alike = wheels.are_alike();
  t.not_both("wheel_torque", "wheels");
  t.not_both("wheel_momentum", "wheels");
  double torque = wheels.torque.x(), momentum = wheels.momentum.x();
  t("wheel_torque", WrittenIf(Number(torque, Dimension::Moment, kLarge), are_alike),
    "of the base's reaction wheels, per axis of B; 0: there are none");
  t("wheel_momentum", WrittenIf(Number(momentum, Dimension::AngularImpulse, kLarge), are_alike),
    "that they can hold, per axis");
  if (t.reader() != nullptr) {
    wheels.torque.setConstant(torque);
    wheels.momentum.setConstant(momentum);
    if (torque > 0 && !(momentum > 0)) {
      t.reader()->refuse("wheel_momentum", "out-of-range",
                         "is zero, so that the wheels take nothing; must be positive, or leave "
                         "`wheel_torque` out");
    }
  }
  t("wheels", WrittenIf(Map([&](Table& m) { wheel_fields(m, wheels); }), !are_alike),
    "the same in full, in place of `wheel_torque` and `wheel_momentum`", {.without = "those two"});
}

}  // namespace

void post_impact_fields(Table& t, PostImpactSpec& spec) {
  t("controllers",
    List(spec.controllers,
         [](std::string& name) { return Text(name, controller_names(), "controllers"); },
         {.is_unique = true, .of = "names"}),
    "simulated after the impact; the first is the plan's choice and has to keep the two limits: "
    "`none`, `joint_damping`, `joint_damping_literal`, `rns`, `rns_damped`, `rns_handback`, "
    "`detumble`");
  t("base_rate_gain", Number(spec.K_omega, Dimension::Rate, kGain), "K_omega");
  t("joint_rate_gain", Number(spec.K_phi, Dimension::Rate, kGain), "K_phi");
  // Bounds that keep a simulation within minutes.
  t("control_period", Number(spec.control_period, Dimension::Time, {.lower = 1e-4, .upper = 10}),
    "between two commands of the controllers");
  t("horizon", Number(spec.horizon, Dimension::Time, {.lower = 1e-3, .upper = 3600}),
    "simulated time after the impact");
  t("joint_friction", Flag(spec.joint_friction),
    "the joints have the robot file's viscous and Coulomb friction (stick-slip); "
    "`model.friction_scale` says what the controllers know of it");
  t("stop_restitution", Number(spec.stop_restitution, {.lower = 0, .upper = 0.99}),
    "part of its rate that a joint keeps, reversed, at its stop");
  wheels_of(t, spec.wheels);
  t("grip", WrittenIf(Map([&](Table& m) { grip_fields(m, spec.grip); }), spec.grip.is_limited()),
    "what the grip of a latched target bears: the wrench is the rate of its momentum; `detumble` "
    "keeps it",
    {.without = "any load"});
  const Node* const grip = t.reader() == nullptr ? nullptr : t.reader()->find("grip");
  if (grip != nullptr && grip->kind == Node::Kind::Map && grip->find("force") == nullptr &&
      grip->find("moment") == nullptr) {
    t.reader()->refuse("grip", "missing-key",
                       "must state force, moment or both; leave it out where any load is borne");
  }
  t("handback_start", Number(spec.handback_start, Dimension::Time, kWait),
    "`rns_handback`: after the impact; `rns_damped` until then");
  t("handback_gain", Number(spec.handback_gain, Dimension::Rate, kGain),
    "`rns_handback`: the wheels take this part of the momentum per second, as far as they can");
  const std::string moved = t.reader() == nullptr ? "" : moved_contact(*t.reader());
  if (moved.empty()) {
    t("contact", Map([&](Table& m) { contact_fields(m, spec.contact); }, {.alone = "model"}),
      "how the simulations of `verify` and `simulate` resolve the contact: a model alone, or a "
      "map");
  } else {
    t.reader()->child("contact");
    t.reader()->refuse("contact", "moved", moved);
  }
  t("sensor", Map([&](Table& m) { sensor_fields(m, spec.sensor, spec.control_period); }),
    "errors of the controllers' measurements, independent and normal at every control instant");
  t("model", Map([&](Table& m) { model_fields(m, spec.model); }),
    "the controllers' model where it differs from the robot");
  t("thrusters", Map([&](Table& m) { thruster_fields(m, spec.thrusters); }),
    "attitude thrusters of the base: the moment -gain H~omega omega, each axis of B cut at "
    "`torque`");
  if (t.reader() != nullptr && !spec.controllers.empty()) {
    spec.residual_base_rate_max = kDefaultBaseRate;
    spec.attitude_change_max = kDefaultAttitudeChange;
  }
  const auto otherwise = [](double value, const char* unit) {
    return About{.without = fmt::format("{:.6g} {} with controllers", value * 180 / kPi, unit)};
  };
  t("residual_base_rate_max",
    Number(spec.residual_base_rate_max, Dimension::AngularVelocity, kLarge),
    "base rate at the horizon", otherwise(kDefaultBaseRate, "deg/s"));
  t("attitude_change_max", Number(spec.attitude_change_max, Dimension::Angle, kLarge),
    "attitude change over the horizon", otherwise(kDefaultAttitudeChange, "deg"));
}

}  // namespace stillbase::io
