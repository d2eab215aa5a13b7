#include "base/read.h"

#include <algorithm>
#include <cmath>

namespace sandlot {

Result<double> read_number(const Node& node, const Field& field, double min, double max, bool integer,
                           const std::string& path) {
  if (!node.is_scalar()) return wrong_type(node, "a number", path);
  auto quantity = parse_quantity(node.text(), *field.unit ? field.unit : "1");
  if (!quantity) {
    quantity.error().place = node.place();
    quantity.error().path = path;
    return quantity;
  }
  const double x = *quantity;
  const std::string unit = *field.unit && std::string_view(field.unit) != "1" ? " " + std::string(field.unit)
                                                                              : "";
  if (!(x >= min && x <= max))
    return node.error(
        "must be in [" + number_text(min) + ", " + number_text(max) + "]" + unit + ", is " + number_text(x),
        field.help, path);
  if (integer && x != std::floor(x))
    return node.error("must be a whole number, is " + number_text(x), "", path);
  return x;
}

Error wrong_type(const Node& node, const std::string& expected, const std::string& path) {
  return node.error("expected " + expected + ", found " + describe(node), "", path);
}

Result<bool> read_bool(const Node& node, const std::string& path) {
  const std::string& text = node.text();
  if (node.is_scalar() && (text == "true" || text == "yes" || text == "on" || text == "1")) return true;
  if (node.is_scalar() && (text == "false" || text == "no" || text == "off" || text == "0")) return false;
  return wrong_type(node, "true or false", path);
}

namespace read_detail {
namespace {

/// The error for a key that no field has.
Error unknown_key(const Node::Entry& entry, const std::vector<std::string>& known, const std::string& path) {
  const std::string fix = known.empty() ? std::string("no keys are allowed here")
                                        : suggestion(entry.key, known);
  return {"unknown key '" + entry.key.substr(0, 60) + "'", fix, entry.key_place, path};
}

Status read_choice(const Node& node, const TypeEdit& type, void* out, const std::string& path) {
  if (!node.is_scalar()) return wrong_type(node, "a name", path);
  std::vector<std::string> names;
  for (std::size_t i = 0; const char* const name = type.info->choice(i); ++i) {
    names.emplace_back(name);
    if (node.text() == name) return type.set_choice(out, i), Status();
  }
  return node.error("'" + node.text().substr(0, 40) + "' is not a choice here",
                    suggestion(node.text(), names), path);
}

struct ReadOne final : Filler {
  const Node& node;
  const Field& field;
  const TypeEdit& type;
  const std::string& path;

