#include <cassert>
#include <stillbase/nlp/problem.hpp>

namespace stillbase::nlp {

Eigen::VectorXd Problem::lower() const {
  return Eigen::VectorXd::Constant(num_variables(), -kInfinity);
}

Eigen::VectorXd Problem::upper() const {
  return Eigen::VectorXd::Constant(num_variables(), kInfinity);
}

void Problem::lagrangian_hessian(const Eigen::VectorXd& x, double, const Eigen::VectorXd&,
                                 Eigen::MatrixXd& out) const {
  assert(false && "lagrangian_hessian() of a problem without one");
  out.setConstant(x.size(), x.size(), std::numeric_limits<double>::quiet_NaN());
}

Eigen::VectorXd signed_violation(const Eigen::VectorXd& value, const Eigen::VectorXd& lower,
                                 const Eigen::VectorXd& upper) {
  Eigen::VectorXd violation(value.size());
  for (Eigen::Index i = 0; i < value.size(); ++i) {
    violation[i] = value[i] > upper[i]   ? value[i] - upper[i]
                   : value[i] < lower[i] ? value[i] - lower[i]
                                         : 0.0;
  }
  return violation;
}

}  // namespace stillbase::nlp
