// What a plan says about proofs, in a program with stillbase::proof and in one without.
#include <iostream>

#include <stillbase/stillbase.hpp>
#ifdef WITH_PROOF
#include <stillbase/proof/proof.hpp>
#endif

int main() {
#ifdef WITH_PROOF
  stillbase::enable_proofs();
  const std::string expected = "proven complete: 8 solutions enclosed, none missed";
#else
  const std::string expected =
      "no proof: nothing was proven, the program has no prover (stillbase::proof)";
#endif
  const auto problem = stillbase::read_problem("problems/planar_two_link_c2_a.yaml");
  const std::string found = stillbase::make_plan(problem).certificate.proof.statement;
  std::cout << found << '\n';
  return found.rfind(expected, 0) == 0 ? 0 : 1;
}
