#include "io/problem_reader.hpp"

#include <cmath>
#include <filesystem>

#include <fmt/format.h>

#include <stillbase/core/constants.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/encounter/direction_cone.hpp>
#include <stillbase/robot/urdf_reader.hpp>
#include <stillbase/simulation/contact.hpp>

#include "io/target_reader.hpp"
#include "io/wedge_check.hpp"

namespace stillbase::io {

namespace {

/// Text of a file that the problem names; a missing one is a finding at the line that names it.
std::optional<std::string> read_named_file(MapReader& map, const std::string& key,
                                           const std::string& name, const ProblemSources& sources,
                                           std::string& full_path) {
  if (!sources.folder) {
    map.context().add(map.line_of(key), "not-used",
                      fmt::format("{}: '{}' cannot be read from here; state its content in place",
                                  map.path_of(key), name));
    return std::nullopt;
  }
  full_path = (std::filesystem::path(*sources.folder) / name).string();
  try {
    return read_text_file(full_path, DocumentLimits{}.bytes);
  } catch (const InputError& error) {
    for (const Finding& finding : error.findings()) {
      map.context().add(map.line_of(key), finding.rule,
                        fmt::format("{}: {}: {}", map.path_of(key), full_path, finding.message));
    }
  }
  return std::nullopt;
}

void read_contacts(MapReader& map, CaptureProblem& problem) {
  const Node* list = map.child("allowed_contacts");
  if (list == nullptr) return;
  ReadContext& context = map.context();
  const std::string path = map.path_of("allowed_contacts");
  const auto refuse = [&](const Node& node, const std::string& where) {
    context.add(node.line, "wrong-type", fmt::format("{}: must be a list of [link, link]", where));
  };
  if (list->kind != Node::Kind::Sequence) return refuse(*list, path);
  for (std::size_t i = 0; i < list->items.size(); ++i) {
    const Node& pair = list->items[i];
    const std::string pair_path = fmt::format("{}[{}]", path, i);
    if (pair.kind != Node::Kind::Sequence || pair.items.size() != 2) {
      refuse(pair, pair_path);
      continue;
    }
    const auto a = read_text(context, pair.items[0], pair_path);
    const auto b = read_text(context, pair.items[1], pair_path);
    if (!a || !b || problem.robot.links.empty()) continue;
    const std::vector<std::string> links = link_names(problem.robot);
    const bool are_known = check_name(context, pair.line, pair_path, *a, links, "links") &&
                           check_name(context, pair.line, pair_path, *b, links, "links");
    if (are_known && *a == *b) {
      context.add(pair.line, "duplicate-name",
                  fmt::format("{}: a link cannot touch itself", pair_path));
    }
    problem.allowed_contacts.emplace_back(*a, *b);
  }
}

void check_start(MapReader& map, const CaptureProblem& problem) {
  if (problem.start.size() != problem.robot.n()) return;
  for (int k = 0; k < problem.robot.n(); ++k) {
    const Joint& joint = problem.robot.joints[k];
    if (problem.start[k] >= joint.lower && problem.start[k] <= joint.upper) continue;
    map.context().add(map.line_of("start"), "outside-limits",
                      fmt::format("{}.{}: {} {} is outside the joint's limits [{}, {}]",
                                  map.path_of("start"), joint.name, problem.start[k],
                                  joint.is_prismatic() ? "m" : "rad", joint.lower, joint.upper));
  }
}

void read_robot_section(MapReader& problem_map, CaptureProblem& problem,
                        const ProblemSources& sources) {
  ReadContext& context = problem_map.context();
  const Node* node = problem_map.child("robot", Need::Required);
  if (node == nullptr) return;
  MapReader map(context, *node, problem_map.path_of("robot"));
  std::string hand;
  const bool names_file = map.text("file", problem.urdf_path, Need::Required);
  map.text("hand", hand);
  std::string full_path = problem.urdf_path;
  std::optional<std::string> text = sources.urdf;
  if (!text && names_file) {
    text = read_named_file(map, "file", problem.urdf_path, sources, full_path);
  }
  if (text) {
    problem.urdf = std::move(*text);
    try {
      problem.robot = read_urdf(problem.urdf, full_path, hand);
    } catch (const InputError& error) {
      for (Finding finding : error.findings()) {
        // The hand is named here, not in the robot file.
        if (finding.rule.rfind("hand-", 0) == 0) {
          finding.file = context.source;
          finding.line = map.line_of("hand");
          finding.message = map.path_of("hand") + ": " + finding.message;
        }
        context.findings.push_back(std::move(finding));
      }
    }
  }
  read_joint_values(map, "start", problem.robot, Dimension::Angle, Dimension::Length, kAny, false,
                    Need::Required, problem.start);
  check_start(map, problem);
  if (const Node* base = map.child("base")) {
    MapReader fields(context, *base, map.path_of("base"));
    fields.pose(problem.base);
    fields.finish();
  }
  read_contacts(map, problem);
  map.finish();
}

void read_target_section(MapReader& problem_map, CaptureProblem& problem,
                         const ProblemSources& sources) {
  ReadContext& context = problem_map.context();
  const Node* node = problem_map.child("target");
  if (node == nullptr) return;
  MapReader map(context, *node, problem_map.path_of("target"));
  std::string file;
  if (map.text("file", file)) {
    std::string full_path;
    if (const auto text = read_named_file(map, "file", file, sources, full_path)) {
      ReadContext own{full_path, {}, {}};
      try {
        problem.target = read_target_file(parse_document(*text, own), own);
      } catch (const InputError&) {  // its findings are in `own`
      }
      context.findings.insert(context.findings.end(), own.findings.begin(), own.findings.end());
    }
  } else if (!map.has("file")) {
    problem.target = read_target_body(map);
  }
  if (const Node* state = map.child("state")) {
    problem.target_state =
        read_target_state(context, *state, map.path_of("state"), problem.target_deviations);
  }
  map.finish();
}

}  // namespace

void check_problem(MapReader& map, const CaptureProblem& problem) {
  ReadContext& context = map.context();
  const ImpulseSpec& impulse = problem.impulse;
  const bool has_feature = problem.target && !problem.variables.feature.empty();
  const auto refuse = [&](const char* section, const char* rule, const std::string& message) {
    context.add(map.line_of(section), rule, fmt::format("{}.{}", map.path_of(section), message));
  };

  if (!impulse.direction && !has_feature) {
    refuse("impact", "missing-key",
           "direction: must be stated when there is no target with a contact feature");
  }
  if (impulse.source == ImpulseSource::PointMass && !problem.target) {
    refuse("impact", "missing-key", "source: 'point_mass' needs the section 'target' for the mass");
  }
  if (impulse.source == ImpulseSource::RigidBody &&
      (!has_feature || problem.target->is_point_mass)) {
    refuse("impact", "missing-key",
           "source: 'rigid_body' needs a target that is a rigid body with a contact feature");
  }
  if (impulse.source == ImpulseSource::RigidBody && impulse.direction) {
    refuse("impact", "not-used",
           "direction: 'rigid_body' takes it from the contact feature; leave it out");
  }
  if (impulse.source != ImpulseSource::Given && !impulse.moment.isZero(0)) {
    refuse("impact", "not-used", "moment: only a given impulse has a moment");
  }
  if (impulse.source == ImpulseSource::PointMass && impulse.direction &&
      !(impulse.closing_speed >= problem.constraints.closing_speed_min)) {
    refuse("impact", "out-of-range",
           fmt::format("closing_speed: is {} m/s; a point mass from a stated direction needs at "
                       "least closing_speed_min = {} m/s",
                       impulse.closing_speed, problem.constraints.closing_speed_min));
  }
  if (!impulse.direction && impulse.closing_speed != 0) {
    refuse("impact", "not-used",
           "closing_speed: is stated only beside a direction; here the motion of the target "
           "decides");
  }
  const Node* target = map.child("target");
  const bool states_motion = target != nullptr && MapReader(context, *target, "").has("state");
  if (impulse.direction && states_motion) {
    refuse("target", "not-used",
           "state: with impact.direction stated the target comes along it at closing_speed; leave "
           "one of them out");
  }
  if (!impulse.direction && problem.target && !states_motion) {
    refuse("target", "missing-key",
           "state: must be stated when impact.direction is not, or nothing says how it moves");
  }

  const HandSpec& hand = problem.hand;
  if (hand.constraint == HandConstraint::Position && !hand.position && impulse.direction) {
    refuse("hand", "missing-key",
           "position: must be stated beside impact.direction; the target comes to the hand then");
  }
  const VariableSpec& variables = problem.variables;
  const bool is_placed =
      hand.constraint != HandConstraint::None || variables.base_position != PositionFreedom::Fixed;
  if (hand.position && !impulse.direction) {
    refuse("hand", "not-used",
           "position: the hand meets the contact feature, wherever that is; a place of its own "
           "belongs to a stated impact.direction");
  } else if (hand.position && !is_placed) {
    refuse("hand", "not-used",
           "position: without a constraint on the hand it takes a free base_position to get there");
  } else if (hand.position && hand.frame == Frame::Base &&
             variables.base_position != PositionFreedom::Fixed) {
    refuse("variables", "not-used",
           "base_position: nothing depends on it while the hand's position is stated in the base");
  }
  if (!hand.position && !impulse.direction && has_feature && !is_placed) {
    refuse("hand", "missing-key",
           "constraint: with the base_position fixed nothing brings the hand to the contact "
           "feature; state 'position', 'axis' or 'pose', or free the base_position");
  }
  if (impulse.direction && variables.contact_time_upper > variables.contact_time_lower) {
    refuse("variables", "not-used",
           "contact_time: beside a stated impact.direction the target comes along it at any time; "
           "state an instant");
  }
  if (hand.orientation && hand.constraint != HandConstraint::Pose) {
    refuse("hand", "not-used", "orientation: only the constraint 'pose' uses it");
  }

  if (problem.uncertainty.cone_confidence && !problem.variables.features.empty()) {
    refuse("uncertainty", "not-supported",
           "cone_half_angle: 'from_covariance' belongs to one contact feature; state the angle "
           "beside a choice of features");
  } else if (problem.uncertainty.cone_confidence && (impulse.direction || !has_feature)) {
    refuse("uncertainty", "missing-key",
           "cone_half_angle: 'from_covariance' needs a direction that follows from the contact "
           "feature of a target");
  } else if (problem.uncertainty.cone_confidence && !problem.target_deviations) {
    refuse("uncertainty", "missing-key",
           "cone_half_angle: 'from_covariance' needs target.state.covariance");
  }
  if (problem.target && problem.target->is_point_mass && problem.target_deviations &&
      !problem.target_deviations->moments.isZero(0)) {
    refuse("target", "not-used", "state.covariance.moments: a point mass has none");
  }

  const ContactModel contact = problem.post_impact.contact.model;
  if (contact != ContactModel::Jump &&
      (!problem.target || impulse.source == ImpulseSource::Given)) {
    refuse("post_impact", "missing-key",
           "contact: this model needs a target and a contact law, impact.source point_mass or "
           "rigid_body");
  }
  if (contact == ContactModel::Latch &&
      (impulse.source != ImpulseSource::RigidBody || impulse.restitution != 0)) {
    refuse("post_impact", "contradiction",
           "contact: a latch closes as it touches; it needs impact.source rigid_body with "
           "restitution 0, whose impulse is then the latch's along the normal");
  }
  if (contact == ContactModel::Compliant && impulse.source == ImpulseSource::PointMass) {
    refuse("post_impact", "not-supported",
           "contact: a compliant contact needs a rigid body; a point mass that slides along the "
           "hand would have to take a moment");
  }
  if (contact == ContactModel::Compliant && problem.resistance.model == ResistanceModel::Locked) {
    refuse("post_impact", "not-supported",
           "contact: a compliant contact takes time, in which locked joints mean nothing; use "
           "joint_resistance servo");
  }
  if (contact == ContactModel::Compliant && !problem.post_impact.contact.damping &&
      !(impulse.restitution >= kLeastRestitution)) {
    refuse("post_impact", "out-of-range",
           fmt::format("contact: a spring-damper always leaves a little: impact.restitution must "
                       "be at least {}, or damping stated",
                       kLeastRestitution));
  }

  const auto& plane = problem.uncertainty.cone_plane_normal;
  if (plane && impulse.direction && impulse.direction_frame == Frame::Base &&
      !(std::abs(plane->dot(*impulse.direction)) <= 1e-9)) {
    refuse("uncertainty", "out-of-range",
           "cone_plane: the direction of the impulse does not lie in this plane");
  }
  const UncertaintySpec& spread = problem.uncertainty;
  if (impulse.restitution - spread.restitution < 0 ||
      impulse.restitution + spread.restitution > 1) {
    refuse("uncertainty", "out-of-range",
           fmt::format("restitution: {} about impact.restitution {} leaves [0, 1]",
                       spread.restitution, impulse.restitution));
  }
}

namespace {

/// Puts the half-angle in place that follows from the covariance of the estimate.
void resolve_cone(MapReader& map, CaptureProblem& problem) {
  UncertaintySpec& uncertainty = problem.uncertainty;
  if (!uncertainty.cone_confidence) return;
  const auto refuse = [&](const std::string& what) {
    map.context().add(map.line_of("uncertainty"), "out-of-range",
                      fmt::format("{}.cone_half_angle: {}", map.path_of("uncertainty"), what));
  };
  try {
    uncertainty.cone_half_angle = direction_cone(problem, *uncertainty.cone_confidence).half_angle;
  } catch (const std::invalid_argument& error) {
    return refuse(error.what());
  }
  if (!(uncertainty.cone_half_angle <= kPi / 2)) {
    refuse(
        fmt::format("the covariance gives {:.4g} rad; must be at most pi/2, or the target may "
                    "come from anywhere",
                    uncertainty.cone_half_angle));
  }
}

}  // namespace

CaptureProblem read_problem_map(const Node& node, ReadContext& context, const std::string& path,
                                const ProblemSources& sources) {
  MapReader map(context, node, path);
  CaptureProblem problem;
  if (node.kind != Node::Kind::Map) return problem;  // said above; what is missing follows from it
  problem.source = context.source;
  problem.name = std::filesystem::path(context.source).stem().string();
  read_format(map, "stillbase.problem");
  map.text("name", problem.name);
  map.text("purpose", problem.purpose, Need::Required);
  read_robot_section(map, problem, sources);
  read_target_section(map, problem, sources);
  read_impact_section(map, problem);
  read_variables_section(map, problem);
  read_objective_section(map, problem);
  read_hand_section(map, problem);
  read_constraints_section(map, problem);
  read_uncertainty_section(map, problem);
  read_search_section(map, problem);
  read_approach_section(map, problem);
  read_post_impact_section(map, problem);
  read_obstacles_section(map, problem);
  map.finish();
  // Contradictions between sections mean something only when the sections are good.
  if (!context.findings.empty()) return problem;
  check_problem(map, problem);
  if (context.findings.empty()) check_wedge(map, problem);
  if (context.findings.empty()) resolve_cone(map, problem);
  const bool cone_known = !problem.uncertainty.cone_confidence || context.findings.empty();
  if (cone_known) check_objective(map, problem);
  return problem;
}

}  // namespace stillbase::io
