#include <set>

#include <fmt/format.h>

#include <stillbase/io/plan_file.hpp>
#include <stillbase/io/schema.hpp>

#include "export/columns.hpp"
#include "export/mat_writer.hpp"
#include "io/json.hpp"

namespace stillbase {

namespace {

using io::Json;

/// The keys of an object as field names, each once.
std::vector<std::string> field_names(const Json& object) {
  std::vector<std::string> names;
  std::set<std::string> used;
  for (const std::string& key : object.keys()) {
    const std::string stem = mat::field_name(key);
    std::string name = stem;
    for (int i = 2; !used.insert(name).second; ++i) {
      const std::string number = fmt::format("_{}", i);
      name = stem.substr(0, 63 - number.size()) + number;
    }
    names.push_back(name);
  }
  return names;
}

bool is_number_list(const Json& json) {
  return json.is_array() &&
         std::all_of(json.begin(), json.end(), [](const Json& x) { return x.is_number(); });
}

/// Lists of numbers of one length.
bool is_matrix(const Json& json) {
  return !json.empty() && std::all_of(json.begin(), json.end(), [&json](const Json& row) {
    return is_number_list(row) && row.size() == json.at(std::size_t{0}).size();
  });
}

/// The object of a list that has the members of all others; null: there is none.
const Json* fullest_object(const Json& list) {
  const Json* fullest = nullptr;
  for (const Json& item : list) {
    if (!item.is_object()) return nullptr;
    if (fullest == nullptr || item.size() > fullest->size()) fullest = &item;
  }
  if (fullest == nullptr) return nullptr;
  for (const Json& item : list) {
    for (const std::string& key : item.keys()) {
      if (!fullest->contains(key)) return nullptr;
    }
  }
  return fullest;
}

Eigen::MatrixXd matrix_of(const Json& rows) {
  Eigen::MatrixXd matrix(rows.size(), rows.at(std::size_t{0}).size());
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const auto row = rows.at(i).get<std::vector<double>>();
    for (std::size_t j = 0; j < row.size(); ++j) matrix(i, j) = row[j];
  }
  return matrix;
}

std::string variable_of(const Json& json, std::string_view name = {});

std::vector<std::string> pieces_of(const Json& container) {
  std::vector<std::string> pieces;
  for (const Json& item : container) pieces.push_back(variable_of(item));
  return pieces;
}

std::string list_variable(const Json& json, std::string_view name) {
  if (json.empty()) return mat::real_array(Eigen::MatrixXd(0, 0), name);
  if (is_number_list(json)) {
    const auto values = json.get<std::vector<double>>();
    return mat::real_array(
        Eigen::Map<const Eigen::VectorXd>(values.data(), static_cast<Eigen::Index>(values.size())),
        name);
  }
  if (is_matrix(json)) return mat::real_array(matrix_of(json), name);
  const Json* const fullest = fullest_object(json);
  if (fullest == nullptr) return mat::cell_column(pieces_of(json), name);
  // A member that an object lacks is empty there.
  const std::vector<std::string> keys = fullest->keys();
  std::vector<std::vector<std::string>> rows;
  for (const Json& item : json) {
    std::vector<std::string>& row = rows.emplace_back();
    for (const std::string& key : keys) {
      row.push_back(item.contains(key) ? variable_of(item.at(key))
                                       : mat::real_array(Eigen::MatrixXd(0, 0)));
    }
  }
  return mat::structure_column(field_names(*fullest), rows, name);
}

std::string variable_of(const Json& json, std::string_view name) {
  switch (json.kind()) {
    case Json::Kind::Null:
      return mat::real_array(Eigen::MatrixXd(0, 0), name);
    case Json::Kind::Bool:
      return mat::logical(json.get<bool>(), name);
    case Json::Kind::Text:
      return mat::text_row(json.get<std::string>(), name);
    case Json::Kind::Array:
      return list_variable(json, name);
    case Json::Kind::Object:
      return mat::structure_column(field_names(json), {pieces_of(json)}, name);
    default:
      return mat::real_array(Eigen::MatrixXd::Constant(1, 1, json.get<double>()), name);
  }
}

/// The samples as matrices, each beside its unit and frame.
std::string trajectory_variable(const Plan& plan) {
  const std::vector<TrajectorySample> samples = approach_samples(plan);
  std::vector<std::string> keys, matrices;
  for (const SampleColumns& column : sample_columns(plan)) {
    Eigen::MatrixXd matrix(samples.size(), column.labels.size());
    for (std::size_t i = 0; i < samples.size(); ++i) {
      matrix.row(static_cast<Eigen::Index>(i)) = column.values(samples[i]).transpose();
    }
    keys.push_back(column.name);
    matrices.push_back(mat::real_array(matrix));
    keys.push_back(column.name + "_unit");
    matrices.push_back(
        mat::text_row(column.unit + (column.frame.empty() ? "" : ", in " + column.frame)));
  }
  return mat::structure_column(keys, {matrices}, "trajectory");
}

std::string members_variable() {
  std::vector<std::vector<std::string>> rows;
  for (const Member& member : members_of("plan")) {
    rows.push_back({mat::text_row(member.path), mat::text_row(member.unit),
                    mat::text_row(member.frame), mat::text_row(member.shape),
                    mat::text_row(member.meaning)});
  }
  return mat::structure_column({"path", "unit", "frame", "shape", "meaning"}, rows, "members");
}

constexpr const char* kAbout =
    "Plan of stillbase. SI units and radians. Frames: N inertial, B base (origin at the centroid "
    "of the base body, axes of the root link), T target (origin at its centroid). Velocities and "
    "wrenches have the linear part first; quaternions are w, x, y, z and take vectors of the body "
    "frame to N. 'members' has unit, frame and shape of every member of 'plan'; [] in a path "
    "stands for every element of a list, k in a shape for any number, n for the number of joints.";

}  // namespace

std::string matlab_file(const Plan& plan) {
  std::vector<std::string> variables{mat::text_row(kAbout, "about"),
                                     variable_of(Json::parse(plan_to_json(plan, {})), "plan"),
                                     members_variable()};
  if (!plan.approach.times.empty()) variables.push_back(trajectory_variable(plan));
  return mat::file("MATLAB 5.0 MAT-file, plan of stillbase", variables);
}

}  // namespace stillbase
