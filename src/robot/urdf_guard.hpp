// The gate before urdfdom: what it would crash on, drop or repair in silence is refused here.
//
// urdfdom reads a bad mass as 0, drops unknown geometry, accepts cycles and overflows the stack on
// deep files; its messages name no line. So the text is first parsed by TinyXML 2, which bounds the
// nesting itself and knows the line of every element and attribute, and held against a table of the
// URDF elements that we read. After that every number in the text is known to be a finite number
// and the joints are known to form a tree, and urdfdom's values can be trusted.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace stillbase::urdf {

struct OutlineLink {
  std::string name;
  int line = 0;
  int parent_joint = -1;          ///< index into Outline::joints; -1 for the root
  std::vector<int> child_joints;  ///< in file order (urdfdom sorts them by name)
};

struct OutlineJoint {
  std::string name;
  int line = 0;
  int parent = -1;  ///< index into Outline::links
  int child = -1;
};

/// The tree of a file, in file order, with lines.
struct Outline {
  std::vector<OutlineLink> links;
  std::vector<OutlineJoint> joints;
  int root = -1;
};

/// @throws InputError
Outline guard(std::string_view text, const std::string& source);

}  // namespace stillbase::urdf
