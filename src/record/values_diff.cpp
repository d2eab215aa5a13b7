#include "record/values_diff.h"

#include <cmath>
#include <map>
#include <set>

#include "base/text.h"
#include "sim/watch/values.h"

namespace sandlot::record {
namespace {

struct Value {
  double value = 0;
  std::string unit;
};
/// Addresses with their values, in the order in which they are listed.
struct Listing {
  std::vector<std::string> order;
  std::map<std::string, Value> values;
};

/// "rover/laser" of "rover/laser.state.bias" and of "rover/laser/ranges.header.stamp"; "rover" of "rover.pose.x".
bool belongs_to(std::string_view address, std::string_view part) {
  if (!address.starts_with(part) || address.size() == part.size()) return false;
  const char next = address[part.size()];
  // A thing's own values; its devices are parts of their own.
  return next == '.' || (next == '/' && part.find('/') != std::string_view::npos);
}

Listing values_of(const Simulation& simulation, const std::string& part) {
  Listing out;
  const auto add = [&](const std::string& address, double value, const std::string& unit) {
    out.order.push_back(address);
    out.values[address] = {value, unit};
  };
  const std::string entity(first_part(part));
  if (entity != "sim" && !simulation.find_instance(entity) && !simulation.elements().find_part(part))
    return out;
  list_values(simulation, entity == "sim" ? "" : entity, [&](const ValueEntry& entry) {
    if (!belongs_to(entry.path, part)) return;
    if (entry.list) {
      add(entry.path + ".size", static_cast<double>(entry.count), "");
      for (std::size_t i = 0; i < entry.count; ++i) {
        const std::string address = entry.path + "[" + std::to_string(i) + "]";
        if (auto value = NamedValue::find(simulation, address))
          if (const auto number = value->read()) add(address, *number, entry.unit);
      }
    } else if (entry.is == ValueFound::Is::value) {
      add(entry.path, entry.value, entry.unit);
    }
  });
  return out;
}

/// "rover/laser.ranges" of "rover/laser.ranges[3]"; empty for an address that is not an element of a list.
std::string_view list_address(std::string_view address) {
  return address.ends_with(']') ? address.substr(0, address.rfind('[')) : std::string_view();
}

bool same(double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); }

}  // namespace

std::string ValueDifference::text() const {
  const auto side = [&](const std::optional<double>& x) {
    if (!x) return std::string("nothing");
    return number_text(*x) + (unit.empty() || unit == "1" ? "" : " " + unit);
  };
  std::string out = address + " " + side(a) + " against " + side(b);
  if (more > 0) out += " (and " + std::to_string(more) + " more of the list)";
  return out;
}

ValueDifferences differing_values(const Simulation& a, const Simulation& b,
                                  std::span<const std::string> parts, std::size_t most) {
  ValueDifferences out;
  std::string list_before;
  const auto add = [&](const std::string& address, const Value* x, const Value* y) {
    if (x && y && same(x->value, y->value)) return;
    ++out.count;
    const std::string_view list = list_address(address);
    if (!list.empty() && list == list_before) {
      if (out.entries <= most) ++out.first.back().more;
      return;
    }
    list_before = list;
    if (++out.entries > most) return;
    ValueDifference difference{address, x ? x->unit : y->unit, {}, {}};
    if (x) difference.a = x->value;
    if (y) difference.b = y->value;
    out.first.push_back(std::move(difference));
  };
  const auto find = [](const Listing& listing, const std::string& address) {
    const auto found = listing.values.find(address);
    return found == listing.values.end() ? nullptr : &found->second;
  };
  for (const std::string& part : parts) {
    const Listing in_a = values_of(a, part), in_b = values_of(b, part);
    for (const std::string& address : in_a.order) add(address, find(in_a, address), find(in_b, address));
    for (const std::string& address : in_b.order)
      if (!find(in_a, address)) add(address, nullptr, find(in_b, address));
  }
  return out;
}

std::vector<std::string> differing_setups(const Simulation& a, const Simulation& b) {
  std::vector<std::string> out;
  const model::Setup &x = a.setup(), &y = b.setup();
  const auto compare = [&](const char* what, const auto& p, const auto& q, const auto& text) {
    if (!(p == q)) out.push_back(std::string(what) + ": " + text(p) + " against " + text(q));
  };
  const auto plain = [](const std::string& text) { return text; };
  const auto seconds = [](Time t) { return number_text(t.s()) + " s"; };
  const auto number = [](auto n) { return std::to_string(n); };
  compare("scenario", x.name, y.name, plain);
  compare("physics", x.engine, y.engine, plain);
  compare("seed", x.seed, y.seed, number);
  compare("step", x.step, y.step, seconds);
  compare("substeps", x.substeps, y.substeps, number);
  compare("control interval", x.control_interval, y.control_interval, number);
  compare("clock", x.clock.mode, y.clock.mode, [](model::Clock::Mode mode) {
    return std::string(mode == model::Clock::Mode::continuous ? "continuous" : "fixed");
  });
  std::set<std::string> names_a, names_b;
  for (const model::Instance* instance : a.instances()) names_a.insert(instance->name);
  for (const model::Instance* instance : b.instances()) names_b.insert(instance->name);
  const auto only = [&](const std::set<std::string>& here, const std::set<std::string>& there,
                        const char* who) {
    std::string list;
    std::size_t n = 0;
    for (const std::string& name : here)
      if (!there.contains(name) && ++n <= 8) list += (list.empty() ? "" : ", ") + name;
    if (n > 8) list += " and " + std::to_string(n - 8) + " more";
    if (n) out.push_back(std::string("only in the ") + who + ": " + list);
  };
  only(names_a, names_b, "first");
  only(names_b, names_a, "second");
  return out;
}

}  // namespace sandlot::record
