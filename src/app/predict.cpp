// stillbase predict: the torque-free motion of a target and of its contact features over time.
#include <cmath>
#include <memory>
#include <optional>
#include <stdexcept>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>
#include <stillbase/encounter/direction_cone.hpp>
#include <stillbase/io/problem_file.hpp>
#include <stillbase/io/target_file.hpp>

#include "app/command_line.hpp"
#include "app/quantity.hpp"
#include "app/words.hpp"
#include "core/escape.hpp"
#include "io/fields/results.hpp"

namespace stillbase::app {

namespace {

using io::PredictedFeature;
using io::PredictedInstant;
using io::TargetPrediction;

constexpr double kMostRows = 1e6;  ///< of the target and its features

struct PredictRequest {
  std::string input, from, to, step;
  std::vector<double> angular_velocity;
  OutputFile output;
  bool json = false;
};

/// A target, how it moves, and how well that is known.
struct Subject {
  TargetEstimate estimate;
  std::optional<EstimateDeviations> deviations;  ///< empty: not known
  bool is_estimate = true;                       ///< false: a target file, which has no state
};

Subject subject_of(const PredictRequest& request) {
  const std::string text = read_text_file(request.input);
  if (stated_format(text, request.input) == "stillbase.target") {
    Subject subject{{read_target_text(text, request.input), {}}, {}, false};
    if (!request.angular_velocity.empty()) {
      subject.estimate.state.angular_velocity =
          Eigen::Map<const Vector3d>(request.angular_velocity.data());
    }
    return subject;
  }
  if (!request.angular_velocity.empty()) {
    throw CommandLineError("--angular-velocity: is for target files; a problem states its own");
  }
  const CaptureProblem problem = read_problem(request.input);
  if (!problem.target || problem.impulse.direction) {
    throw CommandLineError(
        request.input +
        ": states the direction of the impulse (impact.direction), so no motion of the target");
  }
  return {{*problem.target, problem.target_state}, problem.target_deviations};
}

/// @throws CommandLineError for a range that is no range, or has too many rows
std::vector<double> times_of(const PredictRequest& request, std::size_t features) {
  // Problem files state instants within the same range.
  const double from = read_quantity("--from", request.from, io::Dimension::Time, io::kInstant);
  const double to = read_quantity("--to", request.to, io::Dimension::Time, io::kInstant);
  const double step = read_quantity("--step", request.step, io::Dimension::Time, io::kPositive);
  if (to < from) {
    throw CommandLineError(
        fmt::format("--to {}: is before --from {}; exchange both", request.to, request.from));
  }
  // A last instant that rounding alone puts behind the end is the end.
  const double intervals = std::floor((to - from) / step * (1 + 1e-12) + 1e-9);
  const double rows = (intervals + 1) * static_cast<double>(features + 1);
  if (!(rows <= kMostRows)) {
    throw CommandLineError(fmt::format(
        "--step {}: {:.4g} rows of the target and its {} features; at most {:g} are written: "
        "a larger step or a shorter range",
        request.step, rows, features, kMostRows));
  }
  std::vector<double> times;
  for (int i = 0; i <= static_cast<int>(intervals); ++i) {
    times.push_back(std::min(from + i * step, to));
  }
  return times;
}

/// @throws CommandLineError where the rotation until then cannot be computed
TargetPrediction predict(const Subject& subject, const std::vector<double>& times) {
  const auto& [body, estimate] = subject.estimate;
  const double duration =
      std::max(std::abs(times.front() - estimate.time), std::abs(times.back() - estimate.time));
  if (subject.deviations) {
    const double rotation = rotation_bound(subject.estimate, *subject.deviations, duration);
    if (!(rotation <= kMaxPredictedRotation)) {
      throw CommandLineError(fmt::format(
          "--from, --to: the target may rotate by {:.4g} rad from its estimate to there; its "
          "covariance is predicted over {:g} rad at most",
          rotation, kMaxPredictedRotation));
    }
  }
  if (!(estimate.angular_velocity.norm() * duration <= io::kMostRotation)) {
    throw CommandLineError(
        fmt::format("--from, --to: the target rotates by {:.4g} rad from its estimate to there; "
                    "its attitude is "
                    "computed over {:g} rad at most",
                    estimate.angular_velocity.norm() * duration, io::kMostRotation));
  }
  TargetPrediction out{body.name, {}};
  try {
    const TargetMotion motion(body, estimate, duration + 1);
    for (const double time : times) {
      PredictedInstant& instant = out.instants.emplace_back();
      instant.state = motion.state(time);
      for (const ContactFeature& feature : body.features) {
        const ContactState at = motion.contact(feature, time);
        instant.features.push_back(
            {feature.name, at.point, at.normal, at.velocity, at.normal.dot(at.velocity), {}});
      }
    }
    for (std::size_t i = 0; subject.deviations && i < body.features.size(); ++i) {
      const std::vector<ContactPrediction> predictions = predict_contact(
          subject.estimate, covariance_of(*subject.deviations), body.features[i], times);
      for (std::size_t k = 0; k < times.size(); ++k) {
        out.instants[k].features[i].covariance = predictions[k].spread.topLeftCorner<9, 9>();
      }
    }
  } catch (const std::invalid_argument& error) {
    throw CommandLineError(fmt::format("--from, --to: {}", error.what()));
  }
  return out;
}

std::string prediction_json(TargetPrediction prediction) {
  return io::pretty(io::written([&](io::Table& t) { io::prediction_fields(t, prediction); }));
}

void add_cells(std::string& text, const Eigen::Ref<const Eigen::VectorXd>& values) {
  for (const double x : values) text += fmt::format(",{}", x);
}

/// One line per instant and feature, the target's own first: columns that it has not are empty.
std::string prediction_csv(const TargetPrediction& prediction) {
  std::string text =
      "time_s,what,x_m,y_m,z_m,vx_m_s,vy_m_s,vz_m_s,qw,qx,qy,qz,wx_rad_s,wy_rad_s,wz_rad_s,"
      "normal_x,normal_y,normal_z,closing_speed_m_s";
  const char* const names[] = {"x", "y", "z", "rx", "ry", "rz", "vx", "vy", "vz"};
  for (int i = 0; i < 9; ++i) {
    for (int j = i; j < 9; ++j) text += fmt::format(",cov_{}_{}", names[i], names[j]);
  }
  text += '\n';
  const std::string no_feature(4 + 45, ',');
  for (const PredictedInstant& instant : prediction.instants) {
    const TargetState& state = instant.state;
    const Eigen::Quaterniond& q = state.pose.orientation;
    text += fmt::format("{},{}", state.time, csv_field(prediction.target));
    add_cells(text, state.pose.position);
    add_cells(text, state.linear_velocity);
    add_cells(text, Eigen::Vector4d(q.w(), q.x(), q.y(), q.z()));
    add_cells(text, state.angular_velocity);
    text += no_feature + '\n';
    for (const PredictedFeature& feature : instant.features) {
      text += fmt::format("{},{}", state.time, csv_field(feature.name));
      add_cells(text, feature.point);
      add_cells(text, feature.velocity);
      text += ",,,,,,,";
      add_cells(text, feature.normal);
      text += fmt::format(",{}", feature.closing_speed);
      for (int i = 0; i < 9; ++i) {
        for (int j = i; j < 9; ++j) {
          text += feature.covariance ? fmt::format(",{}", (*feature.covariance)(i, j)) : ",";
        }
      }
      text += '\n';
    }
  }
  return text;
}

std::string three(const Vector3d& v) {
  return fmt::format("{:>10.4f} {:>10.4f} {:>10.4f}", v.x(), v.y(), v.z());
}

std::string prediction_words(const TargetPrediction& prediction) {
  const auto head = [](const char* a, const char* b, const char* c, const char* d, const char* e,
                       const char* f) {
    return fmt::format("{:>10} {:<16} {:>32} {:>32} {:>32} {:>10}", a, b, c, d, e, f);
  };
  const bool is_known = !prediction.instants.empty() &&
                        !prediction.instants.front().features.empty() &&
                        prediction.instants.front().features.front().covariance.has_value();
  std::string text =
      head("time", prediction.target.c_str(), "position", "angular velocity", "velocity", "") +
      '\n' + head("s", "", "m, N", "rad/s, N", "m/s, N", "") + '\n' +
      head("", "  feature", "point", "normal", "velocity", "closing") +
      (is_known ? "   root mean square errors: point m, normal deg, velocity m/s" : "") + '\n';
  for (const PredictedInstant& instant : prediction.instants) {
    const TargetState& state = instant.state;
    text += fmt::format("{:>10.4f} {:<16} {} {} {}\n", state.time, "", three(state.pose.position),
                        three(state.angular_velocity), three(state.linear_velocity));
    for (const PredictedFeature& feature : instant.features) {
      text += fmt::format("{:>10} {:<16} {} {} {} {:>10.5f}", "", "  " + feature.name,
                          three(feature.point), three(feature.normal), three(feature.velocity),
                          feature.closing_speed);
      if (feature.covariance) {
        const Eigen::VectorXd variance = feature.covariance->diagonal();
        text += fmt::format("   {:.3g} {:.3g} {:.3g}", std::sqrt(variance.segment<3>(0).sum()),
                            std::sqrt(variance.segment<3>(3).sum()) * kDegrees,
                            std::sqrt(variance.segment<3>(6).sum()));
      }
      text += '\n';
    }
  }
  return text;
}

/// What the numbers do not know, a line on stderr; empty: every error is stated.
std::string unknown_words(const Subject& subject) {
  if (!subject.is_estimate) {
    return "a target alone has no estimate: it begins at the origin of N, in its axes and without "
           "linear velocity; errors are not known";
  }
  if (!subject.deviations) {
    return "target.state.covariance is not stated: the numbers are those of the estimate, and "
           "their "
           "standard deviations are not known";
  }
  const EstimateDeviations& known = *subject.deviations;
  std::vector<std::string> exact;
  for (const auto& [name, deviation] :
       {std::pair{"position", known.position}, std::pair{"orientation", known.orientation},
        std::pair{"linear_velocity", known.linear_velocity},
        std::pair{"angular_velocity", known.angular_velocity}}) {
    if (deviation.isZero(0)) exact.emplace_back(name);
  }
  if (exact.empty()) return "";
  return fmt::format("target.state.covariance states no error of {}: they count as exact",
                     fmt::join(exact, ", "));
}

int predict_target(const PredictRequest& request) {
  request.output.check({".json", ".csv"});
  for (const double x : request.angular_velocity) {
    if (!std::isfinite(x) || std::abs(x) > 100) {
      throw CommandLineError("--angular-velocity: three numbers from -100 to 100, rad/s");
    }
  }
  if (is_same_file(request.input, request.output.path)) {
    throw CommandLineError(request.output.path + ": is the input itself");
  }
  const Subject subject = subject_of(request);
  const TargetPrediction prediction =
      predict(subject, times_of(request, subject.estimate.body.features.size()));
  const std::string extension = extension_of(request.output.path);
  if (extension == ".json") request.output.write(prediction_json(prediction));
  if (extension == ".csv") request.output.write(prediction_csv(prediction));
  if (request.json) {
    write_stdout(prediction_json(prediction));
  } else if (!request.output.is_given()) {
    write_stdout(prediction_words(prediction));
  }
  if (const std::string unknown = unknown_words(subject); !unknown.empty()) say(unknown);
  return signal_exit_code() != 0 ? signal_exit_code() : kDone;
}

}  // namespace

Command predict_command() {
  auto request = std::make_shared<PredictRequest>();
  return {"predict", "the target's state over time, and every contact feature with its covariance",
          std::vector<Option>{
              {"input", "PROBLEM.yaml|TARGET.yaml",
               "problem with the target's estimate, or a target alone: at the origin, at time 0 in "
               "the axes of N",
               &request->input, true},
              {"--from", "TIME", "first instant, such as -5min, without a unit s", &request->from,
               true},
              {"--to", "TIME", "end of the range, the same", &request->to, true},
              {"--step", "TIME", "between two instants, such as 500ms", &request->step, true},
              {"--angular-velocity", "X Y Z", "of a target alone at time 0, in N, rad/s",
               &request->angular_velocity, false, 0, 0, 3},
              {"--json", "", "print one JSON object", &request->json}} +
              output_options(request->output, "-o,--output",
                             "prediction as .json or .csv; else a table"),
          [request] { return predict_target(*request); }};
}

}  // namespace stillbase::app
