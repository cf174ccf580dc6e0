// Linking stillbase::proof is enough for the planner to find it: CMakeLists.txt makes every program
// that does so ask for the symbol below, and with it for this file.
#include <stillbase/proof/minimum.hpp>
#include <stillbase/proof/proof.hpp>

namespace {

constexpr stillbase::Prover kIntervalProver{stillbase::prove, stillbase::minimum_objection,
                                            stillbase::prove_minimum};

bool register_interval_prover() {
  stillbase::register_prover(kIntervalProver);
  return true;
}

}  // namespace

extern "C" {
extern const bool stillbase_proof_is_registered;
const bool stillbase_proof_is_registered = register_interval_prover();
}
