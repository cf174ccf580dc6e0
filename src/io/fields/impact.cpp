// The section `impact`.
#include <cmath>

#include <fmt/format.h>

#include "io/fields/sections.hpp"

namespace stillbase::io {

namespace {

/// The rotor of a joint belongs to the robot or to the resistance, not to both.
void refuse_second_rotors(MapReader& map, const CaptureProblem& problem) {
  const JointVectord& stated = problem.resistance.rotor_inertia;
  if (problem.resistance.model != ResistanceModel::RotorInertia ||
      stated.size() != problem.robot.n()) {
    return;
  }
  for (int k = 0; k < problem.robot.n(); ++k) {
    const Joint& joint = problem.robot.joints[k];
    const double reflected = joint.reflected_inertia();
    if (!(stated[k] > 0) || !(reflected > 0)) continue;
    map.refuse(
        "joint_resistance", "stated-twice",
        fmt::format("rotor_inertia.{}: the joint has a drive of {:.4g} {} already (robot.rotors "
                    "or the robot file); state 0 here",
                    joint.name, reflected, joint.is_prismatic() ? "kg" : "kg m^2"));
  }
}

}  // namespace

void resistance_values(Table& t, JointResistance& resistance, const RobotModel& robot) {
  switch (resistance.model) {
    case ResistanceModel::Free:
      break;
    case ResistanceModel::RotorInertia:
      t("rotor_inertia", JointValues(resistance.rotor_inertia, robot, kJointInertia, kLarge),
        "`rotor_inertia`: of the rotors behind the gears; stays in the plant afterwards", kNeeded);
      break;
    case ResistanceModel::Servo:
      t("stiffness", JointValues(resistance.stiffness, robot, kJointStiffness, kLarge),
        "`servo`: torque per angle", kNeeded);
      t("damping", JointValues(resistance.damping, robot, kJointDamping, kLarge),
        "`servo`: torque per rate", kNeeded);
      t("contact_duration", Number(resistance.contact_duration, Dimension::Time, kDuration),
        "`servo`: how long the contact lasts", kNeeded);
      break;
    case ResistanceModel::Locked:
      t("locked", JointFlags(resistance.locked, robot),
        "`locked`: `all`, `none` or a list of joints", kNeeded);
      break;
  }
}

Map resistance_of(JointResistance& resistance, const RobotModel& robot) {
  return Map(
      [&](Table& t) {
        t("model", Word(resistance.model, resistance_names()),
          "`free`, `rotor_inertia`, `servo`, `locked`", {.need = Need::Required, .decides = true});
        resistance_values(t, resistance, robot);
      },
      {.alone = "model"});
}

void impact_fields(Table& t, CaptureProblem& problem) {
  ImpulseSpec& impulse = problem.impulse;
  t("source", Word(impulse.source, kImpulseSourceNames),
    "`given` (direction and magnitude), `point_mass` or `rigid_body` (contact laws; `rigid_body` "
    "needs a feature)",
    kNeeded);
  t("contact", Word(impulse.contact, kContactLawNames),
    "what the contact makes of the relative velocity of hand and target: `normal` (impulse along "
    "the direction, with `restitution`), `sticking` (no slip, no moment) or `latch` (all six "
    "relative velocities vanish and the target stays attached; needs `rigid_body`)");
  double angle = 0;
  t("direction",
    Either({Instead("feature", !impulse.direction),
            Shorthand(Map(
                          [&angle](Table& planar) {
                            planar("angle", Number(angle, Dimension::Angle, kAngle), "", kNeeded);
                          },
                          {.name = "planar_direction"}),
                      [&] { impulse.direction = Vector3d(std::cos(angle), std::sin(angle), 0); }),
            Vector(impulse.direction, VectorKind::Direction)}),
    "of the impulse on the hand: a vector, `{angle}` from x about z, or `feature` (the nominal "
    "normal of the contact feature). When it is stated, the target comes along it to wherever the "
    "hand is, without rotation",
    {.frame = "`frame`", .without = "`feature`"});
  t("frame", Word(impulse.direction_frame, kFrameNames),
    "of direction and moment: `base` or `inertial`");
  t("magnitude", Number(impulse.magnitude, Dimension::Impulse, kLargePositive),
    "`given`: size of the impulse");
  t("moment", Vector(impulse.moment, Dimension::AngularImpulse, kLargeVector),
    "`given`: moment impulse", {.frame = "`frame`"});
  t("closing_speed", Number(impulse.closing_speed, Dimension::Velocity, kSpeed),
    "beside a stated direction: speed along it");
  t("restitution", Number(impulse.restitution, {.lower = 0, .upper = 1}),
    "coefficient of the `normal` contact");
  t("joint_resistance", resistance_of(problem.resistance, problem.robot),
    "how joints resist during the impact: `free` or a map", {.without = "`free`"});
  if (t.reader() != nullptr) refuse_second_rotors(*t.reader(), problem);
}

void contact_fields(Table& t, CaptureProblem& problem) {
  HandMotionSpec& hand = problem.hand_motion;
  const auto velocity = [&hand](const char* word, HandVelocity value) {
    return Instead(word, hand.velocity == value, [&hand, value] { hand.velocity = value; });
  };
  t("hand_velocity",
    Either({velocity("rest", HandVelocity::Rest),
            velocity("match_normal", HandVelocity::MatchNormal),
            velocity("match_linear", HandVelocity::MatchLinear),
            velocity("match_all", HandVelocity::MatchAll),
            Map(
                [&hand](Table& m) {
                  m("linear", Vector(hand.linear, Dimension::Velocity, kVelocity),
                    "of the target's point", {.frame = "target"});
                  m("angular", Vector(hand.angular, Dimension::AngularVelocity, kSpin),
                    "of the target", {.frame = "target"});
                  if (m.reader() != nullptr) hand.velocity = HandVelocity::Stated;
                },
                {.is_written = hand.velocity == HandVelocity::Stated})}),
    "of the hand right before a `latch`: `rest` (it waits), `match_normal` (with the target's "
    "point along the normal), `match_linear` (with the point), `match_all` (with the point and the "
    "target's rotation), or what the target's velocity is to be as the hand sees it, also before a "
    "`sticking` contact; the base floats without momentum. Then the objective is that of the "
    "motion right after the contact",
    {.without = "`rest`"});
  t("arrival_rates", Word(hand.rates, kArrivalRatesNames),
    "among the joint rates that move the hand so: `least_joint_rate`, or `least_base_rate` (the "
    "least angular velocity of the base, joint rates counting a hundredth)");
}

}  // namespace stillbase::io
