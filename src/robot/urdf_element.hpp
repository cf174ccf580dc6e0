// An element of a URDF file that is read: values are checked as they are asked for, and what was
// not asked for is remarked upon in the end.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <tinyxml2.h>

#include <stillbase/core/types.hpp>

#include "robot/urdf_findings.hpp"
#include "robot/urdf_tree.hpp"

namespace stillbase::urdf {

enum class Sign { Any, NonNegative };

class Element {
 public:
  Element(const tinyxml2::XMLElement& xml, Findings& findings) : xml_(xml), findings_(findings) {}

  int line() const { return xml_.GetLineNum(); }
  void find(std::string rule, std::string message) {
    report(line(), std::move(rule), std::move(message));
  }
  /// From here on, what is wrong with this element is remarked upon: it is neither a mass nor a
  /// place.
  void only_remark() { only_remarks_ = true; }

  void remark(const std::string& rule, const std::string& message,
              const std::string& subject = {}) {
    findings_.remark(line(), rule, message, subject);
  }

  bool has(const char* attribute) const { return xml_.Attribute(attribute) != nullptr; }
  /// A required text must not be empty, and none may hold what xacro would replace.
  std::string text(const char* attribute, bool required);
  /// A path with slashes, also where the file has backslashes; `$(find PACKAGE)` of xacro in front
  /// is read as `package://PACKAGE`. Empty after a finding.
  std::string path(const char* attribute);
  /// One finite number. NaN after a finding.
  /// @param otherwise without the attribute; nothing: it is required
  double number(const char* attribute, Sign sign, std::optional<double> otherwise = {});
  /// A limit: `inf` and sizes of kLargestNumber and more, as other formats write for none, are
  /// infinite. 0 without the attribute.
  double limit(const char* attribute);
  /// How far the number of an attribute may lie from the one that was rounded to its digits: half
  /// a unit of the last one. 0: there is no number, or it is zero.
  double rounding(const char* attribute) const;
  /// Three finite numbers, alike.
  Vector3d vector(const char* attribute, Sign sign, const std::optional<Vector3d>& otherwise = {});

  /// Factors along three axes, or one for all of them; 1 without the attribute.
  Vector3d scale(const char* attribute);

  /// Any finite numbers between blanks; a required attribute.
  std::vector<double> numbers(const char* attribute);

  /// Reads the children of this name, in file order; there must be `least` to `most` of them. One
  /// more that says the same as the first is remarked upon.
  template <class Read>
  void each(const char* name, int least, int most, Read read) {
    int count = 0;
    for (const auto* e = xml_.FirstChildElement(name); e; e = e->NextSiblingElement(name)) {
      Element child(*e, findings_);
      if (++count > most && child.says_the_same(*xml_.FirstChildElement(name))) {
        child.remark("repeated-element", tag() + " holds the same <" + name + "> twice");
        continue;
      }
      if (count == most + 1) {
        child.find("repeated-element", tag() + " holds more than one <" + name + ">");
      }
      read(child);
      child.finish();
    }
    if (count < least) find("missing-element", tag() + " needs a <" + name + ">");
    children_.emplace_back(name);
  }
  /// Reads the first child of this name, if there is one, as other readers of the format do. What
  /// is stated again is remarked upon: it is neither a mass nor a place.
  template <class Read>
  void first(const char* name, Read read) {
    const auto* const stated = xml_.FirstChildElement(name);
    for (const auto* e = stated; e != nullptr; e = e->NextSiblingElement(name)) {
      Element child(*e, findings_);
      if (e == stated) {
        read(child);
        child.finish();
      } else {
        child.remark("repeated-element", tag() + " holds <" + name + "> again: the first is read");
      }
    }
    children_.emplace_back(name);
  }
  /// The same of any number of children, of which what is not asked for needs no remark.
  template <class Read>
  void look_into(const char* name, Read read) {
    for (const auto* e = xml_.FirstChildElement(name); e; e = e->NextSiblingElement(name)) {
      Element child(*e, findings_);
      read(child);
    }
    children_.emplace_back(name);
  }
  /// Children that are not read and not worth a remark.
  void ignore(std::initializer_list<std::string_view> names) {
    children_.insert(children_.end(), names);
  }
  /// Children of this name are not read: a remark with the reason.
  void leave_out(const char* name, const std::string& reason);
  /// Remarks on attributes, elements and text that nobody asked for.
  void finish();
  std::string tag() const { return std::string("<") + xml_.Name() + ">"; }

 private:
  bool says_the_same(const tinyxml2::XMLElement& other) const;
  /// The text of an attribute; null, and a finding where it is required, without it.
  const char* value(const char* attribute, bool required);
  double parse(const char* attribute, std::string_view text, std::string_view part, Sign sign,
               bool is_limit = false);
  void find_in(const char* attribute, std::string rule, const std::string& message);
  void report(int line, std::string rule, std::string message);

  const tinyxml2::XMLElement& xml_;
  Findings& findings_;
  bool only_remarks_ = false;
  std::vector<std::string_view> attributes_, children_;  ///< asked for
};

inline constexpr int kAny = 1 << 20;  ///< number of elements

using MaterialColors = std::map<std::string, Vector3d>;

/// A shape or a mesh of a <visual>.
struct VisualPart {
  std::optional<std::pair<Pose, Geometry>> shape;  ///< in the link
  std::optional<MeshUse> mesh;
  std::optional<Vector3d> color;
};

/// Parses a text whose outermost element is <robot>.
/// @throws InputError too large, not UTF-8, not well-formed, too deep, document types
void parse_robot(std::string_view text, tinyxml2::XMLDocument& document, Findings& findings);

TreeLink read_link(Element& element);
/// What is drawn of a <link>, which read_link() leaves out: the shapes and meshes of its <visual>,
/// in file order. A material that is named alone takes the colour of the one of that name.
/// @param colors by the names of materials; those of the link join them
std::vector<VisualPart> read_visuals(Element& link, MaterialColors& colors);
/// The colour of a <material>, if it states one: red, green, blue from 0 to 1.
std::optional<Vector3d> read_color(Element& material);
TreeJoint read_joint(Element& element);
/// The drives of the <transmission> elements of a robot, in the words of Drake:
/// `drake:rotor_inertia` and `drake:gear_ratio` of the <actuator>, each with a `value`.
/// @param joints of the file, to which the drives are added
void read_transmissions(Element& robot, std::vector<TreeJoint>& joints);
/// The pose of the <origin> of a parent: fixed axes roll, pitch, yaw.
Pose read_origin(Element& parent);

}  // namespace stillbase::urdf
