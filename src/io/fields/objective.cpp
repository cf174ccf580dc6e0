// The section `objective`.
#include "io/fields/sections.hpp"

namespace stillbase::io {

namespace {

/// All quantities, by a part of their rows in the catalogue.
template <class Part>
std::string each_quantity(const char* separator, const Part& part) {
  std::string text;
  for (const QuantityRow& row : quantities()) text += (text.empty() ? "" : separator) + part(row);
  return text;
}

/// "`name` (what it is)", without the formula before the colon.
std::string name_and_words(const QuantityRow& row) {
  const std::size_t colon = row.sentence.rfind(": ");
  return "`" + row.name + "` (" +
         (colon == std::string::npos ? row.sentence : row.sentence.substr(colon + 2)) + ")";
}

/// The time of the attitude change: required by that quantity, refused by the others.
void after_field(Table& t, ObjectiveTerm& term, const char* text) {
  const bool needs_time = row_of(term.quantity).needs_time;
  // Before the lower end the base has rotated by its rate times the time.
  t("after", Number(term.after, Dimension::Time, {.lower = 1e-3, .upper = 3600}), text,
    {.need = Need::Required,
     .without = "required there",
     .is_used = needs_time,
     .owner = "attitude_turned"});
}

}  // namespace

static void fields(Table& t, ObjectiveTerm& term) {
  t("quantity", Word(term.quantity, objective_names()), "as `objective.quantity`",
    {.need = Need::Required, .decides = true});
  const bool is_unknown = t.reader() != nullptr && t.reader()->was_refused("quantity");
  t("size", Number(term.size, dimension_of_unit(row_of(term.quantity).unit), kSensible),
    "value that counts as one", needed("that of the quantity"));
  t("length", Number(term.length, Dimension::Length, kSensible),
    "`base_momentum` alone: converts angular into linear momentum",
    {.is_used = is_unknown || row_of(term.quantity).needs_length, .owner = "base_momentum"});
  after_field(t, term, "as `objective.after`");
}

namespace {

void measure_fields(Table& t, MeasureSpec& measure) {
  t("measure", Word(measure.kind, kMeasureNames),
    "what counts over the uncertainty: `nominal` (the nominal value; values within 1e-8 of "
    "the objective's typical size count as equal and are ranked by their worst case), `worst_case` "
    "(largest over the cone, or over the residual velocity), `expectation` and `cvar` (root of the "
    "mean square over all samples, over the worst ones)",
    {.decides = true});
  // A misspelt measure may use them all.
  const bool is_unknown = t.reader() != nullptr && t.reader()->was_refused("measure");
  const bool is_tail = measure.kind == RiskMeasure::Cvar;
  const bool is_sampled = is_tail || measure.kind == RiskMeasure::Expectation;
  t("cvar_level", Number(measure.cvar_level, {.lower = 0, .upper = 0.999}),
    "`cvar` alone: the worst 1 - level of the samples count",
    {.is_used = is_tail || is_unknown, .owner = "the measure cvar"});
  const About of_samples{.is_used = is_sampled || is_unknown,
                         .owner = "the measures expectation and cvar"};
  // Every sample costs a local solve as much as the nominal value does; of a CVaR it is a variable
  // and an inequality as well.
  t("samples", Integer(measure.samples, 1, is_tail ? 256 : 10000),
    "`expectation`, `cvar` alone: number of samples; at least two in the worst 1 - level; of "
    "`cvar` at most 256",
    of_samples);
  t("sample_seed", Seed(measure.seed),
    "`expectation`, `cvar` alone: sample *k* depends on this and *k* alone", of_samples);
}

}  // namespace

void objective_fields(Table& t, CaptureProblem& problem) {
  std::vector<ObjectiveTerm>& terms = problem.objective;
  ObjectiveTerm& first = terms.front();
  const bool is_plain = terms.size() == 1 && first.size == 1 &&
                        (first.length == 1 || !row_of(first.quantity).needs_length);
  if (t.states("terms", !is_plain)) {
    t("terms", maps_of(terms, {.least = 1, .unique_key = "quantity", .of = "{quantity: , size: }"}),
      "several quantities instead of one: the root of the sum of (value / size)^2 is made small, "
      "of an energy value / size",
      {.need = Need::Required, .without = "none"});
    t.not_both("terms", "quantity");
    if (t.reader() != nullptr && terms.empty()) terms.resize(1);
  } else {
    t("quantity", Word(first.quantity, objective_names()),
      "made small: " + each_quantity(", ", name_and_words),
      {.need = Need::Required,
       .frame = each_quantity(", ", [](const QuantityRow& row) { return row.unit; }),
       .without = "required without terms",
       .decides = true});
    after_field(t, first,
                "`attitude_turned`: how long after the impact, under the first of "
                "`post_impact.controllers`; at most `post_impact.horizon`");
  }
  measure_fields(t, problem.measure);
}

}  // namespace stillbase::io
