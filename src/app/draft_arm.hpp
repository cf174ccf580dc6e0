// What a robot file says of an arm before it is put on a base.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "robot/urdf_tree.hpp"

namespace stillbase::app {

/// The arm as the file has it: joints by the link that they carry.
class ArmTree {
 public:
  /// @param tree outlives this
  explicit ArmTree(const urdf::Tree& tree);

  bool has_link(const std::string& name) const;
  /// Joints between root and link, the link's own first.
  std::vector<const urdf::TreeJoint*> way_to(const std::string& link) const;
  double mass() const;          ///< kg
  double mass_on_root() const;  ///< of the root link and all that is fixed to it, kg
  /// The end behind the most joints that has the name of a tool; of a gripper the link that carries
  /// its fingers.
  std::string hand() const;
  /// The ends that joints beyond a hand carry: the tips of its fingers.
  std::vector<std::string> tips_beyond(const std::string& hand) const;

 private:
  long moving_before(const std::string& link) const;
  /// The link that a joint moves and this one is fixed to, or the root.
  std::string body_of(const std::string& link) const;
  long branches_at(const std::string& body) const;

  const urdf::Tree& tree_;
  std::map<std::string, const urdf::TreeJoint*> above_;
};

}  // namespace stillbase::app
