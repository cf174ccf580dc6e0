// Unit, frame and shape that the schema of plans states, against plans that are written.
#include <catch2/catch.hpp>

#include <map>
#include <set>
#include <sstream>

#include <nlohmann/json.hpp>

#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/io/schema.hpp>
#include <stillbase/planner/planner.hpp>

using namespace stillbase;

namespace {

using Members = std::map<std::string, Member>;

Members plan_members() {
  Members members;
  for (const Member& member : members_of("plan")) members[member.path] = member;
  return members;
}

/// Extents of nested lists of numbers; fails for rows of different lengths.
std::vector<std::size_t> extents_of(const nlohmann::json& value) {
  std::vector<std::size_t> extents;
  if (!value.is_array()) return extents;
  extents.push_back(value.size());
  for (const nlohmann::json& item : value) REQUIRE(extents_of(item) == extents_of(value.at(0)));
  if (!value.empty()) {
    for (const std::size_t inner : extents_of(value.at(0))) extents.push_back(inner);
  }
  return extents;
}

bool fits(const std::vector<std::size_t>& extents, const std::string& shape, std::size_t n) {
  std::istringstream stream(shape);
  std::vector<std::string> words;
  for (std::string word; stream >> word;) {
    if (word != "x") words.push_back(word);
  }
  // An empty list shows no more extents.
  if (extents.size() > words.size()) return false;
  if (extents.size() < words.size() && (extents.empty() || extents.back() != 0)) return false;
  for (std::size_t i = 0; i < extents.size(); ++i) {
    if (words[i] != "k" && extents[i] != (words[i] == "n" ? n : std::stoul(words[i]))) return false;
  }
  return true;
}

bool holds_numbers(const nlohmann::json& value) {
  if (value.is_array()) return !value.empty() && holds_numbers(value.at(0));
  return value.is_number();
}

/// Vectors in space: they say nothing without a frame.
bool is_spatial(const std::string& shape) {
  return shape == "3" || shape == "6" || shape == "k x 3" || shape == "k x 6";
}

class Walk {
 public:
  explicit Walk(std::size_t n) : n_(n) {}

  void over(const nlohmann::json& value, const std::string& path) {
    const bool is_list = value.is_array() && !value.empty() && value.at(0).is_object();
    if (is_list) {
      for (const nlohmann::json& item : value) over(item, path + "[]");
      return;
    }
    const auto known = members_.find(path);
    const auto inner = members_.lower_bound(path + ".");
    const bool has_inner =
        path.empty() || (inner != members_.end() && inner->first.rfind(path + ".", 0) == 0);
    if (value.is_object() && has_inner) {
      for (const auto& [key, item] : value.items())
        over(item, path.empty() ? key : path + "." + key);
      return;
    }
    if (value.is_object()) {  // a dictionary: its keys are no members of the schema
      for (const nlohmann::json& item : value) check(item, known->second);
      return;
    }
    INFO(path);
    if (value.is_array() && value.empty()) return;
    if (value.is_null()) return;
    REQUIRE(known != members_.end());
    check(value, known->second);
  }

  std::set<std::string> seen;

 private:
  void check(const nlohmann::json& value, const Member& member) {
    INFO(member.path << ": " << value.dump().substr(0, 80));
    seen.insert(member.path);
    if (!holds_numbers(value)) return;
    CHECK_FALSE(member.unit.empty());
    if (value.is_array()) {
      INFO("shape " << member.shape);
      CHECK(fits(extents_of(value), member.shape, n_));
      if (is_spatial(member.shape)) CHECK_FALSE(member.frame.empty());
    }
  }

  Members members_ = plan_members();
  std::size_t n_;
};

}  // namespace

TEST_CASE("every number of a written plan has a unit, every array a shape, every vector a frame") {
  std::set<std::string> seen;
  for (const char* name :
       {"planar_two_link_c2_a", "planar_three_link_client", "spart_given_push",
        "servicer_compromise", "iiwa_client_50", "mounted_six_joint", "mounted_two_arms"}) {
    INFO(name);
    CaptureProblem problem =
        read_problem(std::string(STILLBASE_SOURCE_DIR) + "/problems/" + name + ".yaml");
    problem.search.starts = std::min(problem.search.starts, 64);
    const Plan plan = make_plan(problem);
    const nlohmann::json file =
        nlohmann::json::parse(plan_to_json(plan, {}, {}, {{"problem", "p.yaml", "00"}}));
    Walk walk(static_cast<std::size_t>(problem.robot.n()));
    walk.over(file, "");
    seen.merge(walk.seen);
  }
  CHECK(seen.size() > 120);
}

TEST_CASE("shapes and units of the approach are those of the documentation") {
  const Members members = plan_members();
  const auto is = [&members](const std::string& path, const std::string& unit,
                             const std::string& frame, const std::string& shape) {
    INFO(path);
    REQUIRE(members.count(path) == 1);
    const Member& member = members.at(path);
    CHECK(member.unit == unit);
    CHECK(member.frame == frame);
    CHECK(member.shape == shape);
  };
  is("approach.times", "s", "", "k");
  is("approach.joint_positions", "rad (m)", "", "k x n");
  is("approach.base_velocities", "m/s, rad/s", "B", "k x 6");
  is("approach.base_poses[].position", "m", "N", "3");
  is("approach.base_poses[].orientation.w", "1", "N", "");
  is("impact.impulse.moment", "N m s", "B", "3");
  is("configuration.joint_positions", "rad (m)", "", "n");
  is("certificate.starts", "1", "", "");
  is("problem.target.state.linear_velocity", "m/s", "N", "3");
  is("timing", "s", "", "");
}
