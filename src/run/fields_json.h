#pragma once
/// JSON of a struct by its field list. Optional numbers are null when unset, optional groups are left out; lists of Named are
/// objects.
#include <nlohmann/json.hpp>

#include "run/summary.h"

namespace sandlot {

template <class T>
nlohmann::ordered_json value_json(const T& value);

template <class T>
nlohmann::ordered_json list_json(const std::vector<T>& list) {
  nlohmann::ordered_json out = nlohmann::ordered_json::array();
  for (const T& each : list) out.push_back(value_json(each));
  return out;
}

template <class T>
nlohmann::ordered_json list_json(const std::vector<Named<T>>& list) {
  nlohmann::ordered_json out = nlohmann::ordered_json::object();
  for (const Named<T>& each : list) out[each.name] = value_json(each.value);
  return out;
}

template <class T>
nlohmann::ordered_json fields_json(const T& fielded) {
  nlohmann::ordered_json out;
  T::fields(fielded, [&](const Field& field, const auto& member) {
    using Member = std::remove_cvref_t<decltype(member)>;
    if constexpr (is_optional<Member>::value) {
      if constexpr (Fielded<typename Member::value_type>)
        if (!member) return;
    }
    out[field.key] = value_json(member);
  });
  return out;
}

template <class T>
nlohmann::ordered_json value_json(const T& value) {
  if constexpr (std::is_same_v<T, StateHash>) return hash_text(value.value);
  else if constexpr (is_optional<T>::value)
    return value ? value_json(*value) : nlohmann::ordered_json(nullptr);
  else if constexpr (is_vector<T>::value) return list_json(value);
  else if constexpr (Fielded<T>) return fields_json(value);
  else return value;
}

}  // namespace sandlot
