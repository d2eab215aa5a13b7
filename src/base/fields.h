#pragma once
/// One list of fields per struct, written once; everything that must know the fields follows from it.
///
///   struct Spec {
///     int beams = 181;
///     static void fields(auto& s, auto&& visit) {
///       visit(Field{"beams", "1", "Number of beams.", 1, 100000}, s.beams);
///     }
///   };
///
/// Reading with errors (base/read.h), description for lists, schema and docs (base/describe.h), bytes for
/// hash and snapshot (base/bytes.h) are derived. Members may be numbers, bool, strings, enumerations with
/// `enum_names`, fixed vectors (a type with `extent` and operator[]), std::array, std::vector, std::optional
/// and structs with fields of their own.
///
/// Optional members of such a struct:
///   Status check(const Node&, const std::string& path) const   a rule between its fields, checked whenever one was read
///   static constexpr const char* list_key                      a list in place of the map is the value of this key
///   static constexpr const char* described_as                  lists of it are described once, under this name
#include <array>
#include <concepts>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace sandlot {

struct Field {
  enum Flags : unsigned {
    none = 0,
    tunable = 1,   ///< may change while the run goes on; lives in State
    required = 2,  ///< a file must give it
    apart = 4,     ///< tunable, but its owner saves it, not write_tunables()
  };
  const char* key;
  const char*
      unit;  ///< "m", "rad", "s", ... SI; "1" for pure numbers; "" where units make no sense. Of a field
             ///< within a field: "" takes the outer one's unit U, "U/s" derives from it.
  const char* help;
  double min =
      -1e12;          ///< inclusive; finite, so that an infinity is refused too. Also bounds vector elements.
  double max = 1e12;  ///< inclusive
  unsigned flags = none;
  std::size_t max_count = 100'000;  ///< limit on the length of lists and strings
  std::size_t min_count = 0;        ///< of lists
};

/// The unit of a field within a field that has the unit `outer`: "" is `outer`, "U/s" is it per second.
inline std::string unit_within(std::string_view unit, std::string_view outer) {
  if (unit.empty()) return std::string(outer);
  if (unit.substr(0, 2) != "U/") return std::string(unit);
  return outer.empty() ? std::string() : std::string(outer) + std::string(unit.substr(1));
}

/// One name of an enumeration. `std::span<const EnumName<E>> enum_names(E)` is found by argument lookup.
template <class E>
struct EnumName {
  const char* name;
  E value;
};

template <class T>
concept Fielded = requires(T& t) {
  std::remove_cvref_t<T>::fields(t, [](const Field&, auto&) {});
};
template <class T>
concept FixedVector = requires(T& t) {
  { std::remove_cvref_t<T>::extent } -> std::convertible_to<std::size_t>;
  t[std::size_t{0}];
};
template <class T>
concept Number = std::is_arithmetic_v<T>;  // bool included; handled first where it matters
template <class T>
concept NamedEnum = std::is_enum_v<T> && requires(T t) {
  enum_names(t);
};

/// Name of an enumerator; "" for a value that has none.
template <NamedEnum E>
const char* name_of(E value) {
  for (const auto& entry : enum_names(value))
    if (entry.value == value) return entry.name;
  return "";
}

/// A part of a value that goes by a name of its own, such as `x` of a vector or `yaw` of a pose.
struct Component {
  const char* name;
  const char* unit;  ///< "": that of the field
};
/// `components(v)` and `component(v, i)` are found by argument lookup.
template <class T>
concept Componented = requires(const T& v, std::size_t i) {
  { components(v) } -> std::convertible_to<std::span<const Component>>;
  { component(v, i) } -> std::same_as<double>;
};

template <class T>
struct is_vector : std::false_type {};
template <class T>
struct is_vector<std::vector<T>> : std::true_type {};
template <class T>
struct is_array : std::false_type {};
template <class T, std::size_t N>
struct is_array<std::array<T, N>> : std::true_type {};
template <class T>
struct is_optional : std::false_type {};
template <class T>
struct is_optional<std::optional<T>> : std::true_type {};

/// A spec without fields.
struct NoFields {
  static void fields(auto&, auto&&) {}
};

}  // namespace sandlot
