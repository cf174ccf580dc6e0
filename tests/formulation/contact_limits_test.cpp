// What is limited at the contact has one row, from which proofs and advice take their words.
#include <filesystem>
#include <optional>

#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/io/problem_file.hpp>

#include "formulation/formulation_parts.hpp"
#include "plan/contact_limits.hpp"

namespace stillbase {

TEST_CASE("every limit at the contact of the shipped problems has its row") {
  int problems = 0, limits = 0;
  for (const auto& entry : std::filesystem::directory_iterator(STILLBASE_SOURCE_DIR "/problems")) {
    if (entry.path().extension() != ".yaml") continue;
    INFO(entry.path().string());
    const CaptureProblem problem = read_problem(entry.path().string());
    std::optional<Formulation> formulation;
    try {
      formulation.emplace(problem);
    } catch (const InputError&) {
      continue;  // a problem for `analyze`: nothing is free
    }
    ++problems;
    for (const Constraint* row : formulation->parts().rows.kept) {
      INFO(row->name);
      const ContactLimitRow* known = limit_of(problem, row->name);
      const bool is_of_hand = row->name.starts_with("hand_") || row->name.starts_with("base_pos");
      CHECK((known != nullptr) != is_of_hand);
      if (!row->is_limit) continue;
      ++limits;
      // Proofs take neither of the other two.
      const bool is_refused =
          problem.impulse.contact == ContactLaw::Sticking || problem.hand_motion.moves();
      REQUIRE(known != nullptr);
      CHECK((known->uncounted != nullptr || is_refused));
    }
  }
  CHECK(problems > 35);
  CHECK(limits > 100);
}

}  // namespace stillbase
