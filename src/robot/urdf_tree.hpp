// A URDF text as a checked tree of links: what has no physical or formal meaning is refused here.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <tinyxml2.h>

#include "robot/urdf_schema.hpp"

namespace stillbase::urdf {

using tinyxml2::XMLElement;

struct TreeJoint {
  const XMLElement* element;
  std::string name;
  int parent, child;  ///< indices into Tree::links
};

struct TreeLink {
  const XMLElement* element;
  std::string name;
  int parent_joint = -1;               ///< index into Tree::joints; -1 for the root
  std::vector<int> child_joints = {};  ///< in file order
};

/// The tree of a file, in file order.
struct Tree {
  std::vector<TreeLink> links;
  std::vector<TreeJoint> joints;
  int root = -1;
};

/// The children of an element with this name, in file order.
std::vector<const XMLElement*> children(const XMLElement& element, const char* name);

/// Parses the text into `document`, to which the tree points.
/// @throws InputError with every finding of the same stage
Tree read_tree(std::string_view text, tinyxml2::XMLDocument& document, Findings& findings);

}  // namespace stillbase::urdf
