#pragma once
/// Type information at run time: what values of a type hold, and functions that reach their parts. Made from
/// field lists (base/fields.h), so that the code that reads, describes and lists specs, states and messages
/// is written and compiled once, not once for every struct.
///
///   const TypeInfo& type = type_info<Spec>;       // to look at a value
///   const TypeEdit& edit = type_edit<Spec>;       // to change one
///
/// Fields are visited, not listed with their places in memory: a field list may depend on the value (the
/// stages of a chain, the sort of a stage), and the member that it shows may be a copy that is put back
/// afterwards (StageOf). Therefore pointers to members are good only while field() is at work.
///
/// Cost     one visit is one virtual call for each field. Bytes of State, which are hashed in every tick, do
///          not come this way: base/bytes.h generates code for each type.
/// Threads  the tables are constant.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>

#include "base/fields.h"
#include "base/node.h"
#include "base/result.h"
#include "base/time.h"

namespace sandlot {

enum class Holds : std::uint8_t {
  boolean,
  number,
  enumeration,  ///< with or without names
  time,
  text,     ///< a std::string
  node,     ///< a Node
  option,   ///< a std::optional
  fixed,    ///< a std::array or a fixed vector
  list,     ///< a std::vector
  fielded,  ///< a struct with a field list
  other,    ///< plain bytes: nobody looks into them
};

struct TypeInfo;
struct TypeEdit;

/// Is shown the fields of a struct in the order of its list.
struct FieldVisitor {
  virtual void field(const Field& field, const TypeInfo& type, const void* member) = 0;

 protected:
  ~FieldVisitor() = default;
};
struct FieldEditor {
  virtual void field(const Field& field, const TypeEdit& type, void* member) = 0;

 protected:
  ~FieldEditor() = default;
};
/// Gives a fresh value what it is to be.
struct Filler {
  virtual Status fill(void* value) = 0;

 protected:
  ~Filler() = default;
};

/// Every function takes the address of a value of the type; those that make no sense for it are null.
struct TypeInfo {
  Holds holds = Holds::other;
  // Booleans, numbers, enumerations (their value) and times (in seconds):
  double (*number)(const void*) = nullptr;
  bool integral = false;
  double lowest = 0, highest = 0;  ///< what a number can hold, and a double holds exactly
  // Enumerations with names:
  const char* (*choice)(std::size_t i) = nullptr;  ///< name i; null behind the last
  const char* (*name)(const void*) = nullptr;      ///< "" for a value without one
  // Lists of both sorts and options: their elements. An option holds one or none.
  const TypeInfo* element = nullptr;
  std::size_t extent = 0;  ///< of fixed ones
  bool is_array = false;   ///< of fixed ones: a std::array
  std::size_t (*size)(const void*) = nullptr;
  const void* (*at)(const void*, std::size_t i) = nullptr;
  const void* (*blank)() = nullptr;  ///< an element as it is made
  // Structs with fields:
  void (*visit)(const void*, FieldVisitor&) = nullptr;
  Status (*check)(const void*, const Node&, const std::string& path) = nullptr;  ///< null without rules
  const char* list_key = nullptr;
  const char* described_as = nullptr;
  // Values with components, which may be structs with fields or fixed vectors as well:
  std::span<const Component> (*parts)(const void*) = nullptr;
  double (*part)(const void*, std::size_t i) = nullptr;

