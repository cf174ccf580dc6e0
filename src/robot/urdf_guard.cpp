#include "robot/urdf_guard.hpp"

#include <fmt/format.h>
#include <tinyxml2.h>

#include <algorithm>
#include <map>

#include <stillbase/core/types.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "robot/urdf_schema.hpp"

namespace stillbase::urdf {

namespace {

// Length of the UTF-8 sequence at the start of `text`, 0 when it is not valid (RFC 3629).
std::size_t utf8_length(std::string_view text) {
  const auto byte = [&](std::size_t i) {
    return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u;
  };
  const unsigned first = byte(0);
  if (first < 0x80) return 1;
  const std::size_t length = first >= 0xf0 ? 4 : first >= 0xe0 ? 3 : 2;
  if (first < 0xc2 || first > 0xf4) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((byte(i) & 0xc0) != 0x80) return 0;
  }
  const unsigned second = byte(1);  // overlong forms, surrogates, beyond U+10FFFF
  if ((first == 0xe0 && second < 0xa0) || (first == 0xed && second > 0x9f) ||
      (first == 0xf0 && second < 0x90) || (first == 0xf4 && second > 0x8f)) {
    return 0;
  }
  return length;
}

// Plans carry the robot's text inside JSON, and urdfdom stops at a zero byte.
void check_text(std::string_view text, Findings& findings) {
  if (text.size() > kMaxUrdfBytes) {
    findings.add(0, "too-large", fmt::format("{} bytes, at most {}", text.size(), kMaxUrdfBytes));
    return;
  }
  int line = 1;
  for (std::size_t i = 0; i < text.size();) {
    const std::size_t length = utf8_length(text.substr(i));
    if (length == 0 || text[i] == '\0') {
      findings.add(line, "not-text",
                   length == 0 ? "the file is not valid UTF-8" : "the file contains a zero byte");
      return;
    }
    if (text[i] == '\n') ++line;
    i += length;
  }
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

const char* attribute(const tinyxml2::XMLElement& element, const char* child, const char* name) {
  return element.FirstChildElement(child)->Attribute(name);
}

// Type and limits; form and sign of the numbers are known to be right.
void check_joint(const tinyxml2::XMLElement& element, const std::string& name, Findings& findings) {
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
  const double lower = number(limit->Attribute("lower"));
  const double upper = number(limit->Attribute("upper"));
  if (lower > upper) {
    findings.add(limit->GetLineNum(), "joint-limits",
                 fmt::format("joint {}: lower {} is above upper {}", quoted(name), lower, upper));
  }
}

Outline outline_of(const tinyxml2::XMLElement& robot, Findings& findings) {
  Outline outline;
  std::map<std::string, int> index;
  for (const auto* e = robot.FirstChildElement("link"); e; e = e->NextSiblingElement("link")) {
    const std::string name = e->Attribute("name");
    if (!index.emplace(name, static_cast<int>(outline.links.size())).second) {
      findings.add(e->GetLineNum(), "duplicate-name",
                   fmt::format("there is already a link {}", quoted(name)));
    }
    outline.links.push_back({name, e->GetLineNum(), -1, {}});
  }
  std::map<std::string, int> joint_line;
  for (const auto* e = robot.FirstChildElement("joint"); e; e = e->NextSiblingElement("joint")) {
    const std::string name = e->Attribute("name");
    const int line = e->GetLineNum();
    if (!joint_line.emplace(name, line).second) {
      findings.add(line, "duplicate-name",
                   fmt::format("there is already a joint {}", quoted(name)));
    }
    check_joint(*e, name, findings);
    const auto link_of = [&](const char* end) {
      const std::string link = attribute(*e, end, "link");
      const auto found = index.find(link);
      if (found != index.end()) return found->second;
      findings.add(line, "unknown-link",
                   fmt::format("joint {}: there is no link {}", quoted(name), quoted(link)));
      return -1;
    };
    const int parent = link_of("parent"), child = link_of("child");
    const int joint = static_cast<int>(outline.joints.size());
    outline.joints.push_back({name, line, parent, child});
    if (parent < 0 || child < 0) continue;
    outline.links[parent].child_joints.push_back(joint);
    int& parent_joint = outline.links[child].parent_joint;
    if (parent_joint >= 0) {
      findings.add(
          line, "two-parents",
          fmt::format("link {} is already the child of joint {}", quoted(outline.links[child].name),
                      quoted(outline.joints[parent_joint].name)));
    }
    parent_joint = joint;
  }
  return outline;
}

// Every link has at most one parent here, so a link that no root reaches hangs on a cycle.
void check_tree(Outline& outline, Findings& findings) {
  std::vector<int> open;
  std::vector<bool> reached(outline.links.size(), false);
  for (int i = 0; i < static_cast<int>(outline.links.size()); ++i) {
    const OutlineLink& link = outline.links[i];
    if (link.parent_joint >= 0) continue;
    open.push_back(i);
    if (outline.root < 0) {
      outline.root = i;
    } else {
      findings.add(link.line, "two-roots",
                   fmt::format("links {} and {} both have no parent: one robot has one base",
                               quoted(outline.links[outline.root].name), quoted(link.name)));
    }
  }
  while (!open.empty()) {
    const int i = open.back();
    open.pop_back();
    reached[i] = true;
    for (const int joint : outline.links[i].child_joints) {
      open.push_back(outline.joints[joint].child);
    }
  }
  for (std::size_t i = 0; i < outline.links.size(); ++i) {
    if (!reached[i]) {
      findings.add(outline.links[i].line, "cycle",
                   fmt::format("link {} is not connected to the base: its joints form a cycle",
                               quoted(outline.links[i].name)));
    }
  }
}

int count_movable(const tinyxml2::XMLElement& robot) {
  int count = 0;
  for (const auto* e = robot.FirstChildElement("joint"); e; e = e->NextSiblingElement("joint")) {
    if (std::string_view(e->Attribute("type")) != "fixed") ++count;
  }
  return count;
}

}  // namespace

Outline guard(std::string_view text, const std::string& source) {
  Findings findings(source);
  check_text(text, findings);
  findings.raise();

  tinyxml2::XMLDocument document;
  if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
    const bool deep = document.ErrorID() == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED;
    findings.add(document.ErrorLineNum(), deep ? "too-deep" : "xml",
                 deep ? fmt::format("elements are nested more than {} deep", kMaxUrdfDepth)
                      : fmt::format("not well-formed XML ({})", document.ErrorName()));
    findings.raise();
  }
  check_everywhere(document, 0, findings);
  const tinyxml2::XMLElement* robot = document.RootElement();
  if (robot == nullptr || std::string_view(robot->Name()) != "robot") {
    findings.add(robot != nullptr ? robot->GetLineNum() : 0, "xml",
                 "the outermost element must be <robot>");
  } else if (robot->NextSiblingElement() != nullptr) {
    findings.add(robot->NextSiblingElement()->GetLineNum(), "xml",
                 "there is an element after </robot>");
  }
  findings.raise();

  int links = 0;
  for (const auto* e = robot->FirstChildElement("link"); e; e = e->NextSiblingElement("link")) {
    if (++links == kMaxUrdfLinks + 1) {
      findings.add(e->GetLineNum(), "too-many-links", fmt::format("at most {}", kMaxUrdfLinks));
    }
  }
  findings.raise();
  check_element(*robot, findings);
  findings.raise();

  Outline outline = outline_of(*robot, findings);
  if (count_movable(*robot) > kMaxJoints) {
    findings.add(robot->GetLineNum(), "too-many-joints",
                 fmt::format("{} movable joints, at most {}", count_movable(*robot), kMaxJoints));
  }
  findings.raise();
  check_tree(outline, findings);
  findings.raise();
  return outline;
}

}  // namespace stillbase::urdf
