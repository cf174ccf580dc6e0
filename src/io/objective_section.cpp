// The section `objective` of a problem, and what it asks of the other sections.
#include <algorithm>

#include <fmt/format.h>

#include "io/problem_reader.hpp"

namespace stillbase::io {

namespace {

Dimension dimension_of(ObjectiveQuantity quantity) {
  switch (quantity) {
    case ObjectiveQuantity::BaseAngularMomentum:
    case ObjectiveQuantity::TotalAngularMomentum:
      return Dimension::AngularImpulse;
    case ObjectiveQuantity::BaseMomentum:
    case ObjectiveQuantity::ImpulseMagnitude:
      return Dimension::Impulse;
    case ObjectiveQuantity::BaseAngularVelocity:
    case ObjectiveQuantity::JointRateNorm:
      return Dimension::AngularVelocity;
    case ObjectiveQuantity::AttitudeTurned:
      return Dimension::Angle;
  }
  return Dimension::None;
}

/// A key that is stated beside something that takes no notice of it.
void refuse_unless(bool is_used, MapReader& fields, const char* key, const char* owners) {
  if (is_used || !fields.has(key)) return;
  fields.context().add(fields.line_of(key), "not-used",
                       fmt::format("{}: belongs to {}", fields.path_of(key), owners));
}

/// When the turn is looked at: needed by that quantity, of no use to the others.
void read_after(MapReader& fields, ObjectiveTerm& term) {
  const bool turns = term.quantity == ObjectiveQuantity::AttitudeTurned;
  constexpr double kShortest = 1e-3;  // s: before, the base has turned by its rate times the time
  constexpr double kLongest = 3600;   // s
  fields.number("after", term.after, Dimension::Time, {.lower = kShortest, .upper = kLongest},
                turns ? Need::Required : Need::Optional);
  refuse_unless(turns, fields, "after", "attitude_turned");
}

void read_objective_terms(MapReader& objective, const Node& list, CaptureProblem& problem) {
  ReadContext& context = objective.context();
  const std::string path = objective.path_of("terms");
  if (list.kind != Node::Kind::Sequence || list.items.empty()) {
    context.add(list.line, "wrong-type",
                fmt::format("{}: must be a list of {{quantity: , size: }}", path));
    return;
  }
  problem.objective.clear();
  for (std::size_t i = 0; i < list.items.size(); ++i) {
    MapReader fields(context, list.items[i], fmt::format("{}[{}]", path, i));
    ObjectiveTerm term;
    const bool is_known =
        fields.choice("quantity", term.quantity, objective_names(), Need::Required);
    fields.number("size", term.size, dimension_of(term.quantity), kSensible, Need::Required);
    fields.number("length", term.length, Dimension::Length, kSensible);
    refuse_unless(!is_known || term.quantity == ObjectiveQuantity::BaseMomentum, fields, "length",
                  "base_momentum");
    read_after(fields, term);
    fields.finish();
    for (const ObjectiveTerm& other : problem.objective) {
      if (other.quantity != term.quantity) continue;
      context.add(list.items[i].line, "duplicate-name",
                  fmt::format("{}: there is already a term of this quantity", fields.path()));
    }
    problem.objective.push_back(term);
  }
}

/// The turn of the base is simulated for every posture that the search looks at.
void check_turn(MapReader& map, const CaptureProblem& problem) {
  const auto term = std::find_if(
      problem.objective.begin(), problem.objective.end(),
      [](const ObjectiveTerm& t) { return t.quantity == ObjectiveQuantity::AttitudeTurned; });
  if (term == problem.objective.end()) return;
  const auto refuse = [&](const char* rule, const std::string& what) {
    map.context().add(map.line_of("objective"), rule,
                      fmt::format("{}: attitude_turned {}", map.path_of("objective"), what));
  };
  const PostImpactSpec& spec = problem.post_impact;
  if (spec.controllers.empty()) {
    refuse("missing-key", "needs post_impact.controllers: it is the turn under the first of them");
  }
  if (term->after > spec.horizon) {
    refuse("out-of-range",
           fmt::format("after: {} s lie beyond post_impact.horizon = {} s, up to which the time "
                       "after the impact is judged",
                       term->after, spec.horizon));
  }
  if (spec.contact.model != ContactModel::Jump) {
    refuse("not-supported",
           "is that after the instantaneous impact: post_impact.contact must be 'jump'");
  }
}

/// A robust measure needs something to be robust against: asked once the cone is known.
void check_measure(MapReader& map, const CaptureProblem& problem) {
  const auto refuse = [&](const std::string& what) {
    map.context().add(map.line_of("objective"), "missing-key",
                      fmt::format("{}.measure: {}", map.path_of("objective"), what));
  };
  const UncertaintySpec& spread = problem.uncertainty;
  if (problem.measure.kind == RiskMeasure::WorstCase && !(spread.cone_half_angle > 0)) {
    refuse("'worst_case' needs uncertainty.cone_half_angle > 0");
  }
  const bool sampled =
      problem.measure.kind == RiskMeasure::Expectation || problem.measure.kind == RiskMeasure::Cvar;
  const JointVectord& joints = spread.joint_position;
  const double widest =
      std::max({joints.size() > 0 ? joints.maxCoeff() : 0, spread.cone_half_angle,
                spread.closing_speed, spread.restitution, spread.target_mass, spread.target_inertia,
                spread.contact_point, spread.contact_time});
  if (sampled && !(widest > 0)) refuse("needs something uncertain in the section 'uncertainty'");
  const double tail = (1 - problem.measure.cvar_level) * problem.measure.samples;
  if (problem.measure.kind == RiskMeasure::Cvar && !(tail >= 2 - 1e-9)) {
    map.context().add(
        map.line_of("objective"), "out-of-range",
        fmt::format("{}.samples: {} samples leave {:.3g} of them in the tail that counts; at least "
                    "2 are needed, or a single one decides",
                    map.path_of("objective"), problem.measure.samples, tail));
  }
}

void read_measure(MapReader& objective, MeasureSpec& measure) {
  const bool is_known = objective.choice("measure", measure.kind, measure_names());
  objective.number("cvar_level", measure.cvar_level, Dimension::None, {.lower = 0, .upper = 0.999});
  // Every sample costs a local solve as much as the prediction does; of a CVaR it is a variable and
  // an inequality as well.
  const bool is_tail = measure.kind == RiskMeasure::Cvar;
  objective.integer("samples", measure.samples, 1, is_tail ? 256 : 10000);
  objective.unsigned_integer("sample_seed", measure.seed);
  if (objective.has("measure") && !is_known) return;  // a misspelt measure may use them all
  const bool is_sampled = is_tail || measure.kind == RiskMeasure::Expectation;
  refuse_unless(is_tail, objective, "cvar_level", "the measure cvar");
  refuse_unless(is_sampled, objective, "samples", "the measures expectation and cvar");
  refuse_unless(is_sampled, objective, "sample_seed", "the measures expectation and cvar");
}

}  // namespace

void read_objective_section(MapReader& map, CaptureProblem& problem) {
  ObjectiveTerm& first = problem.objective.front();
  if (is_scalar(map.child("objective"))) {
    map.choice("objective", first.quantity, objective_names());
    if (first.quantity == ObjectiveQuantity::AttitudeTurned) {
      map.context().add(map.line_of("objective"), "missing-key",
                        fmt::format("{}: 'attitude_turned' needs its time: {{quantity: "
                                    "attitude_turned, after: ...}}",
                                    map.path_of("objective")));
    }
    return;
  }
  MapReader objective = section(map, "objective");
  if (const Node* terms = objective.child("terms")) {
    read_objective_terms(objective, *terms, problem);
    if (objective.has("quantity")) {
      objective.child("quantity");
      objective.context().add(
          objective.line_of("quantity"), "not-used",
          fmt::format("{}: stands beside terms; state one of them", objective.path_of("quantity")));
    }
  } else {
    objective.choice("quantity", first.quantity, objective_names(), Need::Required);
    read_after(objective, first);
  }
  read_measure(objective, problem.measure);
  objective.finish();
}

void check_objective(MapReader& map, const CaptureProblem& problem) {
  const std::size_t before = map.context().findings.size();
  check_turn(map, problem);
  if (map.context().findings.size() == before) check_measure(map, problem);
}

}  // namespace stillbase::io
