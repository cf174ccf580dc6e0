// Values that a table of fields is made of: numbers with units, words, names, vectors, joints.
#pragma once

#include <string>
#include <vector>

#include <stillbase/robot/robot_model.hpp>

#include "io/field_reader.hpp"
#include "io/fields/table.hpp"

namespace stillbase::io {

/// Where a value is kept: in a variable, or in one that may be empty.
template <class T>
class Slot {
 public:
  Slot(T& x) : x_(&x) {}
  Slot(std::optional<T>& x) : optional_(&x) {}
  bool has() const { return x_ != nullptr || optional_->has_value(); }
  const T& get() const { return x_ != nullptr ? *x_ : **optional_; }
  void set(const T& x) {
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

/// A value that one word or number of a file holds.
class Scalar : public Value {
 public:
  static bool looks_like_one(const Node& node) {
    return node.kind == Node::Kind::Plain || node.kind == Node::Kind::Quoted;
  }
  bool fits(const Node& node) const override { return looks_like_one(node); }
};

class Number : public Scalar {
 public:
  explicit Number(Slot<double> x, Dimension dimension = Dimension::None, Range range = kAny)
      : x_(x), dimension_(dimension), range_(range) {}
  Number(Slot<double> x, Range range) : Number(x, Dimension::None, range) {}
  bool read(ReadContext& context, const Node& node, const std::string& path) override;
  Json write() const override { return x_.get(); }
  bool is_written() const override { return x_.has(); }
  Shape shape(Definitions& definitions) override;

 private:
  Slot<double> x_;
  Dimension dimension_;
  Range range_;
};

/// A whole number between two others.
class Integer : public Scalar {
 public:
  Integer(int& x, int lower, int upper) : int_(&x), lower_(lower), upper_(upper) {}
  Integer(long& x, int lower, int upper) : long_(&x), lower_(lower), upper_(upper) {}
  bool read(ReadContext& context, const Node& node, const std::string& path) override;
  Json write() const override { return int_ != nullptr ? Json(*int_) : Json(*long_); }
  Shape shape(Definitions& definitions) override;

 private:
  int* int_ = nullptr;
  long* long_ = nullptr;
  int lower_, upper_;
};

/// A number of a list of whole numbers up to 2^53.
class Seed : public Scalar {
 public:
  explicit Seed(std::uint64_t& x) : x_(x) {}
  bool read(ReadContext& context, const Node& node, const std::string& path) override;
  Json write() const override { return x_; }
  Shape shape(Definitions& definitions) override;

 private:
  std::uint64_t& x_;
};

class Flag : public Scalar {
 public:
  explicit Flag(bool& x) : x_(x) {}
  bool read(ReadContext& context, const Node& node, const std::string& path) override;
  Json write() const override { return x_; }
  Shape shape(Definitions& definitions) override;

 private:
  bool& x_;
};

/// Any text, or one of these names when they are known. @param what the names are, for messages
class Text : public Scalar {
 public:
  explicit Text(std::string& x) : x_(x) {}
  Text(std::string& x, std::vector<std::string> names, std::string what)
      : x_(x), names_(std::move(names)), what_(std::move(what)) {}
  bool read(ReadContext& context, const Node& node, const std::string& path) override;
  Json write() const override { return x_; }
  Shape shape(Definitions& definitions) override;

 private:
  std::string& x_;
  std::vector<std::string> names_;
  std::string what_;
};

/// The one text that is allowed there.
class Exactly : public Scalar {
 public:
  explicit Exactly(std::string text) : text_(std::move(text)) {}
  bool read(ReadContext& context, const Node& node, const std::string& path) override;
  Json write() const override { return text_; }
  Shape shape(Definitions& definitions) override;

 private:
  std::string text_;
};

/// A word among alternatives that stands for a state of the data.
template <class Make>
class Instead : public Scalar {
 public:
  Instead(std::string word, bool is_now, Make make)
      : word_(std::move(word)), is_now_(is_now), make_(make) {}
  bool read(ReadContext&, const Node&, const std::string&) override {
    make_();
    return true;
  }
  Json write() const override { return word_; }
  bool is_written() const override { return is_now_; }
  Shape shape(Definitions&) override { return {{{"const", word_}}}; }
  bool fits(const Node& node) const override { return Scalar::fits(node) && node.text == word_; }

 private:
  std::string word_;
  bool is_now_;
  Make make_;
};

/// A word of a closed list.
class WordValue : public Scalar {
 public:
  explicit WordValue(std::vector<std::string> words) : words_(std::move(words)) {}
  const std::vector<std::string>& words() const { return words_; }
  virtual void choose(std::size_t i) = 0;
  bool read(ReadContext& context, const Node& node, const std::string& path) override;
  Shape shape(Definitions& definitions) override;

 private:
  std::vector<std::string> words_;
};

template <class E>
class Word : public WordValue {
 public:
  Word(E& x, const Names<E>& names) : WordValue(words_of(names)), x_(x), names_(names) {}
  void choose(std::size_t i) override { x_ = names_[i].second; }
  Json write() const override { return word_of(names_, x_); }

 private:
  E& x_;
  const Names<E>& names_;
};

enum class VectorKind { Any, Direction, Unit };

/// Three numbers. A direction has any length but zero and is made a unit vector; a unit vector has
/// norm 1 to 1e-6 as written.
class Vector : public Value {
 public:
  explicit Vector(Slot<Vector3d> x, Dimension dimension = Dimension::None, Range range = kAny)
      : x_(x), dimension_(dimension), range_(range) {}
  Vector(Slot<Vector3d> x, VectorKind kind) : x_(x), kind_(kind) {}
  bool read(ReadContext& context, const Node& node, const std::string& path) override;
  Json write() const override { return array_json(x_.get()); }
  bool is_written() const override { return x_.has(); }
  Shape shape(Definitions& definitions) override;
  bool fits(const Node& node) const override { return node.kind == Node::Kind::Sequence; }

 protected:
  Slot<Vector3d> x_;
  Dimension dimension_ = Dimension::None;
  VectorKind kind_ = VectorKind::Any;
  Range range_;
};

/// Three numbers, or one for all three.
class Deviation : public Vector {
 public:
  using Vector::Vector;
  bool read(ReadContext& context, const Node& node, const std::string& path) override;
  Shape shape(Definitions& definitions) override;
};

/// {w, x, y, z} of norm 1 to 1e-6, {rpy: [roll, pitch, yaw]} as in URDF, or {axis: , angle: }. A
/// quaternion of norm 1 to rounding is kept bit for bit.
class Orientation : public Value {
 public:
  explicit Orientation(Slot<Eigen::Quaterniond> x) : x_(x) {}
  bool read(ReadContext& context, const Node& node, const std::string& path) override;
  Json write() const override { return quaternion_json(x_.get()); }
  bool is_written() const override { return x_.has(); }
  Shape shape(Definitions& definitions) override;
  bool fits(const Node& node) const override { return node.kind == Node::Kind::Map; }

 private:
  Slot<Eigen::Quaterniond> x_;
};

/// A list of numbers of one size (`size` < 0: any) without units, e.g. joints in their order.
template <class V>
class Numbers : public Value {
 public:
  explicit Numbers(V& x, int size = -1) : x_(x), size_(size) {}
  bool read(ReadContext& context, const Node& node, const std::string& path) override {
    const auto values = read_numbers(context, node, path, Dimension::None, size_);
    if (!values) return false;
    x_.resize(static_cast<decltype(x_.size())>(values->size()));
    std::copy(values->begin(), values->end(), x_.begin());
    return true;
  }
  Json write() const override { return Json(std::vector<double>(x_.begin(), x_.end())); }
  Shape shape(Definitions&) override {
    Json schema{{"type", "array"}, {"items", {{"type", "number"}}}};
    if (size_ > 0) schema.update({{"minItems", size_}, {"maxItems", size_}});
    return {schema};
  }
  bool fits(const Node& node) const override { return node.kind == Node::Kind::Sequence; }

 private:
  V& x_;
  int size_;
};

/// One number per joint: a list of n, a map that names every joint, or, where `for_all` allows it,
/// one number for all. Written by name. An empty vector is not written.
class JointValues : public Value {
 public:
  struct Also {
    bool for_all = true;
    std::optional<double> without = {};  ///< of every joint, when the field is not stated
  };
  JointValues(JointVectord& x, const RobotModel& robot, JointDimension dimension, Range range)
      : JointValues(x, robot, dimension, range, Also{}) {}
  JointValues(JointVectord& x, const RobotModel& robot, JointDimension dimension, Range range,
              Also also)
      : x_(x), robot_(robot), dimension_(dimension), range_(range), also_(also) {}
  bool read(ReadContext& context, const Node& node, const std::string& path) override;
  bool leave_out(ReadContext&, const std::string&) override {
    if (also_.without) x_ = JointVectord::Constant(robot_.n(), *also_.without);
    return false;
  }
  Json write() const override;
  bool is_written() const override { return x_.size() > 0; }
  Shape shape(Definitions& definitions) override;
  bool fits(const Node&) const override { return true; }

 private:
  JointVectord& x_;
  const RobotModel& robot_;
  JointDimension dimension_;
  Range range_;
  Also also_;
};

/// Flags per joint: `all`, `none` or a list of names.
class JointFlags : public Value {
 public:
  JointFlags(std::vector<bool>& x, const RobotModel& robot) : x_(x), robot_(robot) {}
  bool read(ReadContext& context, const Node& node, const std::string& path) override;
  bool leave_out(ReadContext&, const std::string&) override {
    x_.assign(robot_.joints.size(), true);
    return false;
  }
  Json write() const override;
  Shape shape(Definitions& definitions) override;
  bool fits(const Node&) const override { return true; }

 private:
  std::vector<bool>& x_;
  const RobotModel& robot_;
};

std::vector<std::string> joint_names(const RobotModel& robot);
std::vector<std::string> link_names(const RobotModel& robot);

// Tables that several sections share.

void format_fields(Table& t, const std::string& format);
/// Position and orientation. @param what the pose is that of, in words
void pose_fields(Table& t, Pose& pose, const std::string& what, const std::string& frame);
/// {sphere: {radius}}, {capsule: {radius, length}}, {cylinder: {radius, length}}, {box: {size}} or
/// {convex_mesh: {vertices, faces}}.
Map geometry_of(Geometry& geometry);
/// The keys that the model of a joint resistance needs.
void resistance_values(Table& t, JointResistance& resistance, const RobotModel& robot);

}  // namespace stillbase::io
