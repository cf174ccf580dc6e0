#include <stillbase/plan/prover.hpp>

namespace stillbase {

namespace {

/// A function's own variable: it exists before the first prover registers.
const Prover*& prover_of_program() {
  static const Prover* prover = nullptr;
  return prover;
}

}  // namespace

const Prover* registered_prover() { return prover_of_program(); }

void register_prover(const Prover& prover) { prover_of_program() = &prover; }

}  // namespace stillbase
