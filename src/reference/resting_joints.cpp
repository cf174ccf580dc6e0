#include "reference/resting_joints.hpp"

#include <algorithm>
#include <cmath>

namespace stillbase::reference {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Reduced {
  MatrixXd M;
  VectorXd force;
};

// The joints alone, everything else moving as it likes.
Reduced without_the_others(const MatrixXd& H, const VectorXd& load,
                           const std::vector<RestingJoint>& joints) {
  MatrixXd pick = MatrixXd::Zero(H.rows(), static_cast<Eigen::Index>(joints.size()));
  for (std::size_t i = 0; i < joints.size(); ++i) {
    pick(6 + joints[i].joint, static_cast<Eigen::Index>(i)) = 1;
  }
  // What forces on them do to their accelerations, and the accelerations without any.
  const Eigen::LDLT<MatrixXd> factor(H);
  const MatrixXd mobility = pick.transpose() * factor.solve(pick);
  const VectorXd free = pick.transpose() * factor.solve(load);
  const Eigen::LDLT<MatrixXd> reduced(mobility);
  return {reduced.solve(MatrixXd::Identity(mobility.rows(), mobility.cols())), reduced.solve(free)};
}

double minimum_along(double force, double mass, const RestingJoint& joint) {
  const double beyond = std::max(0.0, std::abs(force) - joint.friction);
  return std::clamp(std::copysign(beyond, force) / mass, joint.least, joint.most);
}

}  // namespace

std::vector<int> starting_directions(const MatrixXd& H, const VectorXd& load,
                                     const std::vector<RestingJoint>& joints) {
  constexpr int kMostSweeps = 100'000;
  constexpr double kConverged = 1e-15;  // change of a sweep, over the largest acceleration
  const Reduced reduced = without_the_others(H, load, joints);
  const auto m = static_cast<Eigen::Index>(joints.size());
  VectorXd a = VectorXd::Zero(m);
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double change = 0;
    for (Eigen::Index i = 0; i < m; ++i) {
      const double own = reduced.M(i, i);
      const double force = reduced.force(i) - reduced.M.row(i).dot(a) + own * a(i);
      const double next = minimum_along(force, own, joints[static_cast<std::size_t>(i)]);
      change = std::max(change, std::abs(next - a(i)));
      a(i) = next;
    }
    if (change <= kConverged * a.lpNorm<Eigen::Infinity>()) break;
  }
  std::vector<int> out;
  for (const double acceleration : a) out.push_back((acceleration > 0) - (acceleration < 0));
  return out;
}

}  // namespace stillbase::reference
