// Linked into all test programs of a build with stillbase::proof: their planners prove.
#include <stillbase/proof/proof.hpp>

namespace {

[[maybe_unused]] const bool is_enabled = (stillbase::enable_proofs(), true);

}  // namespace
