// stillbase export: what a plan says, as files of other programs.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <memory>

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/export/export.hpp>
#include <stillbase/io/plan_file.hpp>

#include "app/command_line.hpp"

namespace stillbase::app {

namespace {

struct ExportRequest {
  std::string plan, format, object = "robot";
  EphemerisOptions ephemeris;
  OutputFile output;
};

struct ExportFormat {
  std::string name;
  std::vector<std::string> endings;
  std::string about;
  std::function<std::string(const Plan&, const EphemerisOptions&)> write;
};

const std::vector<ExportFormat>& export_formats() {
  using Options = EphemerisOptions;
  static const std::vector<ExportFormat> formats{
      {"csv",
       {".csv"},
       "joints, base and target over the approach",
       [](const Plan& plan, const Options&) { return trajectory_csv(plan); }},
      {"ros",
       {".yaml", ".yml"},
       "joints as trajectory_msgs/JointTrajectory",
       [](const Plan& plan, const Options&) { return ros_trajectory(plan); }},
      {"aem", {".aem"}, "attitude of base or target, CCSDS AEM 2.0", attitude_ephemeris},
      {"oem", {".oem"}, "position of base or target, CCSDS OEM 2.0", orbit_ephemeris},
      {"mat",
       {".mat"},
       "all arrays of the plan, MATLAB level 5",
       [](const Plan& plan, const Options&) { return matlab_file(plan); }},
      {"urdf",
       {".urdf"},
       "the robot, masses of rigidly joined links merged",
       [](const Plan& plan, const Options&) {
         const CaptureProblem& problem = plan.problem;
         // What was put together, with its meshes, hulls and coupled joints, is a text already.
         const bool is_text = !problem.parts.arms.empty() || problem.robot.is_coupled();
         return is_text ? problem.urdf : robot_urdf(problem.robot);
       }}};
  return formats;
}

std::vector<std::string> format_words() {
  std::vector<std::string> words;
  for (const ExportFormat& format : export_formats()) words.push_back(format.name);
  return words;
}

const ExportFormat& format_of(const ExportRequest& request) {
  const auto& formats = export_formats();
  if (!request.format.empty()) {
    check_known("--format " + request.format, request.format, format_words());
    return *std::find_if(formats.begin(), formats.end(),
                         [&](const ExportFormat& format) { return format.name == request.format; });
  }
  if (!request.output.is_given()) {
    throw CommandLineError("export: -o FILE, or --format for the standard output");
  }
  std::vector<std::string> endings;
  for (const ExportFormat& format : formats) {
    for (const std::string& ending : format.endings) {
      if (ending == extension_of(request.output.path)) return format;
      endings.push_back(ending);
    }
  }
  throw CommandLineError(fmt::format("{}: this command writes {}; other endings with --format",
                                     request.output.path, fmt::join(endings, ", ")));
}

/// Now in UTC, or what SOURCE_DATE_EPOCH says, so that builds can be repeated byte by byte.
std::string creation_date() {
  std::time_t seconds = std::chrono::system_clock::to_time_t(std::chrono::system_clock::now());
  if (const char* stated = std::getenv("SOURCE_DATE_EPOCH")) {
    char* end = nullptr;
    const long long value = std::strtoll(stated, &end, 10);
    // The last second of the year 2199: later ones have no form in the messages.
    if (end == stated || *end != '\0' || value < 0 || value > 7258118399) {
      throw CommandLineError("SOURCE_DATE_EPOCH: must be seconds since 1970");
    }
    seconds = static_cast<std::time_t>(value);
  }
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}", fmt::gmtime(seconds));
}

int export_plan(ExportRequest request) {
  const ExportFormat& format = format_of(request);
  check_known("--object " + request.object, request.object, {"robot", "target"});
  request.ephemeris.body =
      request.object == "target" ? EphemerisBody::Target : EphemerisBody::Robot;
  request.ephemeris.creation_date = creation_date();
  request.output.check();
  const Plan plan = load_plan(request.plan).plan;
  std::string content;
  try {
    content = format.write(plan, request.ephemeris);
  } catch (const InputError& error) {
    std::vector<Finding> findings = error.findings();
    for (Finding& finding : findings) {
      finding.file = request.plan;
    }
    throw InputError(findings);
  } catch (const std::invalid_argument& error) {
    throw CommandLineError(std::string("export: ") + error.what());
  }
  request.output.write(content);
  if (request.output.is_given()) {
    say(fmt::format("written to {}: {}", request.output.path, format.about));
  }
  return kDone;
}

}  // namespace

Command export_command() {
  auto request = std::make_shared<ExportRequest>();
  std::vector<std::string> lines;
  for (const ExportFormat& format : export_formats()) {
    lines.push_back(fmt::format("{} {}", fmt::join(format.endings, " "), format.about));
  }
  return {
      "export",
      fmt::format("a plan for other programs, by the ending of the file: {}",
                  fmt::join(lines, "; ")),
      std::vector<Option>{{"plan", "PLAN.json", "plan file (JSON)", &request->plan, true},
                          {.name = "--format",
                           .value = "NAME",
                           .about = "in place of the ending: csv, ros, aem, oem, mat, urdf",
                           .target = &request->format,
                           .words = format_words()},
                          {.name = "--object",
                           .value = "NAME",
                           .about = "robot or target: whose motion an AEM or OEM has",
                           .target = &request->object,
                           .words = {"robot", "target"}},
                          {"--epoch", "DATE",
                           "of an AEM or OEM: TAI at time 0 of the plan, which knows no calendar",
                           &request->ephemeris.epoch},
                          {"--ref-frame", "NAME", "of an AEM or OEM: name of the inertial frame N",
                           &request->ephemeris.frame},
                          {"--center", "NAME", "of an AEM or OEM: name of the origin of N",
                           &request->ephemeris.center}} +
          output_options(request->output, "-o,--output", "file; with --format also stdout"),
      [request] { return export_plan(*request); }};
}

}  // namespace stillbase::app