  ReadOne(const Node& n, const Field& f, const TypeEdit& t, const std::string& p)
      : node(n), field(f), type(t), path(p) {}
  Status fill(void* out) override { return value(node, field, type, out, path); }
};

Status read_list(const Node& node, const Field& field, const TypeEdit& type, void* out,
                 const std::string& path) {
  Field of_element = field;  // whose own length is not that of the list
  of_element.max_count = Field{}.max_count;
  if (type.info->element->holds == Holds::text && node.is_scalar()) {  // one text stands for a list of one
    auto& texts = *static_cast<std::vector<std::string>*>(out);
    texts.resize(1);
    return value(node, of_element, *type.element, &texts.front(), path);
  }
  if (!node.is_sequence()) return wrong_type(node, "a list", path);
  if (node.items().size() > field.max_count)
    return node.error("list has " + std::to_string(node.items().size()) + " elements",
                      "at most " + std::to_string(field.max_count) + " are allowed", path);
  if (node.items().size() < field.min_count)
    return node.error(node.items().empty() ? "the list is empty" : "the list is too short",
                      "at least " + std::to_string(field.min_count) +
                          (field.min_count == 1 ? " element is needed" : " elements are needed"),
                      path);
  type.clear(out);
  of_element.min_count = 0;
  for (std::size_t i = 0; i < node.items().size(); ++i) {
    const std::string here = path + "/" + std::to_string(i);
    ReadOne one(node.items()[i], of_element, *type.element, here);
    SL_TRY(type.add(out, one));
  }
  return {};
}

/// A rule between the fields of a spec, if it has one.
Status check_rules(const Node& node, const TypeInfo& type, const void* spec, const std::string& path) {
  return type.check ? type.check(spec, node, path) : Status();
}

}  // namespace

Status value(const Node& node, const Field& field, const TypeEdit& type, void* out, const std::string& path) {
  const TypeInfo& info = *type.info;
  switch (info.holds) {
    case Holds::boolean: {
      SL_ASSIGN(const bool on, read_bool(node, path));
      type.set_number(out, on ? 1 : 0);
      return {};
    }
    case Holds::number: {
      SL_ASSIGN(const double number, read_number(node, field, std::max(field.min, info.lowest),
                                                 std::min(field.max, info.highest), info.integral, path));
      type.set_number(out, number);
      return {};
    }
    case Holds::enumeration: return read_choice(node, type, out, path);
    case Holds::text:
      if (!node.is_scalar()) return wrong_type(node, "text", path);
      if (node.text().size() > field.max_count)
        return node.error("text has " + std::to_string(node.text().size()) + " characters",
                          "at most " + std::to_string(field.max_count) + " are allowed", path);
      *static_cast<std::string*>(out) = node.text();
      return {};
    case Holds::node: *static_cast<Node*>(out) = node; return {};
    case Holds::option: {
      ReadOne one(node, field, *type.element, path);
      return type.add(out, one);
    }
    case Holds::fixed:
      if (!node.is_sequence() || node.items().size() != info.extent)
        return node.error(
            "expected a list of " + std::to_string(info.extent) + " values, found " +
                (node.is_sequence() ? "one of " + std::to_string(node.items().size()) : describe(node)),
            "", path);
      for (std::size_t i = 0; i < info.extent; ++i)
        SL_TRY(value(node.items()[i], field, *type.element, type.at(out, i), path + "/" + std::to_string(i)));
      return {};
    case Holds::list: return read_list(node, field, type, out, path);
    case Holds::fielded: return fields(node, type, out, path, field.unit);
    case Holds::time:
    case Holds::other: break;  // no spec has them: type_edit refuses to compile
  }
  return wrong_type(node, "nothing", path);
}

Status fields(const Node& node, const TypeEdit& type, void* spec, const std::string& path,
              std::string_view unit) {
  const char* const list_key = type.info->list_key;
  if (list_key && node.is_sequence()) {
    struct List final : FieldEditor {
      const Node& node;
      std::string_view key, unit;
      const std::string& path;
      Status status;

      List(const Node& n, std::string_view k, std::string_view u, const std::string& p)
          : node(n), key(k), unit(u), path(p) {}
      void field(const Field& f, const TypeEdit& member_type, void* member) override {
        if (f.key != key) return;
        const std::string own_unit = unit_within(f.unit, unit);
        Field here = f;
        here.unit = own_unit.c_str();
        status = value(node, here, member_type, member, path);
      }
    } list(node, list_key, unit, path);
    type.visit(spec, list);
    if (!list.status) return std::move(list.status);
    return check_rules(node, *type.info, spec, path);
  }
  if (!node.is_map() && !node.is_null()) return wrong_type(node, "a map of keys", path);
  struct Map final : FieldEditor {
    const Node& node;
    std::string_view unit;
    const std::string& path;
    std::vector<std::string> known;
    Status status;

    Map(const Node& n, std::string_view u, const std::string& p) : node(n), unit(u), path(p) {}
    void field(const Field& inner, const TypeEdit& member_type, void* member) override {
      known.emplace_back(inner.key);
      if (!status) return;
      const std::string own_unit = unit_within(inner.unit, unit);
      Field f = inner;
      f.unit = own_unit.c_str();
      if (const Node* const given = node.find(f.key))
        status = value(*given, f, member_type, member, path + "/" + f.key);
      else if (f.flags & Field::required)
        status = node.error(std::string("key '") + f.key + "' is missing", f.help, path);
    }
  } map(node, unit, path);
  type.visit(spec, map);
  // An unknown key is reported before a bad value: a slip in the name is the likelier cause of both.
  for (const Node::Entry& entry : node.entries()) {
    if (std::ranges::find(map.known, entry.key) != map.known.end()) continue;
    Error error = unknown_key(entry, map.known, path);
    if (list_key)
      error.fix += (error.fix.ends_with('?') ? std::string(" ") : "; ") + list_key +
                   " are written as a list: [{name: {...}}, ...]";
    return error;
  }
  if (!map.status) return std::move(map.status);
  return check_rules(node, *type.info, spec, path);
}

namespace {

/// The part `rest` of one member: of a struct, an optional one, or an element of a list of them.
Status set_part(const TypeEdit& type, void* member, const Field& f, std::string_view rest, const Node& given,
                const std::string& path) {
  const TypeInfo& info = *type.info;
  if (info.holds == Holds::fielded) return tunable(type, member, rest, given, path, f.unit);
  const bool of_structs = info.element && info.element->holds == Holds::fielded;
  if (of_structs && info.holds == Holds::option) {
    if (info.size(member)) return tunable(*type.element, type.at(member, 0), rest, given, path, f.unit);
    return Error{"there is no '" + std::string(f.key) + "' here", "", given.place(), path};
  }
  if (of_structs && info.holds == Holds::list) {
    const std::size_t slash = rest.find('/'), size = info.size(member);
    double index = 0;
    if (!parse_number(rest.substr(0, slash), index) || !(index >= 0) || index != std::floor(index) ||
        index >= static_cast<double>(size))
      return Error{"no element '" + std::string(rest.substr(0, slash).substr(0, 60)) + "'",
                   "there are " + std::to_string(size) + ", counted from 0", given.place(), path};
    if (slash == std::string_view::npos)
      return Error{"an element of a list is fixed; its parts may be tunable", "", given.place(), path};
    return tunable(*type.element, type.at(member, static_cast<std::size_t>(index)), rest.substr(slash + 1),
                   given, path + "/" + std::string(rest.substr(0, slash)), f.unit);
  }
  return Error{"'" + std::string(f.key) + "' has no parts", "", given.place(), path};
}

}  // namespace

Status tunable(const TypeEdit& type, void* spec, std::string_view field_path, const Node& given,
               const std::string& prefix, std::string_view unit) {
  if (type.info->list_key && !field_path.empty() && field_path.front() >= '0' && field_path.front() <= '9')
    return tunable(type, spec, std::string(type.info->list_key) + "/" + std::string(field_path), given,
                   prefix, unit);
  const std::size_t slash = field_path.find('/');
  struct One final : FieldEditor {
    std::string_view key, rest;
    bool whole;
    const Node& given;
    const std::string& prefix;
    std::string_view unit;
    std::vector<std::string> known;
    bool found = false;
    Status status;

    One(std::string_view k, std::string_view r, bool w, const Node& g, const std::string& p,
        std::string_view u)
        : key(k), rest(r), whole(w), given(g), prefix(p), unit(u) {}
    void field(const Field& inner, const TypeEdit& member_type, void* member) override {
      known.emplace_back(inner.key);
      if (found || key != inner.key) return;
      found = true;
      const std::string own_unit = unit_within(inner.unit, unit);
      Field f = inner;
      f.unit = own_unit.c_str();
      const std::string path = prefix + "/" + f.key;
      if (!whole) {
        status = set_part(member_type, member, f, rest, given, path);
      } else if (!(f.flags & Field::tunable)) {
        status = Error{"'" + std::string(f.key) + "' is fixed once the run has started", "", given.place(),
                       path};
      } else {
        status = value(given, f, member_type, member, path);
      }
    }
  } one(field_path.substr(0, slash),
        slash == std::string_view::npos ? std::string_view() : field_path.substr(slash + 1),
        slash == std::string_view::npos, given, prefix, unit);
  type.visit(spec, one);
  if (!one.found)
    return Error{"no parameter '" + std::string(one.key.substr(0, 60)) + "'", suggestion(one.key, one.known),
                 given.place(), prefix};
  if (!one.status) return std::move(one.status);
  return check_rules(given, *type.info, spec, prefix);
}

}  // namespace read_detail
}  // namespace sandlot
