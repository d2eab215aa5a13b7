#include "base/values.h"

#include <cctype>
#include <charconv>

namespace sandlot {

Result<ValuePath> parse_value_path(std::string_view text) {
  constexpr std::size_t most_steps = 16, longest = 256;
  const auto wrong = [&](const std::string& what) {
    return Error{"'" + std::string(text.substr(0, 80)) + "' is not a path of a value: " + what,
                 "such as ranges[3] or pose.position.x"};
  };
  if (text.empty() || text.size() > longest) return wrong(text.empty() ? "it is empty" : "it is too long");
  const auto in_name = [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-';
  };
  ValuePath path;
  for (std::size_t at = 0; at < text.size();) {
    if (path.size() == most_steps) return wrong("more than " + std::to_string(most_steps) + " steps");
    if (text[at] == '[') {
      std::size_t index = 0;
      const auto [end, error] = std::from_chars(text.data() + at + 1, text.data() + text.size(), index);
      if (error != std::errc() || end == text.data() + text.size() || *end != ']')
        return wrong("'[' needs a number and ']'");
      path.push_back({"", index});
      at = static_cast<std::size_t>(end - text.data()) + 1;
    } else {
      if (!path.empty() && text[at] != '.') return wrong("expected '.' or '['");
      if (!path.empty()) ++at;
      const std::size_t begin = at;
      while (at < text.size() && in_name(text[at])) ++at;
      if (at == begin) return wrong("a name is missing");
      path.push_back({std::string(text.substr(begin, at - begin))});
    }
  }
  return path;
}

std::string to_string(std::span<const ValueStep> path) {
  std::string text;
  for (const ValueStep& step : path)
    text += step.key.empty() ? "[" + std::to_string(step.index) + "]" : (text.empty() ? "" : ".") + step.key;
  return text;
}

namespace {

std::string value_unit(const TypeInfo& type, std::string_view field_unit) {
  return type.holds == Holds::time ? "s" : std::string(field_unit);
}

/// The field that a step names.
struct FindField final : FieldVisitor {
  std::string_view key, unit;
  std::span<const ValueStep> rest;
  ValueFound& out;

  FindField(std::string_view k, std::string_view u, std::span<const ValueStep> r, ValueFound& o)
      : key(k), unit(u), rest(r), out(o) {}
  void field(const Field& f, const TypeInfo& type, const void* member) override {
    if (key == f.key) find_value(type, member, unit_within(f.unit, unit), rest, out);
  }
};

}  // namespace

void find_value(const TypeInfo& type, const void* x, std::string_view unit, std::span<const ValueStep> path,
                ValueFound& out) {
  using Is = ValueFound::Is;
  out.is = Is::unknown;
  const auto absent = [&] {
    if (out.is == Is::value) out.is = Is::absent;
  };
  if (type.plain()) {
    if (path.empty()) out = {Is::value, type.number(x), value_unit(type, unit)};
    return;
  }
  if (type.holds == Holds::text || type.holds == Holds::node) {
    if (path.empty()) out.is = Is::text;
    return;
  }
  if (type.holds == Holds::option) {
    if (type.size(x)) return find_value(*type.element, type.at(x, 0), unit, path, out);
    find_value(*type.element, type.blank(), unit, path, out);
    return absent();
  }
  if (path.empty()) {
    out.is = Is::compound;
    return;
  }
  const ValueStep& step = path.front();
  const auto rest = path.subspan(1);
  if (step.key.empty()) {
    const bool list = type.holds == Holds::list;
    const std::size_t size = list ? type.size(x) : type.extent;
    if (step.index < size) return find_value(*type.element, type.at(x, step.index), unit, rest, out);
    if (!list) return;
    find_value(*type.element, type.blank(), unit, rest, out);
    return absent();
  }
  if (type.parts && rest.empty()) {
    const auto parts = type.parts(x);
    for (std::size_t i = 0; i < parts.size(); ++i)
      if (step.key == parts[i].name) {
        out = {Is::value, type.part(x, i), std::string(*parts[i].unit ? parts[i].unit : unit)};
        return;
      }
  }
  if (type.visit) {
    FindField find(step.key, unit, rest, out);
    type.visit(x, find);
  }
}

void list_values(const TypeInfo& type, const void* x, const std::string& unit, const char* help,
                 const std::string& path, const ValueVisit& visit) {
  using Is = ValueFound::Is;
  constexpr std::size_t most_elements = 16;
  const auto part = [&](const char* key) { return path.empty() ? std::string(key) : path + "." + key; };
  if (type.plain()) {
    visit({path, value_unit(type, unit), help, Is::value, type.number(x)});
  } else if (type.holds == Holds::option) {
    if (type.size(x)) return list_values(*type.element, type.at(x, 0), unit, help, path, visit);
    list_values(*type.element, type.blank(), unit, help, path, [&](ValueEntry entry) {
      entry.is = Is::absent;
      visit(std::move(entry));
    });
  } else if (type.parts) {
    const auto parts = type.parts(x);
    for (std::size_t i = 0; i < parts.size(); ++i)
      visit({part(parts[i].name), *parts[i].unit ? std::string(parts[i].unit) : unit, help, Is::value,
             type.part(x, i)});
  } else if (type.element) {
    const std::size_t size = type.holds == Holds::list ? type.size(x) : type.extent;
    const TypeInfo& element = *type.element;
    if (element.plain() && (type.holds == Holds::list || type.is_array)) {
      const double first = size ? element.number(type.at(x, 0)) : 0;
      visit({path, value_unit(element, unit), help, size ? Is::value : Is::absent, first, size, true});
      return;
    }
    for (std::size_t i = 0; i < size && (i < most_elements || !(type.holds == Holds::list || type.is_array));
         ++i)
      list_values(element, type.at(x, i), unit, help, path + "[" + std::to_string(i) + "]", visit);
  } else if (type.visit) {
    struct List final : FieldVisitor {
      const std::string& unit;
      const std::string& path;
      const ValueVisit& visit;

      List(const std::string& u, const std::string& p, const ValueVisit& v) : unit(u), path(p), visit(v) {}
      void field(const Field& f, const TypeInfo& member_type, const void* member) override {
        list_values(member_type, member, unit_within(f.unit, unit), f.help,
                    path.empty() ? std::string(f.key) : path + "." + f.key, visit);
      }
    } list(unit, path, visit);
    type.visit(x, list);
  }
}

}  // namespace sandlot
