#include "robot/urdf_tree.hpp"

#include <algorithm>
#include <map>

#include <fmt/format.h>

#include <stillbase/core/file.hpp>
#include <stillbase/robot/urdf_reader.hpp>

namespace stillbase::urdf {

namespace {

// Plans carry the robot's text inside JSON.
void check_text(std::string_view text, Findings& findings) {
  if (text.size() > kMaxUrdfBytes) {
    findings.add(0, "too-large", fmt::format("{} bytes, at most {}", text.size(), kMaxUrdfBytes));
    return;
  }
  const std::size_t bad = first_bad_byte(text);
  if (bad == std::string_view::npos) return;
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<long>(bad), '\n');
  findings.add(static_cast<int>(line), "not-text",
               fmt::format("byte 0x{:02x} is not allowed; the text must be UTF-8",
                           static_cast<unsigned char>(text[bad])));
}

bool climbs_out(std::string_view path) {
  while (!path.empty()) {
    const std::size_t end = std::min(path.find_first_of("/\\"), path.size());
    if (path.substr(0, end) == "..") return true;
    path.remove_prefix(std::min(end + 1, path.size()));
  }
  return false;
}

// What is dangerous anywhere, also in elements that are ignored.
void check_everywhere(const tinyxml2::XMLNode& node, int depth, Findings& findings) {
  if (depth > kMaxUrdfDepth) {
    findings.add(node.GetLineNum(), "too-deep",
                 fmt::format("elements are nested more than {} deep", kMaxUrdfDepth));
    return;
  }
  for (const auto* n = node.FirstChild(); n != nullptr; n = n->NextSibling()) {
    if (n->ToUnknown() != nullptr) {
      findings.add(n->GetLineNum(), "doctype",
                   "document types and entity definitions are not allowed");
    }
    const auto* element = n->ToElement();
    if (element == nullptr) continue;
    const char* filename = element->Attribute("filename");
    if (filename != nullptr && climbs_out(filename)) {
      findings.add(n->GetLineNum(), "mesh-path",
                   fmt::format("the path {} leaves the robot's folder", quoted(filename)));
    }
    check_everywhere(*element, depth + 1, findings);
  }
}

/// The document, or every finding about its form.
const XMLElement& check_document(std::string_view text, tinyxml2::XMLDocument& document,
                                 Findings& findings) {
  check_text(text, findings);
  findings.raise();
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    const bool deep = document.ErrorID() == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED;
    findings.add(document.ErrorLineNum(), deep ? "too-deep" : "xml",
                 deep ? fmt::format("elements are nested more than {} deep", kMaxUrdfDepth)
                      : fmt::format("not well-formed XML ({})", document.ErrorName()));
    findings.raise();
  }
  check_everywhere(document, 0, findings);
  const XMLElement* robot = document.RootElement();
  if (robot == nullptr || std::string_view(robot->Name()) != "robot") {
    findings.add(robot != nullptr ? robot->GetLineNum() : 0, "xml",
                 "the outermost element must be <robot>");
  } else if (robot->NextSiblingElement() != nullptr) {
    findings.add(robot->NextSiblingElement()->GetLineNum(), "xml",
                 "there is an element after </robot>");
  }
  findings.raise();
  const auto links = children(*robot, "link");
  if (links.size() > kMaxUrdfLinks) {
    findings.add(links[kMaxUrdfLinks]->GetLineNum(), "too-many-links",
                 fmt::format("at most {}", kMaxUrdfLinks));
    findings.raise();
  }
  check_element(*robot, findings);
  findings.raise();
  return *robot;
}

// Type and limits; form and sign of the numbers are known to be right.
void check_joint(const XMLElement& element, const std::string& name, Findings& findings) {
  const std::string type = element.Attribute("type");
  const int line = element.GetLineNum();
  if (type == "fixed" || type == "continuous") return;
  if (type != "revolute" && type != "prismatic") {
    const bool several = type == "floating" || type == "planar";
    findings.add(line, "joint-type",
                 fmt::format("joint {} is {}: {}; allowed: revolute continuous prismatic fixed",
                             quoted(name), quoted(type),
                             several ? "joints of several degrees of freedom are not supported"
                                     : "no such type"));
    return;
  }
  const auto* limit = element.FirstChildElement("limit");
  if (limit == nullptr || limit->Attribute("lower") == nullptr ||
      limit->Attribute("upper") == nullptr) {
    findings.add(
        limit != nullptr ? limit->GetLineNum() : line, "joint-limits",
        fmt::format("joint {} is {} and needs <limit> with lower and upper", quoted(name), type));
    return;
  }
  const double lower = number(limit, "lower"), upper = number(limit, "upper");
  if (lower > upper) {
    findings.add(limit->GetLineNum(), "joint-limits",
                 fmt::format("joint {}: lower {} is above upper {}", quoted(name), lower, upper));
  }
}

