// Least values that a problem may ask of a quantity at the contact, one number each. A row
//   X(quantity, dimension, uncounted, sentence)
// is the member `quantity_min` of ConstraintSpec (SI units; 0: no bound), the key of that name in
// the section `constraints` of a problem file, in units of `dimension`, and what proofs and advice
// say of it: `uncounted` is how a proof that leaves it out calls it. The constraint itself is a
// file of the quantity's name in src/formulation/constraints/, where `add_quantity()` gives its row
// that name; verification has a formula of its own in src/verification/limits.cpp.
#pragma once

// clang-format off
#define STILLBASE_LEAST_VALUES(X)                                                                  \
  X(coupling_singular_value, Inertia, "singular values",                                           \
    "lower bound of the smallest singular value of the angular coupling matrix, so that the arm "  \
    "can push against every direction of the base; of those that are not zero in every posture "   \
    "(one of a planar robot); 0: no bound")                                                        \
  X(jacobian_singular_value, Length, "singular values",                                            \
    "the same of the generalized Jacobian, its angular rows times `jacobian_length`; with a "      \
    "`contact.hand_velocity` it keeps the joint rates smooth: no singular posture is near")
// clang-format on
