// Recorded streams of estimates.
#include <catch2/catch.hpp>

#include <stillbase/core/error.hpp>
#include <stillbase/io/estimate_file.hpp>

namespace stillbase {
namespace {

const std::string kNames =
    "time_s,x_m,y_m,z_m,qw,qx,qy,qz,vx_m_s,vy_m_s,vz_m_s,wx_rad_s,wy_rad_s,wz_rad_s";
const std::string kDeviations =
    ",sd_x_m,sd_y_m,sd_z_m,sd_rx_rad,sd_ry_rad,sd_rz_rad,sd_vx_m_s,sd_vy_m_s,sd_vz_m_s,"
    "sd_wx_rad_s,sd_wy_rad_s,sd_wz_rad_s";
const std::string kRow = "1,2,3,4,0.6,0,0.8,0,-0.1,0.2,0.3,0.01,0.02,0.03";

std::vector<StateEstimate> read(const std::string& text) {
  return read_estimates_text(text, "stream.csv");
}

std::string refusal(const std::string& text) {
  try {
    read(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

/// Names and values of the upper triangle, of correlation `rho` between x and y.
std::pair<std::string, std::string> covariance_columns(double rho) {
  const char* const names[] = {"x", "y", "z", "rx", "ry", "rz", "vx", "vy", "vz", "wx", "wy", "wz"};
  std::string header, row;
  for (int i = 0; i < 12; ++i) {
    for (int j = i; j < 12; ++j) {
      header += std::string(",cov_") + names[i] + "_" + names[j];
      row += i == j ? ",4" : i == 0 && j == 1 ? "," + std::to_string(4 * rho) : ",0";
    }
  }
  return {header, row};
}

}  // namespace

TEST_CASE("an estimate is read by the names of its columns, in any order") {
  const auto estimates = read("# recorded\r\n" + kNames + "\r\n\n" + kRow + "\r\n");
  REQUIRE(estimates.size() == 1);
  const TargetState& state = estimates.front().state;
  CHECK(state.time == 1);
  CHECK(state.pose.position == Vector3d(2, 3, 4));
  CHECK(state.pose.orientation.w() == Approx(0.6));
  CHECK(state.pose.orientation.y() == Approx(0.8));
  CHECK(state.linear_velocity == Vector3d(-0.1, 0.2, 0.3));
  CHECK(state.angular_velocity == Vector3d(0.01, 0.02, 0.03));
  CHECK_FALSE(estimates.front().covariance.has_value());
  const std::string swapped = "x_m,time_s" + kNames.substr(kNames.find(",y_m"));
  CHECK(read(swapped + "\n2,1" + kRow.substr(3) + "\n").front().state.pose.position ==
        Vector3d(2, 3, 4));
}

TEST_CASE("plus signs and a byte order mark are read") {
  const auto estimates = read("\xEF\xBB\xBF" + kNames + "\n+1,+2e0" + kRow.substr(3) + "\n");
  REQUIRE(estimates.size() == 1);
  CHECK(estimates.front().state.time == 1);
  CHECK(estimates.front().state.pose.position == Vector3d(2, 3, 4));
  for (const char* wrong : {"+", "+-1", "++1"}) {
    CHECK_THAT(refusal(kNames + "\n" + wrong + kRow.substr(1) + "\n"),
               Catch::Contains("not-a-number: column 1 (time_s)"));
  }
}

TEST_CASE("deviations and covariances of estimates are read") {
  const auto known = read(kNames + kDeviations + "\n" + kRow + ",1,2,3,4,5,6,7,8,9,10,11,12\n");
  REQUIRE(known.front().covariance.has_value());
  const StateCovariance& covariance = *known.front().covariance;
  CHECK(covariance.isDiagonal(0));
  CHECK(covariance(0, 0) == 1);
  CHECK(covariance(11, 11) == 144);
  const auto [names, values] = covariance_columns(0.5);
  const auto correlated = read(kNames + names + "\n" + kRow + values + "\n");
  REQUIRE(correlated.front().covariance.has_value());
  CHECK((*correlated.front().covariance)(0, 1) == Approx(2));
  CHECK((*correlated.front().covariance)(1, 0) == Approx(2));
  CHECK((*correlated.front().covariance)(7, 7) == 4);
}

TEST_CASE("a wrong stream is refused with line, column and rule") {
  using Catch::Contains;
  CHECK_THAT(refusal(""), Contains("stream.csv: empty: "));
  CHECK_THAT(refusal(kNames + "\n"), Contains("empty: has no estimate"));
  CHECK_THAT(refusal("time_s,x_mm\n1,2\n"),
             Contains("stream.csv:1: unknown-column: column 2 (x_mm); did you mean 'x_m'?"));
  CHECK_THAT(refusal("time_s,x_m\n1,2\n"), Contains("stream.csv:1: missing-column: y_m, z_m, qw"));
  CHECK_THAT(refusal(kNames + ",x_m\n"), Contains("repeated-column: column 15 (x_m)"));
  CHECK_THAT(refusal(kNames + ",sd_x_m\n"), Contains("all of them are needed, or none"));
  const auto [names, values] = covariance_columns(1.5);
  CHECK_THAT(refusal(kNames + kDeviations + names + "\n"), Contains("not-both"));
  CHECK_THAT(refusal(kNames + names + "\n" + kRow + values + "\n"),
             Contains("stream.csv:2: not-a-covariance: "));
  CHECK_THAT(refusal(kNames + "\n" + kRow + ",7\n"),
             Contains("stream.csv:2: columns: has 15 values, the first line names 14"));
  CHECK_THAT(refusal(kNames + "\n1,two" + kRow.substr(3) + "\n"),
             Contains("stream.csv:2: not-a-number: column 2 (x_m): 'two'"));
  CHECK_THAT(refusal(kNames + "\n1,nan" + kRow.substr(3) + "\n"), Contains("not-a-number"));
  CHECK_THAT(refusal(kNames + "\n1,1e300" + kRow.substr(3) + "\n"),
             Contains("out-of-range: column 2 (x_m)"));
  CHECK_THAT(refusal(kNames + "\n1,2,3,4,1,1" + kRow.substr(13) + "\n"),
             Contains("stream.csv:2: not-a-unit: column 5 (qw)"));
  CHECK_THAT(refusal(kNames + "\n" + kRow + "\n" + kRow + "\n"),
             Contains("stream.csv:3: order: column 1 (time_s): 1, must be after 1"));
  CHECK_THAT(refusal(kNames + kDeviations + "\n" + kRow + ",1,2,3,4,5,6,7,8,9,10,11,-12\n"),
             Contains("stream.csv:2: out-of-range: column 26 (sd_wz_rad_s): -12, must be >= 0"));
  CHECK_THAT(refusal(kNames + "\n" + kRow + std::string(1, '\0') + "\n"), Contains("not-text"));
}

}  // namespace stillbase
