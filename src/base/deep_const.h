#pragma once
/// Pointers that pass constness on: what a const one points at is const, too, so that a reader of a const object changes
/// nothing behind it. The standard has it as std::experimental::propagate_const.
#include <memory>
#include <type_traits>
#include <utility>

namespace sandlot {

template <class Pointer>
class DeepConst {
 public:
  using Element = std::remove_reference_t<decltype(*std::declval<Pointer&>())>;

  DeepConst() = default;
  template <class Other>
  requires std::is_convertible_v<Other, Pointer> DeepConst(
      Other pointer)                     // NOLINT(google-explicit-constructor)
      : pointer_(std::move(pointer)) {}  // as a pointer is made of another
  DeepConst(DeepConst&&) = default;
  DeepConst& operator=(DeepConst&&) = default;
  DeepConst(const DeepConst&) = delete;  // a copy of a const one would not be const
  DeepConst& operator=(const DeepConst&) = delete;

  explicit operator bool() const { return static_cast<bool>(pointer_); }
  Element* get() { return bare(); }
  const Element* get() const { return bare(); }
  Element& operator*() { return *pointer_; }
  const Element& operator*() const { return *pointer_; }
  Element* operator->() { return get(); }
  const Element* operator->() const { return get(); }

 private:
  Element* bare() const {
    if constexpr (std::is_pointer_v<Pointer>) return pointer_;
    else return pointer_.get();
  }

  Pointer pointer_{};
};

/// Owns one T.
template <class T>
using Owned = DeepConst<std::unique_ptr<T>>;

}  // namespace sandlot