/// Links, joints and how they hang together; joints with an unknown link are refused.
Tree tree_of(const XMLElement& robot, Findings& findings) {
  Tree tree;
  std::map<std::string, int> index, joint_names;
  const auto add_name = [&](std::map<std::string, int>& names, const XMLElement& element, int i) {
    const std::string name = element.Attribute("name");
    if (!names.emplace(name, i).second) {
      findings.add(element.GetLineNum(), "duplicate-name",
                   fmt::format("there is already a {} {}", element.Name(), quoted(name)));
    }
    return name;
  };
  for (const XMLElement* e : children(robot, "link")) {
    tree.links.push_back({e, add_name(index, *e, static_cast<int>(tree.links.size()))});
  }
  int movable = 0;
  for (const XMLElement* e : children(robot, "joint")) {
    const int joint = static_cast<int>(tree.joints.size());
    const std::string name = add_name(joint_names, *e, joint);
    check_joint(*e, name, findings);
    if (std::string_view(e->Attribute("type")) != "fixed") ++movable;
    const auto link_of = [&](const char* end) {
      const std::string link = e->FirstChildElement(end)->Attribute("link");
      const auto found = index.find(link);
      if (found != index.end()) return found->second;
      findings.add(e->GetLineNum(), "unknown-link",
                   fmt::format("joint {}: there is no link {}", quoted(name), quoted(link)));
      return -1;
    };
    const int parent = link_of("parent"), child = link_of("child");
    tree.joints.push_back({e, name, parent, child});
    if (parent < 0 || child < 0) continue;
    tree.links[parent].child_joints.push_back(joint);
    int& parent_joint = tree.links[child].parent_joint;
    if (parent_joint >= 0) {
      findings.add(
          e->GetLineNum(), "two-parents",
          fmt::format("link {} is already the child of joint {}", quoted(tree.links[child].name),
                      quoted(tree.joints[parent_joint].name)));
    }
    parent_joint = joint;
  }
  if (movable > kMaxJoints) {
    findings.add(robot.GetLineNum(), "too-many-joints",
                 fmt::format("{} movable joints, at most {}", movable, kMaxJoints));
  }
  findings.raise();
  return tree;
}

/// Finds the root. Every link has at most one parent here, so a link that no root reaches hangs on
/// a cycle.
void check_tree(Tree& tree, Findings& findings) {
  std::vector<int> open;
  std::vector<bool> reached(tree.links.size(), false);
  for (int i = 0; i < static_cast<int>(tree.links.size()); ++i) {
    const TreeLink& link = tree.links[i];
    if (link.parent_joint >= 0) continue;
    open.push_back(i);
    if (tree.root < 0) {
      tree.root = i;
    } else {
      findings.add(link.element->GetLineNum(), "two-roots",
                   fmt::format("links {} and {} both have no parent: one robot has one base",
                               quoted(tree.links[tree.root].name), quoted(link.name)));
    }
  }
  while (!open.empty()) {
    const int i = open.back();
    open.pop_back();
    reached[i] = true;
    for (const int joint : tree.links[i].child_joints) open.push_back(tree.joints[joint].child);
  }
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    if (reached[i]) continue;
    findings.add(tree.links[i].element->GetLineNum(), "cycle",
                 fmt::format("link {} is not connected to the base: its joints form a cycle",
                             quoted(tree.links[i].name)));
  }
  findings.raise();
}

}  // namespace

std::vector<const XMLElement*> children(const XMLElement& element, const char* name) {
  std::vector<const XMLElement*> found;
  for (const auto* e = element.FirstChildElement(name); e; e = e->NextSiblingElement(name)) {
    found.push_back(e);
  }
  return found;
}

Tree read_tree(std::string_view text, tinyxml2::XMLDocument& document, Findings& findings) {
  Tree tree = tree_of(check_document(text, document, findings), findings);
  check_tree(tree, findings);
  return tree;
}

}  // namespace stillbase::urdf
