// Values that a table of fields is made of: numbers with units, words, names, vectors, joints.
#pragma once

#include <string>
#include <vector>

#include <stillbase/robot/robot_model.hpp>

#include "io/field_reader.hpp"
#include "io/fields/ranges.hpp"
#include "io/fields/table.hpp"
#include "io/names.hpp"

namespace stillbase::io {

/// Where a value is kept: in a variable, or in one that may be empty.
template <class T>
class Slot {
 public:
  Slot(T& x) : x_(&x) {}
  Slot(std::optional<T>& x) : optional_(&x) {}
  bool has() const { return x_ != nullptr || optional_->has_value(); }
  const T& get() const { return x_ != nullptr ? *x_ : **optional_; }
  void set(const T& x) const {
    if (x_ != nullptr) {
      *x_ = x;
    } else {
      *optional_ = x;
    }
  }

 private:
  T* x_ = nullptr;
  std::optional<T>* optional_ = nullptr;
};

struct Number : Value {
  explicit Number(Slot<double> x, Dimension dimension = Dimension::None, Range range = kAny);
  Number(Slot<double> x, Range range) : Number(x, Dimension::None, range) {}
};

/// A whole number between two others.
struct Integer : Value {
  template <class T>
  Integer(T& x, int lower, int upper)
      : Integer(
            lower, upper, [&x] { return Json(x); }, [&x](int value) { x = value; }) {}

 private:
  Integer(int lower, int upper, const std::function<Json()>& get,
          const std::function<void(int)>& set);
};

/// A number of a list of whole numbers up to 2^53.
struct Seed : Value {
  explicit Seed(std::uint64_t& x);
};

struct Flag : Value {
  explicit Flag(bool& x);
};

/// Any text, or one of these names when they are known. @param what the names are, for messages
struct Text : Value {
  explicit Text(std::string& x) : Text(x, {}, "") {}
  Text(std::string& x, const std::vector<std::string>& names, const std::string& what);
};

/// A list of texts.
struct Texts : List<std::string> {
  explicit Texts(std::vector<std::string>& items, const ListLimits& limits = {})
      : List(
            items, [](std::string& x) { return Text(x); }, limits) {}
};

/// The one text that is allowed there.
struct Exactly : Value {
  explicit Exactly(const std::string& text);
};

/// A word of a closed list, stated in `io/names.hpp`.
struct Word : Value {
  template <class E, class Names>
  Word(E& x, const Names& names)
      : Word(
            words_of(names), [&x, names](std::size_t i) { x = names[i].second; },
            [&x, names] { return word_of(names, x); }) {}

 private:
  Word(std::vector<std::string> list, std::function<void(std::size_t)> choose_word,
       const std::function<std::string()>& now);
};

enum class VectorKind { Any, Direction, Unit };

/// Three numbers. A direction has any length but zero and is made a unit vector; a unit vector has
/// norm 1 to 1e-6 as written.
struct Vector : Value {
  explicit Vector(Slot<Vector3d> x, Dimension dimension = Dimension::None, Range range = kAny)
      : Vector(x, dimension, range, VectorKind::Any) {}
  Vector(Slot<Vector3d> x, VectorKind kind) : Vector(x, Dimension::None, kAny, kind) {}

 private:
  Vector(Slot<Vector3d> x, Dimension dimension, Range range, VectorKind kind);
};

/// Three numbers, or one for all three.
struct Deviation : Value {
  Deviation(Slot<Vector3d> x, Dimension dimension, Range range);
};

/// {w, x, y, z} of norm 1 to 1e-6, {rpy: [roll, pitch, yaw]} as in URDF, or {axis: , angle: }. A
/// quaternion of norm 1 to rounding is kept bit for bit.
struct Orientation : Value {
  explicit Orientation(Slot<Eigen::Quaterniond> x);
};

/// A list of numbers of one size (`size` < 0: any) without units, e.g. joints in their order.
struct Numbers : Value {
  template <class V>
  explicit Numbers(V& x, int size = -1)
      : Numbers(
            size, [&x] { return std::vector<double>(x.begin(), x.end()); },
            [&x](const std::vector<double>& list) {
              x.resize(static_cast<decltype(x.size())>(list.size()));
              std::copy(list.begin(), list.end(), x.begin());
            }) {}

 private:
  Numbers(int size, const std::function<std::vector<double>()>& get,
          const std::function<void(const std::vector<double>&)>& set);
};

/// A matrix as a list of its rows, for results: it is not read.
struct Rows : Value {
  explicit Rows(const Eigen::MatrixXd& matrix);
};

/// A covariance of six numbers in SI as a list of its rows: symmetric to 1e-9 of the deviations,
/// and positive semidefinite to 1e-9 of its correlations.
struct Covariance : Value {
  explicit Covariance(Matrix6d& x);
};

struct JointOptions {
  bool for_all = true;
  std::optional<double> without = {};  ///< of every joint, when the field is not stated
};

/// One number per joint: a list of n, a map that names every joint, or, where `for_all` allows it,
/// one number for all. Written by name. An empty vector is not written.
struct JointValues : Value {
  JointValues(JointVectord& x, const RobotModel& robot, JointDimension dimension, Range range,
              const JointOptions& options = {});
};

/// Flags per joint: `all`, `none` or a list of names.
struct JointFlags : Value {
  JointFlags(std::vector<bool>& x, const RobotModel& robot);
};

std::vector<std::string> joint_names(const RobotModel& robot);
std::vector<std::string> link_names(const RobotModel& robot);

// Tables that several sections share.

void format_fields(Table& t, const std::string& format);
/// Position and orientation. @param what the pose is that of, in words
void pose_fields(Table& t, Pose& pose, const std::string& what, const std::string& frame,
                 const Range& places = kAny);
/// {sphere: {radius}}, {capsule: {radius, length}}, {cylinder: {radius, length}}, {box: {size}} or
/// {convex_mesh: {vertices, faces}}.
Map geometry_of(Geometry& geometry);
/// The keys that the model of a joint resistance needs.
void resistance_values(Table& t, JointResistance& resistance, const RobotModel& robot);
/// The model's name, or a map of it and its keys.
Map resistance_of(JointResistance& resistance, const RobotModel& robot);

}  // namespace stillbase::io
