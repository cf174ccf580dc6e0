// Messages of CCSDS, read back by a parser of their grammar.
#include <catch2/catch.hpp>

#include <cmath>
#include <map>
#include <regex>
#include <sstream>

#include <stillbase/core/error.hpp>
#include <stillbase/encounter/target_motion.hpp>
#include <stillbase/export/export.hpp>

#include "export/support.hpp"

using namespace stillbase;
using namespace stillbase::export_test;

namespace {

EphemerisOptions options_for(EphemerisBody body) {
  EphemerisOptions options;
  options.body = body;
  options.epoch = "2026-02-28T23:59:30.5";
  options.creation_date = "2026-01-02T03:04:05";
  return options;
}

/// Keywords in the order of a table of the standard; "?" marks optional ones.
struct Section {
  std::vector<std::string> keywords;
};
const Section kHeader{{"CREATION_DATE", "ORIGINATOR", "MESSAGE_ID?"}};
// CCSDS 504.0-B-2, table 4-3.
const Section kAttitude{{"OBJECT_NAME", "OBJECT_ID", "CENTER_NAME?", "REF_FRAME_A", "REF_FRAME_B",
                         "TIME_SYSTEM", "START_TIME", "USEABLE_START_TIME?", "USEABLE_STOP_TIME?",
                         "STOP_TIME", "ATTITUDE_TYPE", "EULER_ROT_SEQ?", "ANGVEL_FRAME?",
                         "INTERPOLATION_METHOD?", "INTERPOLATION_DEGREE?"}};
// CCSDS 502.0-B-2, table 5-3.
const Section kOrbit{{"OBJECT_NAME", "OBJECT_ID", "CENTER_NAME", "REF_FRAME", "REF_FRAME_EPOCH?",
                      "TIME_SYSTEM", "START_TIME", "USEABLE_START_TIME?", "USEABLE_STOP_TIME?",
                      "STOP_TIME", "INTERPOLATION?", "INTERPOLATION_DEGREE?"}};

struct Message {
  std::map<std::string, std::string> values;
  std::vector<std::string> comments;
  std::vector<std::string> epochs;
  std::vector<std::vector<double>> rows;
};

const std::regex kDate("[0-9]{4}-[0-9]{2}-[0-9]{2}T[0-9]{2}:[0-9]{2}:[0-9]{2}(\\.[0-9]{1,12})?Z?");
const std::regex kNumber("[+-]?[0-9]+(\\.[0-9]+)?([eE][+-]?[0-9]{1,3})?");

class Parser {
 public:
  Parser(const std::string& text, std::string version_key) {
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) {
      // 6.3: printable ASCII, at most 254 characters.
      REQUIRE(line.size() <= 254);
      for (const char c : line) REQUIRE((c >= ' ' && c <= '~'));
      if (line.find_first_not_of(' ') != std::string::npos) lines_.push_back(line);
    }
    const auto [key, value] = pair();
    REQUIRE(key == version_key);
    REQUIRE(value == "2.0");
  }

  Message read(const Section& metadata, bool has_data_marks, std::size_t numbers) {
    comments();
    section(kHeader);
    REQUIRE(next() == "META_START");
    comments();
    section(metadata);
    REQUIRE(next() == "META_STOP");
    if (has_data_marks) REQUIRE(next() == "DATA_START");
    comments();
    while (at_ < lines_.size() && lines_[at_] != "DATA_STOP") data_line(next(), numbers);
    if (has_data_marks) REQUIRE(next() == "DATA_STOP");
    REQUIRE(at_ == lines_.size());
    return message_;
  }

