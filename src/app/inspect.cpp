// stillbase inspect: every matrix of a robot at one state, in the base frame.
#include <memory>
#include <optional>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/io/state_file.hpp>

#include "app/command_line.hpp"
#include "app/words.hpp"
#include "io/fields/results.hpp"

namespace stillbase::app {

namespace {

using io::Json;

struct InspectRequest {
  std::string robot, hand, state;
  OutputFile output;
  bool json = false;
};

/// The fields of a table as text: name and meaning above the numbers.
class Listing : public io::TableWriter {
 public:
  std::string text;
  void operator()(const std::string& key, const io::Value& value, std::string_view meaning,
                  const io::About& about = {}) override {
    io::TableWriter::operator()(key, value, meaning, about);
    const Json* x = json.find(key);
    if (x == nullptr || key == "joint_names" || key == "total_mass") return;
    if (x->is_object()) {
      text += key + "\n" + io::pretty(*x);
    } else if (!x->is_array()) {
      text += fmt::format("{}: {}\n", meaning, x->dump());
    } else {
      const std::string unit = about.unit.empty() ? "" : ", " + about.unit;
      text += fmt::format("{} ({}{})\n", key, meaning, unit);
      const bool is_matrix = !x->empty() && x->at(std::size_t{0}).is_array();
      for (const Json& row : is_matrix ? *x : Json::array({*x})) add_row(row);
    }
  }

 private:
  void add_row(const Json& row) {
    text += "   ";
    for (const Json& x : row) {
      text += fmt::format(" {:>11.5g}", x.get<double>() + 0.0);  // no sign of a zero
    }
    text += '\n';
  }
};

int inspect_robot(const InspectRequest& request) {
  request.output.check({".json", ".txt"});
  const RobotModel robot = load_robot(request.robot, request.hand, {.may_lack_base = true});
  const RobotState state = request.state.empty()
                               ? zero_state(robot)
                               : read_state(read_text_file(request.state), request.state, robot);
  if (robot.base.mass == 0) {
    say(fmt::format("{}: the base has no mass: what needs the inverse of its inertia is left out",
                    request.robot));
  }
  Listing listing;
  try {
    io::inspection_fields(listing, robot, state);
  } catch (const io::NotFiniteError&) {
    // Numbers of a file that are finite alone but not in products with each other.
    throw InputError({{request.state.empty() ? request.robot : request.state, 0, "not-finite",
                       "the matrices at this state do not fit a double"}});
  }
  const bool as_json = request.json || extension_of(request.output.path) == ".json";
  request.output.write(
      as_json ? io::pretty(listing.json)
              : fmt::format("robot {}, hand {}, {:.6g} kg; everything in the base frame (origin at "
                            "the base body's centroid), SI units\nposture: {}\n{}",
                            robot.name, robot.hand, robot.total_mass(),
                            posture_words(robot, state.phi), listing.text));
  return kDone;
}

}  // namespace

Command inspect_command() {
  auto request = std::make_shared<InspectRequest>();
  return {
      "inspect", "print the dynamics and impact matrices of a robot",
      std::vector<Option>{
          {"robot", "ROBOT.urdf", "robot file (URDF)", &request->robot, true},
          {"--hand", "LINK", "hand link; needed when there are several ends", &request->hand},
          {"--state", "STATE.json", "joint positions, velocities, impulse (JSON)", &request->state},
          {"--json", "", "print one JSON object", &request->json}} +
          output_options(request->output, "-o,--output",
                         "matrices as .json, or as text (.txt); without it stdout"),
      [request] { return inspect_robot(*request); }};
}

}  // namespace stillbase::app
