#include "robot/urdf_tree.hpp"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include <stillbase/core/file.hpp>
#include <stillbase/robot/urdf_reader.hpp>

#include "robot/urdf_element.hpp"
#include "robot/xml_text.hpp"

namespace stillbase::urdf {

namespace {

constexpr const char* kWorld = "world";

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

/// Whether <!DOCTYPE robot> says no more than that: it neither defines nor includes anything.
bool names_document_alone(std::string_view declaration) {
  return declaration.starts_with("DOCTYPE ") &&
         declaration.find_first_not_of(" \t\r\n", 8) != std::string_view::npos &&
         declaration.find_first_of(" \t\r\n[\"'", declaration.find_first_not_of(" \t\r\n", 8)) ==
             std::string_view::npos;
}

// What is dangerous anywhere, also in elements that are ignored.
void check_everywhere(const tinyxml2::XMLNode& node, int depth, Findings& findings) {
  if (depth > kMaxUrdfDepth) {
    findings.add(node.GetLineNum(), "too-deep",
                 fmt::format("elements are nested more than {} deep", kMaxUrdfDepth));
    return;
  }
  for (const auto* n = node.FirstChild(); n != nullptr; n = n->NextSibling()) {
    if (n->ToUnknown() != nullptr && !names_document_alone(n->Value())) {
      findings.add(n->GetLineNum(), "doctype",
                   "document types and entity definitions are not allowed");
    }
    const auto* element = n->ToElement();
    if (element == nullptr) continue;
    check_everywhere(*element, depth + 1, findings);
  }
}

/// The links and joints of a text, or every finding about its form.
Tree read_document(std::string_view text, Findings& findings) {
  tinyxml2::XMLDocument document;
  parse_robot(text, document, findings);
  Tree tree;
  Element robot(*document.RootElement(), findings);
  tree.name = robot.text("name", false);
  if (tree.name.empty()) {
    robot.remark("robot-name", "<robot> without a name: it is called 'robot'");
    tree.name = "robot";
  }
  const std::string version = robot.text("version", false);
  if (robot.has("version") && version != "1" && !version.starts_with("1.")) {
    robot.remark("version", "<robot> version " + in_quotes(version) + ": is read as 1.0");
  }
  robot.each("link", 1, kAny, [&](Element& link) {
    tree.links.push_back(read_link(link));
    if (tree.links.size() == kMaxUrdfLinks + 1) {
      link.find("too-many-links", fmt::format("at most {}", kMaxUrdfLinks));
    }
  });
  for (const char* name : {"joint", "drake:joint"}) {
    robot.each(name, 0, kAny, [&](Element& joint) { tree.joints.push_back(read_joint(joint)); });
  }
  robot.ignore({"material"});
  robot.leave_out("gazebo", "what it says is for a simulator");
  read_transmissions(robot, tree.joints);
  robot.leave_out("ros2_control", "what it says is for a controller");
  robot.finish();
  findings.raise();
  return tree;
}

/// Some programs have a link `world` that no file states.
void add_implied_world(Tree& tree, Findings& findings) {
  const auto joint = std::find_if(tree.joints.begin(), tree.joints.end(),
                                  [](const TreeJoint& j) { return j.parent_name == kWorld; });
  const bool is_stated = std::any_of(tree.links.begin(), tree.links.end(),
                                     [](const TreeLink& link) { return link.name == kWorld; });
  if (joint == tree.joints.end() || is_stated) return;
  findings.remark(joint->line, "implied-world",
                  "the parent link 'world' is not stated: it has no mass and no shape");
  TreeLink world;
  world.line = joint->line;
  world.name = kWorld;
  tree.links.push_back(std::move(world));
}

bool has_mass(const TreeLink& link) {
  return link.inertial && (link.inertial->mass != 0 || !link.inertial->inertia.isZero(0));
}

/// A link `world` without mass and shapes that no joint names says nothing of the robot. Other
/// links that hang on nothing are roots of their own.
void drop_lone_world(Tree& tree, Findings& findings) {
  std::set<std::string> named;
  for (const TreeJoint& joint : tree.joints) named.insert({joint.parent_name, joint.child_name});
  const auto is_lone = [&](const TreeLink& link) {
    return link.name == kWorld && named.count(link.name) == 0 && !has_mass(link) &&
           link.shapes.empty() && link.meshes.empty();
  };
  if (std::all_of(tree.links.begin(), tree.links.end(), is_lone)) return;  // refused by its mass
  for (const TreeLink& link : tree.links) {
    if (!is_lone(link)) continue;
    findings.remark(link.line, "lone-link",
                    "link 'world' without mass and shapes that no joint names: left out");
  }
  tree.links.erase(std::remove_if(tree.links.begin(), tree.links.end(), is_lone), tree.links.end());
}

/// A floating or planar joint below links without mass, that no other joint moves, says what holds
/// for every robot here: the base floats.
void drop_free_root(Tree& tree, Findings& findings) {
  const auto free = std::find_if(tree.joints.begin(), tree.joints.end(),
                                 [](const TreeJoint& joint) { return joint.is_free; });
  if (free == tree.joints.end()) return;
  std::map<std::string, const TreeJoint*> above;  // by the child
  for (const TreeJoint& joint : tree.joints) above.emplace(joint.child_name, &joint);
  const auto is_below = [&](std::string link) {
    for (std::size_t steps = 0; steps <= tree.joints.size(); ++steps) {
      const auto joint = above.find(link);
      if (joint == above.end()) return false;
      if (joint->second == &*free) return true;
      link = joint->second->parent_name;
    }
    return false;
  };
  std::set<std::string> dropped;
  bool floats = true;
  for (const TreeLink& link : tree.links) {
    if (is_below(link.name)) continue;
    dropped.insert(link.name);
    floats = floats && !has_mass(link);
  }
  for (const TreeJoint& joint : tree.joints) {
    const bool stays = dropped.count(joint.child_name) == 0;
    floats = floats && (&joint == &*free || (stays ? !joint.is_free : joint.is_fixed));
  }
  if (!floats || dropped.size() == tree.links.size()) {
    findings.add(free->line, "joint-type",
                 fmt::format("joint {} has several degrees of freedom: only the base floats; "
                             "allowed: revolute continuous prismatic fixed",
                             in_quotes(free->joint.name)));
    findings.raise();
  }
  findings.remark(free->line, "free-root",
                  fmt::format("link {} and the floating joint below it: left out, every base "
                              "floats",
                              in_quotes(free->parent_name)));
  const TreeJoint* const floating = &*free;
  std::vector<TreeJoint> joints;
  for (TreeJoint& joint : tree.joints) {
    if (&joint != floating && dropped.count(joint.child_name) == 0) joints.push_back(joint);
  }
  tree.joints = std::move(joints);
  const auto is_dropped = [&](const TreeLink& link) { return dropped.count(link.name) > 0; };
  tree.links.erase(std::remove_if(tree.links.begin(), tree.links.end(), is_dropped),
                   tree.links.end());
}

/// The links without mass that fixed joints join to `link`, and the joints that leave them; nothing
/// where one of them has a mass.
struct MasslessGroup {
  std::set<std::string> links;
  std::vector<const TreeJoint*> leaving;
};
std::optional<MasslessGroup> massless_group(const Tree& tree, const std::string& link) {
  MasslessGroup group;
  std::vector<std::string> open = {link};
  while (!open.empty()) {
    const std::string name = open.back();
    open.pop_back();
    if (!group.links.insert(name).second) continue;
    const auto stated = std::find_if(tree.links.begin(), tree.links.end(),
                                     [&](const TreeLink& other) { return other.name == name; });
    if (stated == tree.links.end() || has_mass(*stated)) return std::nullopt;
    for (const TreeJoint& joint : tree.joints) {
      if (joint.parent_name != name) continue;
      if (joint.is_fixed) {
        open.push_back(joint.child_name);
      } else {
        group.leaving.push_back(&joint);
      }
    }
  }
  return group;
}

/// Slides and turns between links without mass, from the root to the first link with one, say what
/// a floating or planar joint says: the base floats. Asked for are three joints, two of them
/// slides.
void drop_virtual_base(Tree& tree, Findings& findings) {
  std::set<std::string> children, dropped;
  for (const TreeJoint& joint : tree.joints) children.insert(joint.child_name);
  const auto root = std::find_if(tree.links.begin(), tree.links.end(), [&](const TreeLink& link) {
    return children.count(link.name) == 0;
  });
  if (root == tree.links.end()) return;
  std::vector<const TreeJoint*> passed;
  std::string base = root->name;
  while (const auto group = massless_group(tree, base)) {
    if (group->leaving.size() != 1 || dropped.count(base) > 0) return;
    dropped.insert(group->links.begin(), group->links.end());
    passed.push_back(group->leaving.front());
    base = passed.back()->child_name;
  }
  const auto slides = std::count_if(passed.begin(), passed.end(), [](const TreeJoint* joint) {
    return joint->joint.is_prismatic();
  });
  const bool leaves_no_arm =
      std::none_of(tree.joints.begin(), tree.joints.end(), [&](const TreeJoint& j) {
        return !j.is_fixed && std::find(passed.begin(), passed.end(), &j) == passed.end();
      });
  if (passed.size() < 3 || slides < 2 || leaves_no_arm) return;
  findings.remark(passed.front()->line, "free-root",
                  fmt::format("links without mass above {} and the {} joints between them: left "
                              "out, every base floats",
                              in_quotes(base), passed.size()));
  std::vector<TreeJoint> joints;
  for (const TreeJoint& joint : tree.joints) {
    if (dropped.count(joint.parent_name) == 0) joints.push_back(joint);
  }
  tree.joints = std::move(joints);
  const auto is_dropped = [&](const TreeLink& link) { return dropped.count(link.name) > 0; };
  tree.links.erase(std::remove_if(tree.links.begin(), tree.links.end(), is_dropped),
                   tree.links.end());
}

/// A joint without range, as exporters write for one that nobody measured, moves nothing. With no
/// mass behind it, it is a fixed one.
void fix_idle_joints(Tree& tree, Findings& findings) {
  for (std::size_t j = 0; j < tree.joints.size(); ++j) {
    const TreeJoint& joint = tree.joints[j];
    const bool is_idle = !joint.is_fixed && !joint.mimic &&
                         joint.joint.type != JointType::Continuous &&
                         joint.joint.lower == joint.joint.upper;
    if (!is_idle || !massless_group(tree, joint.child_name)) continue;
    findings.remark(joint.line, "idle-joint", "joint without range that moves no mass: it is fixed",
                    joint.joint.name);
    lock(tree, j, joint.joint.lower);
  }
}

/// Follows couplings of couplings to a joint that moves by itself. A coupled joint whose master
/// cannot move is fixed.
void follow_couplings(Tree& tree, Findings& findings) {
  const auto index_of = [&](const std::string& name) {
    const auto found = std::find_if(tree.joints.begin(), tree.joints.end(),
                                    [&](const TreeJoint& j) { return j.joint.name == name; });
    return static_cast<std::size_t>(found - tree.joints.begin());
  };
  for (std::size_t j = 0; j < tree.joints.size(); ++j) {
    TreeJoint& joint = tree.joints[j];
    if (!joint.mimic) continue;
    Mimic& mimic = *joint.mimic;
    const auto refuse = [&](const std::string& what) {
      findings.add(joint.line, "mimic",
                   fmt::format("joint {}: {}", in_quotes(joint.joint.name), what));
    };
    for (std::size_t steps = 0;; ++steps) {
      const std::size_t m = index_of(mimic.master);
      if (m == tree.joints.size()) {
        refuse(fmt::format("there is no joint {} that it could follow", in_quotes(mimic.master)));
        break;
      }
      if (steps > tree.joints.size()) {
        refuse("the joints that it follows follow each other in a circle");
        break;
      }
      const TreeJoint& master = tree.joints[m];
      if (!master.mimic) break;
      mimic.offset += mimic.ratio * master.mimic->offset;
      mimic.ratio *= master.mimic->ratio;
      mimic.master = master.mimic->master;
    }
  }
  findings.raise();
  for (std::size_t j = 0; j < tree.joints.size(); ++j) {
    const TreeJoint& joint = tree.joints[j];
    if (!joint.mimic) continue;
    const bool has_still_master = tree.joints[index_of(joint.mimic->master)].is_fixed;
    if (!has_still_master && joint.mimic->ratio != 0) continue;
    findings.remark(joint.line, "mimic",
                    "<mimic> of a joint that does not move: the coupled joint is fixed",
                    joint.joint.name);
    lock(tree, j, joint.mimic->offset);
  }
}

/// Finds how links and joints hang together; every name once, every link with one parent.
void connect(Tree& tree, Findings& findings) {
  std::map<std::string, int> index, joint_names;
  const auto add_name = [&](std::map<std::string, int>& names, const char* kind,
                            const std::string& name, int line, int i) {
    if (names.emplace(name, i).second) return;
    findings.add(line, "duplicate-name",
                 fmt::format("there is already a {} {}", kind, in_quotes(name)));
  };
  for (std::size_t i = 0; i < tree.links.size(); ++i) {
    add_name(index, "link", tree.links[i].name, tree.links[i].line, static_cast<int>(i));
  }
  for (int j = 0; j < static_cast<int>(tree.joints.size()); ++j) {
    TreeJoint& joint = tree.joints[j];
    add_name(joint_names, "joint", joint.joint.name, joint.line, j);
    const auto link_of = [&](const std::string& link) {
      const auto found = index.find(link);
      if (found != index.end()) return found->second;
      findings.add(joint.line, "unknown-link",
                   fmt::format("joint {}: there is no link {}", in_quotes(joint.joint.name),
                               in_quotes(link)));
      return -1;
    };
    joint.parent = link_of(joint.parent_name);
    joint.child = link_of(joint.child_name);
    if (joint.parent < 0 || joint.child < 0) continue;
    tree.links[joint.parent].child_joints.push_back(j);
    int& parent_joint = tree.links[joint.child].parent_joint;
    if (parent_joint >= 0) {
      findings.add(
          joint.line, "two-parents",
          fmt::format("link {} is already the child of joint {}", in_quotes(joint.child_name),
                      in_quotes(tree.joints[parent_joint].joint.name)));
    }
    parent_joint = j;
  }
  findings.raise();
}

/// Finds the root. Every link has at most one parent here, so a link that no root reaches hangs on
/// a cycle.
void find_root(Tree& tree, Findings& findings) {
  std::vector<int> open;
  std::vector<bool> reached(tree.links.size(), false);
  for (int i = 0; i < static_cast<int>(tree.links.size()); ++i) {
    const TreeLink& link = tree.links[i];
    if (link.parent_joint >= 0) continue;
    open.push_back(i);
    if (tree.root < 0) {
      tree.root = i;
    } else {
      findings.add(link.line, "two-roots",
                   fmt::format("links {} and {} both have no parent: one robot has one base",
                               in_quotes(tree.links[tree.root].name), in_quotes(link.name)));
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
    findings.add(tree.links[i].line, "cycle",
                 fmt::format("link {} is not connected to the base: its joints form a cycle",
                             in_quotes(tree.links[i].name)));
  }
  findings.raise();
}

}  // namespace

void parse_robot(std::string_view text, tinyxml2::XMLDocument& document, Findings& findings) {
  const std::optional<std::string> decoded = as_utf8(text, findings);
  if (decoded) text = *decoded;
  check_text(text, findings);
  findings.raise();
  if (document.Parse(text.data(), text.size()) == tinyxml2::XML_ERROR_PARSING_DECLARATION) {
    const std::string plain = without_instructions(text);
    document.Parse(plain.data(), plain.size());
  }
  if (document.Error()) {
    if (text.starts_with("version https://git-lfs")) {
      findings.add(1, "xml", "a pointer of Git LFS, not the file: `git lfs pull` fetches it");
      findings.raise();
    }
    const bool deep = document.ErrorID() == tinyxml2::XML_ELEMENT_DEPTH_EXCEEDED;
    findings.add(document.ErrorLineNum(), deep ? "too-deep" : "xml",
                 deep ? fmt::format("elements are nested more than {} deep", kMaxUrdfDepth)
                      : fmt::format("not well-formed XML ({})", document.ErrorName()));
    findings.raise();
  }
  check_everywhere(document, 0, findings);
  const tinyxml2::XMLElement* root = document.RootElement();
  if (root == nullptr || std::string_view(root->Name()) != "robot") {
    findings.add(root != nullptr ? root->GetLineNum() : 0, "xml",
                 fmt::format("the outermost element must be <robot>{}",
                             root != nullptr ? ", not " + in_quotes(root->Name()) : ""));
  } else if (root->NextSiblingElement() != nullptr) {
    findings.add(root->NextSiblingElement()->GetLineNum(), "xml",
                 "there is an element after </robot>");
  }
  findings.raise();
}

Tree read_tree(std::string_view text, Findings& findings) {
  Tree tree = read_document(text, findings);
  add_implied_world(tree, findings);
  drop_lone_world(tree, findings);
  drop_free_root(tree, findings);
  drop_virtual_base(tree, findings);
  connect(tree, findings);
  find_root(tree, findings);
  follow_couplings(tree, findings);
  fix_idle_joints(tree, findings);
  return tree;
}

void lock(Tree& tree, std::size_t j, double position) {
  TreeJoint& joint = tree.joints[j];
  Pose motion;
  const Vector3d axis = joint.axis.stableNormalized();
  if (joint.joint.is_prismatic()) {
    motion.position = position * axis;
  } else {
    motion.orientation = rotation_exp(position * axis);
  }
  joint.origin = joint.origin * motion;
  joint.is_fixed = true;
  joint.mimic.reset();
  const std::string name = joint.joint.name;
  for (std::size_t k = 0; k < tree.joints.size(); ++k) {
    const auto& mimic = tree.joints[k].mimic;
    if (mimic && mimic->master == name) lock(tree, k, mimic->ratio * position + mimic->offset);
  }
}

}  // namespace stillbase::urdf