 private:
  std::string next() {
    REQUIRE(at_ < lines_.size());
    return lines_[at_++];
  }
  void comments() {
    for (; at_ < lines_.size() && lines_[at_].rfind("COMMENT ", 0) == 0; ++at_) {
      message_.comments.push_back(lines_[at_].substr(8));
    }
  }
  std::pair<std::string, std::string> pair() {
    static const std::regex form("([A-Z0-9_]+) *= *(\\S.*)");
    std::smatch match;
    const std::string line = next();
    INFO(line);
    REQUIRE(std::regex_match(line, match, form));
    return {match[1], match[2]};
  }
  void section(const Section& section) {
    for (const std::string& keyword : section.keywords) {
      const bool is_optional = keyword.back() == '?';
      const std::string name = keyword.substr(0, keyword.size() - (is_optional ? 1 : 0));
      const bool is_here =
          at_ < lines_.size() && std::regex_match(lines_[at_], std::regex(name + " *=.*"));
      if (is_optional && !is_here) continue;
      const auto [key, value] = pair();
      REQUIRE(key == name);
      if (key.find("TIME") != std::string::npos && key != "TIME_SYSTEM") {
        REQUIRE(std::regex_match(value, kDate));
      }
      message_.values[key] = value;
    }
  }
  void data_line(const std::string& line, std::size_t numbers) {
    std::istringstream stream(line);
    std::string word;
    stream >> word;
    REQUIRE(std::regex_match(word, kDate));
    if (!message_.epochs.empty()) REQUIRE(message_.epochs.back() < word);
    message_.epochs.push_back(word);
    std::vector<double> row;
    while (stream >> word) {
      REQUIRE(std::regex_match(word, kNumber));
      // 6.7: at most 16 digits in the mantissa.
      const std::string mantissa = word.substr(0, word.find('e'));
      REQUIRE(std::count_if(mantissa.begin(), mantissa.end(),
                            [](unsigned char c) { return std::isdigit(c) != 0; }) <= 16);
      row.push_back(std::stod(word));
    }
    REQUIRE(row.size() == numbers);
    message_.rows.push_back(row);
  }

  std::vector<std::string> lines_;
  std::size_t at_ = 0;
  Message message_;
};

Message read_aem(const std::string& text) {
  return Parser(text, "CCSDS_AEM_VERS").read(kAttitude, true, 7);
}
Message read_oem(const std::string& text) {
  return Parser(text, "CCSDS_OEM_VERS").read(kOrbit, false, 6);
}

/// Seconds from 2026-02-28T00:00:00 of a date in that night or the next day.
double seconds_of(const std::string& date) {
  const double day = date.substr(0, 10) == "2026-02-28" ? 0 : 86400;
  if (day > 0) REQUIRE(date.substr(0, 10) == "2026-03-01");
  return day + 3600 * std::stod(date.substr(11, 2)) + 60 * std::stod(date.substr(14, 2)) +
         std::stod(date.substr(17));
}
constexpr double kEpoch = 86400 - 29.5;

/// Direction cosines of the standard (annex F): components in B of a vector in A.
Matrix3d cosines(const std::vector<double>& row) {
  const Vector3d q(row[0], row[1], row[2]);
  const double c = row[3];
  const Matrix3d cross = skew<double>(q);
  return (c * c - q.squaredNorm()) * Matrix3d::Identity() + 2 * q * q.transpose() - 2 * c * cross;
}

Vector3d three(const std::vector<double>& row, std::size_t first) {
  return {row[first], row[first + 1], row[first + 2]};
}

}  // namespace

TEST_CASE("an attitude ephemeris keeps the grammar of AEM 2.0 and has the base's attitude") {
  const Plan& plan = floating_plan();
  const Message aem = read_aem(attitude_ephemeris(plan, options_for(EphemerisBody::Robot)));
  CHECK(aem.values.at("ATTITUDE_TYPE") == "QUATERNION/ANGVEL");
  CHECK(aem.values.at("REF_FRAME_A") == "PLAN_N");
  CHECK(aem.values.at("ANGVEL_FRAME") == aem.values.at("REF_FRAME_B"));
  CHECK(aem.values.at("TIME_SYSTEM") == "TAI");
  CHECK(aem.values.at("START_TIME") == aem.epochs.front());
  CHECK(aem.values.at("STOP_TIME") == aem.epochs.back());
  CHECK(aem.values.at("CREATION_DATE") == "2026-01-02T03:04:05");
  const Approach& approach = plan.approach;
  REQUIRE(aem.rows.size() == approach.times.size());
  double rotation = 0;
  for (std::size_t i = 0; i < aem.rows.size(); ++i) {
    CHECK(seconds_of(aem.epochs[i]) == Approx(kEpoch + approach.times[i]).margin(1e-9).epsilon(0));
    const Matrix3d R_NB = approach.base_poses[i].orientation.toRotationMatrix();
    CHECK((cosines(aem.rows[i]) - R_NB.transpose()).norm() < 1e-14);
    const Vector3d omega = approach.base_velocities[i].tail<3>();
    CHECK((three(aem.rows[i], 4) * (kPi / 180) - omega).norm() < 1e-15);
    rotation = std::max(rotation, omega.norm());
    if (i == 0) continue;
    const Eigen::Vector4d q(aem.rows[i].data()), before(aem.rows[i - 1].data());
    CHECK(q.dot(before) > 0);
  }
  CHECK(rotation > 1e-3);
}

