#pragma once
/// A list whose copies share what is in it until one of them changes: what all robots of a group have in
/// common is there once, however many they are.
///
/// Cost     a copy costs a reference; the first access through a list that is not const, after it was copied,
///          a copy of all. So read through const lists (std::as_const).
/// Threads  as a std::vector; lists that share may be used by several threads.
#include <initializer_list>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace sandlot {

template <class T>
class SharedList {
 public:
  SharedList() = default;
  SharedList(std::vector<T> list)  // NOLINT(google-explicit-constructor): a list is what it holds
      : list_(list.empty() ? nullptr : std::make_shared<std::vector<T>>(std::move(list))) {}
  SharedList(std::initializer_list<T> list) : SharedList(std::vector<T>(list)) {}

  const std::vector<T>& get() const {
    static const std::vector<T> nothing;
    return list_ ? *list_ : nothing;
  }
  operator const std::vector<T>&() const { return get(); }  // NOLINT(google-explicit-constructor)
  /// The list for itself alone.
  std::vector<T>& edit() {
    if (!list_) list_ = std::make_shared<std::vector<T>>();
    else if (list_.use_count() > 1) list_ = std::make_shared<std::vector<T>>(*list_);
    return *list_;
  }
  /// One of them, which stays where it is as long as somebody has it.
  std::shared_ptr<const T> share(std::size_t i) const { return {list_, &get()[i]}; }
  bool shares_with(const SharedList& other) const { return list_ == other.list_; }

  bool empty() const { return get().empty(); }
  std::size_t size() const { return get().size(); }
  auto begin() const { return get().begin(); }
  auto end() const { return get().end(); }
  auto begin() { return edit().begin(); }
  auto end() { return edit().end(); }
  const T& operator[](std::size_t i) const { return get()[i]; }
  T& operator[](std::size_t i) { return edit()[i]; }
  const T* data() const { return get().data(); }
  const T& at(std::size_t i) const { return get().at(i); }
  const T& front() const { return get().front(); }
  T& front() { return edit().front(); }
  const T& back() const { return get().back(); }
  T& back() { return edit().back(); }
  void push_back(T element) { edit().push_back(std::move(element)); }
  void erase(std::size_t i) { edit().erase(edit().begin() + static_cast<std::ptrdiff_t>(i)); }
  void clear() { list_ = nullptr; }

 private:
  std::shared_ptr<std::vector<T>> list_;
};

}  // namespace sandlot
