#include <stillbase/io/estimate_file.hpp>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <string_view>

#include <fmt/format.h>

#include <stillbase/core/error.hpp>
#include <stillbase/core/file.hpp>

#include "core/covariance.hpp"
#include "io/fields/ranges.hpp"
#include "io/scalars.hpp"

namespace stillbase {

namespace {

constexpr std::size_t kMostFindings = 20;  ///< a wrong separator would repeat itself on every line
constexpr int kErrors = 12;
constexpr const char* kErrorNames[kErrors] = {"x",  "y",  "z",  "rx", "ry", "rz",
                                              "vx", "vy", "vz", "wx", "wy", "wz"};
constexpr const char* kErrorUnits[4] = {"_m", "_rad", "_m_s", "_rad_s"};

/// Columns of a stream in the order in which estimates take them.
struct ColumnNames {
  std::vector<std::string> state{"time_s", "x_m",      "y_m",      "z_m",     "qw",
                                 "qx",     "qy",       "qz",       "vx_m_s",  "vy_m_s",
                                 "vz_m_s", "wx_rad_s", "wy_rad_s", "wz_rad_s"};
  std::vector<std::string> deviations, covariance;

  ColumnNames() {
    for (int i = 0; i < kErrors; ++i) {
      deviations.push_back(fmt::format("sd_{}{}", kErrorNames[i], kErrorUnits[i / 3]));
      for (int j = i; j < kErrors; ++j) {
        covariance.push_back(fmt::format("cov_{}_{}", kErrorNames[i], kErrorNames[j]));
      }
    }
  }
  std::vector<std::string> all() const {
    std::vector<std::string> out = state;
    out.insert(out.end(), deviations.begin(), deviations.end());
    out.insert(out.end(), covariance.begin(), covariance.end());
    return out;
  }
};

std::vector<std::string_view> cells_of(std::string_view line) {
  std::vector<std::string_view> out;
  while (true) {
    const std::size_t comma = line.find(',');
    std::string_view cell = line.substr(0, comma);
    while (!cell.empty() && (cell.front() == ' ' || cell.front() == '\t')) cell.remove_prefix(1);
    while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\t')) cell.remove_suffix(1);
    out.push_back(cell);
    if (comma == std::string_view::npos) return out;
    line.remove_prefix(comma + 1);
  }
}

class EstimateReader {
 public:
  EstimateReader(const std::string& text, const std::string& source)
      : text_(text), source_(source) {}

  std::vector<StateEstimate> read() {
    if (first_bad_byte(text_) != std::string_view::npos) add(0, "not-text", "is no text in UTF-8");
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";  // spreadsheets write it
    std::size_t begin = text_.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
    for (int number = 1; begin < text_.size() && !is_full(); ++number) {
      const std::size_t end = std::min(text_.find('\n', begin), text_.size());
      std::string_view line = std::string_view(text_).substr(begin, end - begin);
      begin = end + 1;
      if (!line.empty() && line.back() == '\r') line.remove_suffix(1);
      if (line.empty() || line.front() == '#') continue;
      if (header_.empty()) {
        read_header(number, line);
        if (!findings_.empty()) break;
      } else {
        read_estimate(number, line);
      }
    }
    if (findings_.empty() && header_.empty()) add(0, "empty", "has no line with column names");
    if (findings_.empty() && estimates_.empty()) add(0, "empty", "has no estimate");
    if (!findings_.empty()) throw InputError(findings_);
    return std::move(estimates_);
  }

 private:
  bool is_full() const { return findings_.size() >= kMostFindings; }
  void add(int line, const char* rule, const std::string& message) {
    if (!is_full()) findings_.push_back({source_, line, rule, message});
  }
  std::string place(std::size_t column) const {
    return fmt::format("column {} ({})", column + 1, header_[column]);
  }

  void read_header(int line, std::string_view text) {
    const std::vector<std::string> known = names_.all();
    for (const std::string_view cell : cells_of(text)) {
      const std::string name(cell);
      header_.push_back(name);
      if (std::find(known.begin(), known.end(), name) == known.end()) {
        add(line, "unknown-column",
            fmt::format("{}{}", place(header_.size() - 1), io::did_you_mean(name, known)));
      } else if (std::count(header_.begin(), header_.end(), name) > 1) {
        add(line, "repeated-column", place(header_.size() - 1));
      }
    }
    const auto missing = [this](const std::vector<std::string>& wanted) {
      std::vector<std::string> out;
      for (const std::string& name : wanted) {
        if (column_of(name) == header_.size()) out.push_back(name);
      }
      return out;
    };
    if (const auto names = missing(names_.state); !names.empty()) {
      add(line, "missing-column", io::list_of(names));
    }
    const auto some_of = [&](const std::vector<std::string>& wanted) {
      const auto names = missing(wanted);
      if (names.size() == wanted.size()) return false;
      if (!names.empty()) {
        add(line, "missing-column", io::list_of(names) + ": all of them are needed, or none");
      }
      return true;
    };
    has_deviations_ = some_of(names_.deviations);
    has_covariance_ = some_of(names_.covariance);
    if (has_deviations_ && has_covariance_) {
      add(line, "not-both", "columns sd_... and cov_...: state one of both");
    }
    if (!findings_.empty()) return;
    for (const std::string& name : names_.all()) order_.push_back(column_of(name));
  }