  bool plain() const { return holds <= Holds::time; }
};

/// The same for those who write. Text is a std::string, a node a Node: they need no function.
struct TypeEdit {
  const TypeInfo* info = nullptr;
  void (*set_number)(void*, double) = nullptr;       ///< of booleans and numbers
  void (*set_choice)(void*, std::size_t) = nullptr;  ///< of enumerations with names
  const TypeEdit* element = nullptr;
  void* (*at)(void*, std::size_t i) = nullptr;  ///< of lists of both sorts but std::vector<bool>, and options
  void (*clear)(void*) = nullptr;               ///< of lists
  /// A new element at the end of a list, or a new value of an option, which begins as the old one. Nothing
  /// happens if `fill` fails.
  Status (*add)(void*, Filler& fill) = nullptr;
  void (*visit)(void*, FieldEditor&) = nullptr;
};

template <class T>
constexpr TypeInfo make_type_info();
template <class T>
constexpr TypeEdit make_type_edit();
template <class T>
inline constexpr TypeInfo type_info = make_type_info<T>();
template <class T>
inline constexpr TypeEdit type_edit = make_type_edit<T>();

/// Code generated for each struct with fields. A struct that many use may have it compiled in one place:
/// SL_EXTERN_FIELDS in its header, SL_COMPILE_FIELDS in its source.
template <class T>
struct StructAccess {
  static void visit(const void* x, FieldVisitor& visitor) {
    T::fields(*static_cast<const T*>(x), [&](const Field& f, const auto& member) {
      visitor.field(f, type_info<std::remove_cvref_t<decltype(member)>>, std::addressof(member));
    });
  }
  static void edit(void* x, FieldEditor& editor) {
    T::fields(*static_cast<T*>(x), [&](const Field& f, auto& member) {
      editor.field(f, type_edit<std::remove_cvref_t<decltype(member)>>, std::addressof(member));
    });
  }
};
#define SL_EXTERN_FIELDS(T)                                                \
  extern template void StructAccess<T>::visit(const void*, FieldVisitor&); \
  extern template void StructAccess<T>::edit(void*, FieldEditor&)
#define SL_COMPILE_FIELDS(T)                                        \
  template void StructAccess<T>::visit(const void*, FieldVisitor&); \
  template void StructAccess<T>::edit(void*, FieldEditor&)

template <class T>
constexpr TypeInfo make_type_info() {
  TypeInfo info;
  constexpr bool is_fixed = FixedVector<T> || is_array<T>::value;
  if constexpr (std::is_same_v<T, bool>) {
    info.holds = Holds::boolean;
    info.number = [](const void* x) -> double { return *static_cast<const bool*>(x) ? 1 : 0; };
  } else if constexpr (Number<T>) {
    info.holds = Holds::number;
    info.number = [](const void* x) { return static_cast<double>(*static_cast<const T*>(x)); };
    info.integral = std::is_integral_v<T>;
    info.lowest = static_cast<double>(std::numeric_limits<T>::lowest());
    info.highest = static_cast<double>(std::numeric_limits<T>::max());
    if (info.integral) {
      constexpr double exact = 9007199254740992.0;  // 2^53
      info.lowest = std::max(info.lowest, -exact);
      info.highest = std::min(info.highest, exact);
    }
  } else if constexpr (std::is_enum_v<T>) {
    info.holds = Holds::enumeration;
    info.number = [](const void* x) {
      return static_cast<double>(static_cast<std::underlying_type_t<T>>(*static_cast<const T*>(x)));
    };
    if constexpr (NamedEnum<T>) {
      info.choice = [](std::size_t i) -> const char* {
        const auto names = enum_names(T{});
        return i < names.size() ? names[i].name : nullptr;
      };
      info.name = [](const void* x) -> const char* { return name_of(*static_cast<const T*>(x)); };
    }
  } else if constexpr (std::is_same_v<T, Time>) {
    info.holds = Holds::time;
    info.number = [](const void* x) { return static_cast<const Time*>(x)->s(); };
  } else if constexpr (std::is_same_v<T, std::string>) {
    info.holds = Holds::text;
  } else if constexpr (std::is_same_v<T, Node>) {
    info.holds = Holds::node;
  } else if constexpr (is_optional<T>::value) {
    using Value = typename T::value_type;
    info.holds = Holds::option;
    info.element = &type_info<Value>;
    info.size = [](const void* x) -> std::size_t { return static_cast<const T*>(x)->has_value() ? 1 : 0; };
    info.at = [](const void* x, std::size_t) -> const void* {
      return std::addressof(**static_cast<const T*>(x));
    };
    info.blank = []() -> const void* {
      static const Value blank{};
      return &blank;
    };
  } else if constexpr (is_fixed) {
    using Element = std::remove_cvref_t<decltype(std::declval<const T&>()[std::size_t{0}])>;
    info.holds = Holds::fixed;
    info.element = &type_info<Element>;
    info.is_array = is_array<T>::value;
    if constexpr (FixedVector<T>) info.extent = T::extent;
    else info.extent = std::tuple_size_v<T>;
    info.at = [](const void* x, std::size_t i) -> const void* {
      return std::addressof((*static_cast<const T*>(x))[i]);
    };
  } else if constexpr (is_vector<T>::value) {
    using Element = typename T::value_type;
    info.holds = Holds::list;
    info.element = &type_info<Element>;
    info.size = [](const void* x) { return static_cast<const T*>(x)->size(); };
    info.at = [](const void* x, std::size_t i) -> const void* {
      if constexpr (std::is_same_v<Element, bool>) {
        static constexpr bool values[2] = {false, true};
        return &values[(*static_cast<const T*>(x))[i] ? 1 : 0];
      } else {
        return std::addressof((*static_cast<const T*>(x))[i]);
      }
    };
    info.blank = []() -> const void* {
      static const Element blank{};
      return &blank;
    };
  } else if constexpr (Fielded<T>) {
    info.holds = Holds::fielded;
    info.visit = StructAccess<T>::visit;
    if constexpr (requires(const T& x, const Node& n, const std::string& s) { x.check(n, s); })
      info.check = [](const void* x, const Node& node, const std::string& path) -> Status {
        return static_cast<const T*>(x)->check(node, path);
      };
    if constexpr (requires { T::list_key; }) info.list_key = T::list_key;
    if constexpr (requires { T::described_as; }) info.described_as = T::described_as;
  }
  if constexpr (Componented<T>) {
    info.parts = [](const void* x) -> std::span<const Component> {
      return components(*static_cast<const T*>(x));
    };
    info.part = [](const void* x, std::size_t i) -> double {
      return component(*static_cast<const T*>(x), i);
    };
  }
  return info;
}

template <class T>
constexpr TypeEdit make_type_edit() {
  TypeEdit edit;
  edit.info = &type_info<T>;
  if constexpr (Number<T>) {
    edit.set_number = [](void* x, double number) {
      if constexpr (std::is_same_v<T, bool>) *static_cast<T*>(x) = number != 0;
      else *static_cast<T*>(x) = static_cast<T>(number);
    };
  } else if constexpr (NamedEnum<T>) {
    edit.set_choice = [](void* x, std::size_t i) { *static_cast<T*>(x) = enum_names(T{})[i].value; };
  } else if constexpr (std::is_same_v<T, std::string> || std::is_same_v<T, Node>) {
    // They are known.
  } else if constexpr (is_optional<T>::value) {
    using Value = typename T::value_type;
    edit.element = &type_edit<Value>;
    edit.at = [](void* x, std::size_t) -> void* { return std::addressof(**static_cast<T*>(x)); };
    edit.add = [](void* x, Filler& filler) -> Status {
      T& option = *static_cast<T*>(x);
      Value value{};
      if (option) value = *option;
      SL_TRY(filler.fill(&value));
      option = std::move(value);
      return {};
    };
  } else if constexpr (FixedVector<T> || is_array<T>::value) {
    using Element = std::remove_reference_t<decltype(std::declval<T&>()[std::size_t{0}])>;
    edit.element = &type_edit<Element>;
    edit.at = [](void* x, std::size_t i) -> void* { return std::addressof((*static_cast<T*>(x))[i]); };
  } else if constexpr (is_vector<T>::value) {
    using Element = typename T::value_type;
    edit.element = &type_edit<Element>;
    if constexpr (!std::is_same_v<Element, bool>)
      edit.at = [](void* x, std::size_t i) -> void* { return std::addressof((*static_cast<T*>(x))[i]); };
    edit.clear = [](void* x) { static_cast<T*>(x)->clear(); };
    edit.add = [](void* x, Filler& filler) -> Status {
      Element element{};
      SL_TRY(filler.fill(&element));
      static_cast<T*>(x)->push_back(std::move(element));
      return {};
    };
  } else {
    static_assert(Fielded<T>, "a field must be a number, text, enumeration, list or a struct with fields");
    edit.visit = StructAccess<T>::edit;
  }
  return edit;
}

}  // namespace sandlot
