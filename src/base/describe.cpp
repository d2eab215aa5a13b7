#include "base/describe.h"

namespace sandlot {
namespace {

/// A value as a file would write it.
std::string file_text(const TypeInfo& type, const void* value) {
  switch (type.holds) {
    case Holds::text: return *static_cast<const std::string*>(value);
    case Holds::boolean: return type.number(value) != 0 ? "true" : "false";
    case Holds::number: return number_text(type.number(value));
    case Holds::enumeration: return type.name(value);
    default: break;
  }
  std::string text = "[";
  const std::size_t size = type.holds == Holds::fixed ? type.extent : type.size(value);
  for (std::size_t i = 0; i < size; ++i)
    text += (i ? ", " : "") + file_text(*type.element, type.at(value, i));
  return text + "]";
}

void describe_value(const Field& f, const TypeInfo& type, const void* value, const std::string& path,
                    std::vector<FieldInfo>& out, bool optional) {
  FieldInfo info{path,
                 "",
                 f.unit,
                 f.help,
                 f.min,
                 f.max,
                 (f.flags & Field::tunable) != 0,
                 (f.flags & Field::required) != 0,
                 optional};
  switch (type.holds) {
    case Holds::boolean: info.type = "bool"; break;
    case Holds::number: info.type = type.integral ? "integer" : "number"; break;
    case Holds::enumeration:
      info.type = "choice";
      for (std::size_t i = 0; const char* const name = type.choice(i); ++i) info.choices.emplace_back(name);
      break;
    case Holds::text: info.type = "text"; break;
    case Holds::node:
      info.type = "map";
      out.push_back(std::move(info));
      return;
    case Holds::fixed:
      info.type = "list of number";
      info.length = type.extent;
      break;
    case Holds::list: {
      const TypeInfo& element = *type.element;
      if (element.holds == Holds::fielded) {
        info.type = "list of maps";
        info.min_count = f.min_count;
        info.max_count = f.max_count;
        if (element.described_as) info.elements = element.described_as;
        out.push_back(info);
        if (info.elements.empty()) describe_struct(element, type.blank(), path + "[]/", f.unit, out, false);
        return;
      }
      info.type = element.holds == Holds::number || element.holds == Holds::boolean ? "list of number"
                                                                                    : "list of text";
      if (element.holds == Holds::fixed) {
        info.type = "list of lists of number";
        info.length = element.extent;
      }
      break;
    }
    case Holds::option: {
      const bool set = type.size(value) != 0;
      describe_value(f, *type.element, set ? type.at(value, 0) : type.blank(), path, out, true);
      if (!set && type.element->holds != Holds::fielded)
        out.back().default_value.clear();  // unset is not a value
      return;
    }
    case Holds::fielded: describe_struct(type, value, path + "/", f.unit, out, optional); return;
    case Holds::time:
    case Holds::other: return;  // no spec has them
  }
  info.default_value = file_text(type, value);
  out.push_back(std::move(info));
}

}  // namespace

void describe_struct(const TypeInfo& type, const void* value, const std::string& prefix,
                     std::string_view unit, std::vector<FieldInfo>& out, bool optional) {
  struct Describe final : FieldVisitor {
    const std::string& prefix;
    std::string_view unit, list_key;
    std::vector<FieldInfo>& out;
    bool optional;

    Describe(const std::string& p, std::string_view u, const char* k, std::vector<FieldInfo>& o, bool opt)
        : prefix(p), unit(u), list_key(k ? k : ""), out(o), optional(opt) {}
    void field(const Field& inner, const TypeInfo& member_type, const void* member) override {
      const std::string own_unit = unit_within(inner.unit, unit);
      Field f = inner;
      f.unit = own_unit.c_str();
      const std::size_t first = out.size();
      describe_value(f, member_type, member, prefix + f.key, out, optional);
      if (!list_key.empty() && f.key == list_key) out[first].for_map = true;
    }
  } describe(prefix, unit, type.list_key, out, optional);
  type.visit(value, describe);
}

}  // namespace sandlot
