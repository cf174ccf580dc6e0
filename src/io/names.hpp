// Words of the files for the values of the plain data, in both directions.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <stillbase/plan/plan.hpp>

namespace stillbase::io {

template <class E>
using Names = std::vector<std::pair<std::string_view, E>>;

template <class E>
std::optional<E> value_of(const Names<E>& names, std::string_view word) {
  for (const auto& [name, value] : names) {
    if (name == word) return value;
  }
  return std::nullopt;
}

template <class E>
std::string word_of(const Names<E>& names, E value) {
  for (const auto& [name, candidate] : names) {
    if (candidate == value) return std::string(name);
  }
  return {};
}

template <class E>
std::vector<std::string> words_of(const Names<E>& names) {
  std::vector<std::string> words;
  for (const auto& entry : names) words.emplace_back(entry.first);
  return words;
}

const Names<Frame>& frame_names();
const Names<ImpulseSource>& impulse_source_names();
const Names<ResistanceModel>& resistance_names();
const Names<AttitudeFreedom>& attitude_freedom_names();
const Names<PositionFreedom>& position_freedom_names();
const Names<ObjectiveQuantity>& objective_names();
const Names<RiskMeasure>& measure_names();
const Names<HandConstraint>& hand_constraint_names();
const Names<CaseConstraint>& case_constraint_names();
const Names<BaseMode>& base_mode_names();
const Names<PathPolish>& path_polish_names();
const Names<ImpactCase>& impact_case_names();
const Names<PlanStatus>& plan_status_names();
const Names<ApproachStatus>& approach_status_names();
const Names<ProofStatus>& proof_status_names();
const Names<ContactModel>& contact_model_names();

}  // namespace stillbase::io
