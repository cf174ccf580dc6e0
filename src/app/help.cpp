// stillbase help: topics that concern several commands.
#include "app/help.hpp"

#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include <stillbase/approach/approach.hpp>
#include <stillbase/io/schema.hpp>
#include <stillbase/nlp/optimizer.hpp>
#include <stillbase/plan/quantities.hpp>
#include <stillbase/simulation/controllers.hpp>

#include "io/names.hpp"
#include "io/scalars.hpp"
#include "io/units.hpp"

namespace stillbase::app {

namespace {

using Sentence = std::pair<std::string, std::string>;

std::string table(const std::vector<Sentence>& rows) {
  std::size_t width = 0;
  for (const auto& row : rows) width = std::max(width, row.first.size());
  std::string text;
  for (const auto& [name, sentence] : rows) {
    text += fmt::format("  {:<{}}  {}\n", name, width, sentence);
  }
  return text;
}

/// The words in the order of their registry, each with its sentence.
std::string described_words(const std::vector<std::string>& words,
                            const std::vector<Sentence>& sentences) {
  std::vector<Sentence> rows;
  for (const std::string& word : words) {
    const auto found = std::find_if(sentences.begin(), sentences.end(),
                                    [&word](const Sentence& s) { return s.first == word; });
    rows.emplace_back(word, found == sentences.end() ? "" : found->second);
  }
  return table(rows);
}

std::string files_text() {
  std::vector<Sentence> rows;
  for (const FileFormat& format : file_formats()) {
    rows.emplace_back(format.name, format.description.substr(0, format.description.find(". ")));
  }
  return "Robots are URDF (.urdf). Problems, targets, campaigns and suites are YAML (.yaml); "
         "states,\n"
         "plans and all results are JSON (.json). `stillbase schema NAME` prints the JSON Schema "
         "of:\n\n" +
         table(rows) +
         "\nA command writes by the ending of its output file and refuses an ending that it "
         "cannot\n"
         "write. An existing file is replaced only with --force. Files appear whole or not at "
         "all.\n";
}

std::string units_text() {
  std::vector<Sentence> rows;
  for (int i = 1; i <= static_cast<int>(io::Dimension::LinearDamping); ++i) {
    const auto dimension = static_cast<io::Dimension>(i);
    rows.emplace_back(io::name_of(dimension), io::units_of(dimension));
  }
  return "A number without a unit is in SI units and radians (the first unit of each line). A "
         "text\n"
         "with a unit is converted: 5 deg/s, 200 mm.\n\n" +
         table(rows);
}

std::string frames_text() {
  return table({{"N", "inertial frame of the problem; times are seconds of one clock"},
                {"B", "base frame: origin at the base body's centroid, axes of the root link"},
                {"T", "target frame: origin at the target's centroid"},
                {"hand", "frame of the hand link of the robot file"}}) +
         "\nVelocities and wrenches have the linear part first. A pose T_NB takes vectors of B to "
         "N.\n"
         "Quaternions are w, x, y, z with w the scalar part.\n";
}

std::string optimizers_text() {
  std::vector<Sentence> rows;
  for (const std::string& name : nlp::optimizer_names()) {
    rows.emplace_back(name, nlp::make_optimizer(name)->info().about);
  }
  return table(rows) + "\n`stillbase bench --list` says what each needs.\n";
}

std::string controllers_text() {
  return described_words(
      controller_names(),
      {{"none", "no torque"},
       {"joint_damping", "damps the joint rates, equation (19) scaled by the inertia"},
       {"joint_damping_literal", "damps the joint rates, equation (19) as printed"},
       {"rns", "moves the base's angular momentum to the arm, equation (24) without damping"},
       {"rns_damped", "rns with damping in the reaction null space, equation (24)"},
       {"rns_handback", "rns_damped first, then the momentum goes back to the base"},
       {"detumble", "joints and base to rest in least time, the momentum to the wheels"}});
}

std::string contact_text() {
  return "impact.source, where the impulse on the hand comes from:\n" +
         described_words(io::words_of(io::kImpulseSourceNames),
                         {{"given", "magnitude, direction and moment are stated"},
                          {"point_mass", "p = (1+e) v_n / (n' W_h n + 1/m_t)"},
                          {"rigid_body", "p = (1+e) v_n / (n' W_h n + n' W_t n)"}}) +
         "\nimpact.contact, what the contact makes of the relative velocity:\n" +
         described_words(
             io::words_of(io::kContactLawNames),
             {{"normal", "an impulse along the normal, with restitution"},
              {"sticking", "the points move on together; f = (W_h + W_t)^-1 v_rel, no moment"},
              {"latch", "all six relative velocities vanish; the target stays attached"}}) +
         "\npost_impact.contact.model, how simulations resolve the contact:\n" +
         described_words(
             io::words_of(io::kContactModelNames),
             {{"instantaneous", "the impact as planned"},
              {"compliant", "normal contact: spring, damper and Coulomb friction over a time"}}) +
         "\nimpact.joint_resistance, how the joints resist during the impact:\n" +
         described_words(io::words_of(io::resistance_names()),
                         {{"free", "not at all"},
                          {"rotor_inertia", "inertia of the rotors behind the gears"},
                          {"servo", "stiffness and damping over the duration of the contact"},
                          {"locked", "brakes at the named joints"}});
}

std::string objectives_text() {
  std::vector<Sentence> rows;
  for (const QuantityRow& row : quantities()) {
    rows.emplace_back(row.name, fmt::format("{} ({})", row.sentence, row.unit));
  }
  return "objective.quantity:\n" + table(rows) + "\nobjective.measure, over the uncertainty:\n" +
         described_words(io::words_of(io::kMeasureNames),
                         {{"nominal", "the value at the nominal direction"},
                          {"worst_case", "largest value over the cone of directions"},
                          {"expectation", "root of the mean square over samples"},
                          {"cvar", "root of the mean square over the worst samples"}});
}

std::string planners_text() {
  return "approach.planner, from OMPL:\n" +
         described_words(approach_planner_names(),
                         {{"rrt_connect", "two trees that grow towards each other; the default"},
                          {"rrt_star", "one tree that shortens its paths"},
                          {"prm_star", "a roadmap, edges checked when they are needed"},
                          {"bit_star", "batches of samples, searched in order of cost"},
                          {"ait_star", "as bit_star, its heuristic found from the goal"},
                          {"kpiece", "a tree that grows where cells are little explored"}}) +
         "\n`stillbase bench --planners` compares them.\n";
}

std::string exit_codes_text() {
  std::vector<Sentence> rows;
  for (const ExitMeaning& meaning : exit_meanings()) {
    rows.emplace_back(meaning.codes, meaning.text);
  }
  return table(rows);
}

std::string environment_text() {
  return table({{"NO_COLOR", "not empty: no colours"},
                {"TERM", "dumb: no colours"},
                {"SOURCE_DATE_EPOCH",
                 "seconds since 1970: CREATION_DATE of exported files in place of now"},
                {"ROS_PACKAGE_PATH",
                 "folders, separated by colons, in which packages of meshes are looked for"}}) +
         "\nProgress and colours appear on a terminal only.\n";
}

struct HelpRequest {
  std::vector<std::string> topic;
  bool man = false;
  std::string completion;
};

int print_help(const HelpRequest& request, const ProgramText& program,
               const std::vector<Command>& commands) {
  if (request.man) {
    write_stdout(man_page(program, commands));
    return kDone;
  }
  if (!request.completion.empty()) {
    check_known("--completion " + request.completion, request.completion, {"bash", "zsh"});
    write_stdout(shell_completion(request.completion, commands));
    return kDone;
  }
  const std::vector<Topic> topics = help_topics();
  const std::string wanted = fmt::format("{}", fmt::join(request.topic, "-"));
  std::vector<std::string> names;
  for (const Topic& topic : topics) {
    if (topic.name == wanted) {
      write_stdout(topic.text());
      return kDone;
    }
    names.push_back(topic.name);
  }
  if (wanted.empty()) {
    std::vector<Sentence> rows;
    for (const Topic& topic : topics) rows.emplace_back(topic.name, topic.about);
    write_stdout("stillbase help TOPIC, of a topic:\n" + table(rows) +
                 "\nstillbase help COMMAND, of a command: its options.\n"
                 "stillbase --help: the commands.\n");
    return kDone;
  }
  for (const Command& command : commands) names.push_back(command.name);
  throw CommandLineError(fmt::format("help: there is no topic or command '{}'; there are {}{}",
                                     wanted, fmt::join(names, ", "),
                                     io::did_you_mean(wanted, names)));
}

}  // namespace

std::vector<ExitMeaning> exit_meanings() {
  return {{"0", "done; what was asked holds"},
          {"1", "internal error"},
          {"2", "command line wrong"},
          {"3", "input file refused (file:line: rule: message)"},
          {"4", "no configuration satisfies the constraints (the nearest attempt is written)"},
          {"5", "verification failed"},
          {"6", "a limit was reached (the best so far is written)"},
          {"7", "reading or writing failed"},
          {"8", "campaign incomplete"},
          {"9", "a configuration, but no approach path to it"},
          {"130, 143", "stopped by a signal (what was finished is saved)"}};
}

std::vector<Topic> help_topics() {
  return {
      {"contact-laws", "sources of the impulse, contact models, joint resistance", contact_text},
      {"controllers", "what the joints do after the impact", controllers_text},
      {"environment", "environment variables", environment_text},
      {"exit-codes", "what the shell learns", exit_codes_text},
      {"files", "file formats and their endings", files_text},
      {"frames", "N, B, T and the hand", frames_text},
      {"objectives", "quantities and measures that a search minimises", objectives_text},
      {"optimizers", "local and global solvers of the search", optimizers_text},
      {"planners", "planners of the approach path", planners_text},
      {"units", "units that files may use", units_text}};
}

Command help_command(const ProgramText& program, const std::vector<Command>& commands) {
  auto request = std::make_shared<HelpRequest>();
  std::vector<std::string> words;
  for (const Topic& topic : help_topics()) words.push_back(topic.name);
  for (const Command& command : commands) words.push_back(command.name);
  Command help{"help",
               "files, units, exit codes, optimizers, controllers and other topics, or a command",
               {{.name = "topic",
                 .value = "TOPIC",
                 .about = "a topic or a command; without it a list",
                 .target = &request->topic,
                 .words = words},
                {"--man", "", "the manual page, for man(1)", &request->man},
                {.name = "--completion",
                 .value = "SHELL",
                 .about = "completion for bash or zsh",
                 .target = &request->completion,
                 .words = {"bash", "zsh"}}},
               {}};
  std::vector<Command> all = commands;
  all.push_back(help);
  help.run = [request, program, all] { return print_help(*request, program, all); };
  return help;
}

}  // namespace stillbase::app
