#include "nlp/ipopt_linear_solver.hpp"

#ifdef STILLBASE_IPOPT_TAKES_MA27

#include <HSLLoader.h>

#include <algorithm>

#include "nlp/dense_ldl.hpp"

namespace stillbase::nlp {

namespace {

// Codes and places of MA27's INFO.
constexpr int kSingular = -5;
constexpr int kFlag = 0, kFactorLength = 4, kIntegerLength = 5, kNegativeEigenvalues = 14;

/// The factors stand behind the entries, which Ipopt writes to the front: at the end of the array.
DenseLdl factors_in(ipfint n, double* a, ipfint length, ipfint* order) {
  double* const scale = a + length - n;
  return {{scale - Eigen::Index{n} * n, n, n}, {scale, n}, {order, n}};
}

void set_defaults(ipfint*, double*) {}

void analyse(ipfint* n, ipfint* entries, const ipfint*, const ipfint*, ipfint*, ipfint*, ipfint*,
             ipfint*, ipfint* steps, ipfint*, ipfint*, double*, ipfint* info, double*) {
  std::fill_n(info, 20, 0);
  info[kFactorLength] = *entries + *n * (*n + 1);
  info[kIntegerLength] = *n;
  *steps = 1;
}

void factorise_entries(ipfint* n, ipfint* entries, const ipfint* rows, const ipfint* columns,
                       double* a, ipfint* length, ipfint* order, ipfint*, ipfint*, ipfint*,
                       ipfint* largest_front, ipfint*, ipfint*, double*, ipfint* info) {
  std::fill_n(info, 20, 0);
  *largest_front = *n;
  DenseLdl matrix = factors_in(*n, a, *length, order);
  matrix.A.setZero();
  for (ipfint k = 0; k < *entries; ++k) {  // one triangle; entries of the same place add up
    const ipfint i = rows[k] - 1, j = columns[k] - 1;
    matrix.A(i, j) += a[k];
    if (i != j) matrix.A(j, i) += a[k];
  }
  const LdlInertia inertia = nlp::factorise(matrix);
  if (inertia.is_singular) info[kFlag] = kSingular;
  info[kNegativeEigenvalues] = inertia.negative;
}

void solve_with_factors(ipfint* n, double* a, ipfint* length, ipfint* order, ipfint*, double* work,
                        ipfint*, double* b, ipfint*, ipfint*, ipfint*, double*) {
  solve(factors_in(*n, a, *length, order), Eigen::Map<Eigen::VectorXd>(b, *n),
        Eigen::Map<Eigen::VectorXd>(work, *n));
}

}  // namespace

bool provides_linear_solver() {
  static const bool ours = [] {
    if (LSL_isMA27available() != 0) return false;
    LSL_setMA27(analyse, factorise_entries, solve_with_factors, set_defaults);
    return true;
  }();
  return ours;
}

}  // namespace stillbase::nlp

#else

namespace stillbase::nlp {

bool provides_linear_solver() { return false; }

}  // namespace stillbase::nlp

#endif
