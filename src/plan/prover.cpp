#include <stillbase/plan/prover.hpp>

namespace stillbase {

namespace {

const Prover* prover_of_program = nullptr;

}  // namespace

const Prover* default_prover() { return prover_of_program; }

void use_prover(const Prover& prover) { prover_of_program = &prover; }

}  // namespace stillbase
