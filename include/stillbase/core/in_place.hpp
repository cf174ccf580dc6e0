// Arrays and matrices whose elements are within the object up to a size, on the heap beyond it.
#pragma once

#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>
#include <memory>

#include <Eigen/Core>

namespace stillbase {

/// An array of any size; up to kInPlace elements need no heap. Elements are not initialised.
template <class T, std::size_t kInPlace>
class InPlaceArray {
 public:
  InPlaceArray() = default;
  InPlaceArray(const InPlaceArray& other) { *this = other; }
  InPlaceArray& operator=(const InPlaceArray& other) {
    if (this == &other) return *this;
    resize(other.size_);
    std::copy(other.data_, other.data_ + size_, data_);
    return *this;
  }
  ~InPlaceArray() = default;

  /// Without a call there are kInPlace elements. Does not keep the elements.
  void resize(std::size_t size) {
    if (size > kInPlace && size != size_) heap_ = std::make_unique<T[]>(size);
    data_ = size > kInPlace ? heap_.get() : in_place_.data();
    size_ = size;
  }

  T* data() { return data_; }
  const T* data() const { return data_; }
  T& operator[](std::size_t i) {
    assert(i < size_);
    return data_[i];
  }
  const T& operator[](std::size_t i) const {
    assert(i < size_);
    return data_[i];
  }

 private:
  alignas(alignof(T) < 16 ? 16 : alignof(T)) std::array<T, kInPlace> in_place_;
  std::unique_ptr<T[]> heap_;
  T* data_ = in_place_.data();
  std::size_t size_ = kInPlace;
};

/// A matrix of any size; up to kInPlaceColumns columns and as many rows need no heap. Its elements
/// lie column by column, as in Eigen's own matrices.
template <class S, int kInPlaceColumns>
class InPlaceMatrix : public Eigen::Map<Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>> {
 public:
  using View = Eigen::Map<Eigen::Matrix<S, Eigen::Dynamic, Eigen::Dynamic>>;

  InPlaceMatrix() : View(nullptr, 0, 0) {}
  InPlaceMatrix(const InPlaceMatrix& other) : InPlaceMatrix() { *this = other; }
  template <class Derived>
  InPlaceMatrix(const Eigen::EigenBase<Derived>& other) : InPlaceMatrix() {  // NOLINT: as Eigen's
    *this = other;
  }
  ~InPlaceMatrix() = default;

  InPlaceMatrix& operator=(const InPlaceMatrix& other) {
    return *this = static_cast<const Eigen::EigenBase<View>&>(other);
  }
  template <class Derived>
  InPlaceMatrix& operator=(const Eigen::EigenBase<Derived>& other) {
    resize(other.rows(), other.cols());
    View::operator=(other.derived());
    return *this;
  }

  /// Keeps the elements where the size stays.
  void resize(Eigen::Index rows, Eigen::Index columns) {
    if (rows == this->rows() && columns == this->cols()) return;
    elements_.resize(static_cast<std::size_t>(rows * columns));
    new (static_cast<View*>(this)) View(elements_.data(), rows, columns);
  }

 private:
  InPlaceArray<S, static_cast<std::size_t>(kInPlaceColumns) * kInPlaceColumns> elements_;
};

}  // namespace stillbase
