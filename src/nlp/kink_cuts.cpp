#include "nlp/kink_cuts.hpp"

namespace stillbase::nlp {

namespace {

/// Length of the change of a normal from a to b; 0 where it is small beside that at b, or where one
/// of them is not known (Evaluation::far).
double turn_of(const Side& side, const SqpPoint& a, const SqpPoint& b) {
  const auto here = a.at.jacobian.row(side.index), there = b.at.jacobian.row(side.index);
  if (here.isZero(0) || there.isZero(0)) return 0;
  const double turned = (here - there).norm();
  return turned > kKinks.turned * there.norm() ? turned : 0;
}

}  // namespace

double KinkCuts::room_at(const SqpPoint& here, const Cut& cut) const {
  return std::max(cut.room + cut.normal.dot(here.x - cut.x), room(sides_[cut.side], here));
}

void KinkCuts::count(std::size_t cut, double multiplier) {
  int& idle = cuts_[cut].idle;
  idle = multiplier > 0 ? 0 : idle + 1;
}

bool KinkCuts::is_like(const Cut& cut, const SqpPoint& point) const {
  const Eigen::VectorXd there = normal(sides_[cut.side], point);
  return (cut.normal - there).norm() <= kKinks.turned * there.norm();
}

void KinkCuts::add(std::size_t side, const SqpPoint& from) {
  if (static_cast<int>(cuts_.size()) == kKinks.most) cuts_.erase(cuts_.begin());
  cuts_.push_back({side, from.x, normal(sides_[side], from), room(sides_[side], from)});
}

bool KinkCuts::take(std::size_t side, const SqpPoint& here, const SqpPoint& trial) {
  if (turn_of(sides_[side], trial, here) == 0) return false;
  std::erase_if(cuts_, [&](const Cut& cut) { return cut.side == side && is_like(cut, trial); });
  add(side, trial);
  return true;
}

void KinkCuts::follow(const SqpPoint& before, const SqpPoint& here,
                      const Eigen::VectorXd& multipliers) {
  const double moved = (here.x - before.x).norm();
  const auto was_known = [&](std::size_t side) {
    return std::any_of(cuts_.begin(), cuts_.end(),
                       [&](const Cut& cut) { return cut.side == side && is_like(cut, here); });
  };
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    is_kinked_[i] = false;
    if (!sides_[i].may_have_kinks || multipliers[static_cast<Eigen::Index>(i)] == 0) continue;
    const double turned = turn_of(sides_[i], before, here);
    is_kinked_[i] = turned > 0 && (turned > kKinks.kink * moved || was_known(i));
  }
  std::erase_if(cuts_, [&](const Cut& cut) {
    const bool is_near = (cut.x - here.x).norm() <= kKinks.reach;
    return cut.idle > kKinks.idle || !is_near || is_like(cut, here);
  });
  for (std::size_t i = 0; i < sides_.size(); ++i) {
    if (is_kinked_[i]) add(i, before);
  }
}

std::vector<std::size_t> KinkCuts::limiting() const {
  std::vector<std::size_t> out;
  for (std::size_t i = 0; i < cuts_.size(); ++i) {
    if (cuts_[i].idle == 0) out.push_back(i);
  }
  return out;
}

bool KinkCuts::is_kink(std::size_t cut, const SqpPoint& here,
                       const std::function<const SqpPoint*(const Eigen::VectorXd&)>& look) const {
  const Side& side = sides_[cuts_[cut].side];
  Eigen::VectorXd from = here.x, to = cuts_[cut].x;
  Eigen::VectorXd normal_from = normal(side, here), normal_to = cuts_[cut].normal;
  const double whole = (normal_to - normal_from).norm();
  for (int i = 0; i < kKinks.halvings; ++i) {
    const Eigen::VectorXd middle = (from + to) / 2;
    const SqpPoint* at_middle = look(middle);
    if (at_middle == nullptr) return false;
    const Eigen::VectorXd there = normal(side, *at_middle);
    const bool is_before = (there - normal_from).norm() > (normal_to - there).norm();
    (is_before ? to : from) = middle;
    (is_before ? normal_to : normal_from) = there;
  }
  return (normal_to - normal_from).norm() >= kKinks.jump * whole;
}

void KinkCuts::forget(std::size_t cut) {
  cuts_.erase(cuts_.begin() + static_cast<std::ptrdiff_t>(cut));
}

}  // namespace stillbase::nlp