  std::size_t column_of(const std::string& name) const {
    return static_cast<std::size_t>(std::find(header_.begin(), header_.end(), name) -
                                    header_.begin());
  }

  void read_estimate(int line, std::string_view text) {
    const std::vector<std::string_view> cells = cells_of(text);
    if (cells.size() != header_.size()) {
      return add(
          line, "columns",
          fmt::format("has {} values, the first line names {}", cells.size(), header_.size()));
    }
    const std::size_t before = findings_.size();
    std::vector<double> numbers(cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const char* const end = cells[i].data() + cells[i].size();
      const char* begin = cells[i].data();
      // from_chars() takes no plus sign.
      if (end - begin > 1 && begin[0] == '+' && begin[1] != '-') ++begin;
      const auto [stop, error] = std::from_chars(begin, end, numbers[i]);
      if (stop != end || error != std::errc() || !std::isfinite(numbers[i])) {
        add(line, "not-a-number",
            fmt::format("{}: '{}', must be a finite number", place(i), cells[i]));
      }
    }
    if (findings_.size() > before) return;
    const auto within = [&](std::size_t first, std::size_t end, const io::Range& range) {
      for (std::size_t i = first; i < end; ++i) {
        const double x = numbers[order_[i]];
        if (x >= range.lower && x <= range.upper) continue;
        add(line, "out-of-range",
            fmt::format("{}: {}, must be in [{}, {}]", place(order_[i]), x, range.lower,
                        range.upper));
      }
    };
    within(0, 1, io::kInstant);
    within(1, 4, io::kPlace);
    within(8, 11, io::kVelocity);
    within(11, 14, io::kSpin);
    if (findings_.size() > before) return;
    const auto number = [&](std::size_t i) { return numbers[order_[i]]; };
    const auto vector = [&](std::size_t i) {
      return Vector3d(number(i), number(i + 1), number(i + 2));
    };
    StateEstimate out;
    out.state.time = number(0);
    out.state.pose.position = vector(1);
    const Eigen::Vector4d q(number(4), number(5), number(6), number(7));
    if (std::abs(q.norm() - 1) > 1e-6) {
      add(line, "not-a-unit",
          fmt::format("{} to qz: has the norm {}, must be 1", place(order_[4]), q.norm()));
    }
    out.state.pose.orientation = Eigen::Quaterniond(q[0], q[1], q[2], q[3]).normalized();
    out.state.linear_velocity = vector(8);
    out.state.angular_velocity = vector(11);
    if (!estimates_.empty() && !(out.state.time > estimates_.back().state.time)) {
      add(line, "order",
          fmt::format("{}: {}, must be after {}", place(order_[0]), out.state.time,
                      estimates_.back().state.time));
    }
    read_covariance(line, number, out);
    if (findings_.size() == before) estimates_.push_back(out);
  }

  template <class Number>
  void read_covariance(int line, const Number& number, StateEstimate& out) {
    const std::size_t first = names_.state.size();
    if (has_deviations_) {
      StateCovariance& covariance = out.covariance.emplace(StateCovariance::Zero());
      for (int i = 0; i < kErrors; ++i) {
        const double sigma = number(first + static_cast<std::size_t>(i));
        covariance(i, i) = sigma * sigma;
        if (sigma >= 0) continue;
        add(line, "out-of-range",
            fmt::format("{}: {}, must be >= 0", place(order_[first + static_cast<std::size_t>(i)]),
                        sigma));
      }
    } else if (has_covariance_) {
      StateCovariance& covariance = out.covariance.emplace();
      std::size_t next = first + names_.deviations.size();
      for (int i = 0; i < kErrors; ++i) {
        for (int j = i; j < kErrors; ++j) covariance(i, j) = covariance(j, i) = number(next++);
      }
      if (const auto objection = covariance_objection(covariance)) {
        add(line, "not-a-covariance", "columns cov" + objection->text);
      }
    }
  }

  const std::string& text_;
  const std::string& source_;
  const ColumnNames names_;
  std::vector<std::string> header_;
  std::vector<std::size_t> order_;  ///< column of each name of ColumnNames::all(), where it is
  bool has_deviations_ = false, has_covariance_ = false;
  std::vector<StateEstimate> estimates_;
  std::vector<Finding> findings_;
};

}  // namespace

std::vector<StateEstimate> read_estimates_text(const std::string& text, const std::string& source) {
  return EstimateReader(text, source).read();
}

std::vector<StateEstimate> read_estimates(const std::string& path) {
  return read_estimates_text(read_text_file(path), path);
}

}  // namespace stillbase