TEST_CASE("an orbit ephemeris keeps the grammar of OEM 2.0 and has the base's motion in km") {
  const Plan& plan = floating_plan();
  const Message oem = read_oem(orbit_ephemeris(plan, options_for(EphemerisBody::Robot)));
  const Approach& approach = plan.approach;
  REQUIRE(oem.rows.size() == approach.times.size());
  for (std::size_t i = 0; i < oem.rows.size(); ++i) {
    const Pose& base = approach.base_poses[i];
    CHECK((1000 * three(oem.rows[i], 0) - base.position).norm() < 1e-14);
    const Vector3d v = base.orientation * Vector3d(approach.base_velocities[i].head<3>());
    CHECK((1000 * three(oem.rows[i], 3) - v).norm() < 1e-15);
  }
}

TEST_CASE("the target's ephemerides are its predicted motion") {
  const Plan& plan = client_plan();
  const auto motion = encounter_motion(plan.problem, plan.configuration);
  REQUIRE(motion);
  const EphemerisOptions options = options_for(EphemerisBody::Target);
  const Message aem = read_aem(attitude_ephemeris(plan, options));
  const Message oem = read_oem(orbit_ephemeris(plan, options));
  REQUIRE(aem.rows.size() == plan.approach.times.size());
  REQUIRE(oem.rows.size() == aem.rows.size());
  for (std::size_t i = 0; i < aem.rows.size(); ++i) {
    const TargetState state = motion->state(plan.approach.times[i]);
    const Matrix3d R_TN = state.pose.orientation.toRotationMatrix().transpose();
    CHECK((cosines(aem.rows[i]) - R_TN).norm() < 1e-14);
    CHECK((three(aem.rows[i], 4) * (kPi / 180) - R_TN * state.angular_velocity).norm() < 1e-14);
    CHECK((1000 * three(oem.rows[i], 0) - state.pose.position).norm() < 1e-13);
    CHECK((1000 * three(oem.rows[i], 3) - state.linear_velocity).norm() < 1e-15);
  }
  // At the contact the feature is at the hand.
  CHECK(seconds_of(oem.epochs.back()) ==
        Approx(kEpoch + plan.configuration.contact_time).margin(1e-9).epsilon(0));
}

TEST_CASE("what a message cannot hold is refused") {
  const Plan& plan = client_plan();
  const auto with = [](auto change) {
    EphemerisOptions options = options_for(EphemerisBody::Robot);
    change(options);
    return options;
  };
  const EphemerisOptions wrong[] = {
      with([](EphemerisOptions& o) { o.epoch = "2026-02-30T00:00:00"; }),
      with([](EphemerisOptions& o) { o.epoch = "2026-02-28"; }),
      with([](EphemerisOptions& o) { o.epoch = "2026-02-28T24:00:00"; }),
      with([](EphemerisOptions& o) { o.epoch = "2026-02-28T12:00:00.x"; }),
      with([](EphemerisOptions& o) { o.epoch = "-026-02-28T12:00:00"; }),
      with([](EphemerisOptions& o) { o.frame = ""; }),
      with([](EphemerisOptions& o) { o.frame = "N\nSTOP_TIME = 1"; }),
      with([](EphemerisOptions& o) { o.center = "Erde\xc3\xa4"; })};
  for (const EphemerisOptions& options : wrong) {
    INFO(options.epoch << " " << options.frame);
    CHECK_THROWS_AS(attitude_ephemeris(plan, options), std::invalid_argument);
    CHECK_THROWS_AS(orbit_ephemeris(plan, options), std::invalid_argument);
  }
  Plan without_path = plan;
  without_path.approach = {};
  CHECK_THROWS_AS(orbit_ephemeris(without_path, options_for(EphemerisBody::Robot)), InputError);
  Plan without_target = plan;
  without_target.problem.target.reset();
  CHECK_THROWS_AS(orbit_ephemeris(without_target, options_for(EphemerisBody::Target)), InputError);
  Plan twice = plan;
  twice.approach.times[1] = twice.approach.times[0];
  CHECK_THROWS_AS(orbit_ephemeris(twice, options_for(EphemerisBody::Robot)), InputError);
  CHECK_THROWS_AS(ros_trajectory(twice), InputError);
}

TEST_CASE("dates around the epoch are those of the calendar") {
  Plan plan = client_plan();
  EphemerisOptions options = options_for(EphemerisBody::Robot);
  plan.approach.times.front() = -172830.25;                     // two days and a little before
  CHECK_THROWS_AS(orbit_ephemeris(plan, options), InputError);  // no target is known then
  plan.problem.target.reset();
  options.epoch = "2024-03-01T00:00:00";
  const Message oem = read_oem(orbit_ephemeris(plan, options));
  CHECK(oem.epochs.front() == "2024-02-27T23:59:29.750000000");
}
