#include "base/units.h"

#include <cctype>
#include <numbers>

#include "base/text.h"

namespace sandlot {
namespace {

struct Unit {
  std::string_view name;
  std::string_view si;  ///< the SI unit it measures, as fields spell it
  double factor;
};

constexpr double deg = std::numbers::pi / 180;
// clang-format off
constexpr Unit units[] = {
    {"m", "m", 1},          {"mm", "m", 1e-3},        {"cm", "m", 1e-2},       {"km", "m", 1e3},
    {"um", "m", 1e-6},      {"in", "m", 0.0254},      {"ft", "m", 0.3048},     {"rad", "rad", 1},
    {"mrad", "rad", 1e-3},  {"deg", "rad", deg},      {"s", "s", 1},           {"ms", "s", 1e-3},
    {"us", "s", 1e-6},      {"ns", "s", 1e-9},        {"min", "s", 60},        {"h", "s", 3600},
    {"kg", "kg", 1},        {"g", "kg", 1e-3},        {"t", "kg", 1e3},        {"Hz", "Hz", 1},
    {"kHz", "Hz", 1e3},     {"m/s", "m/s", 1},        {"cm/s", "m/s", 1e-2},   {"mm/s", "m/s", 1e-3},
    {"km/h", "m/s", 1 / 3.6}, {"rad/s", "rad/s", 1},  {"deg/s", "rad/s", deg}, {"rpm", "rad/s", std::numbers::pi / 30},
    {"m/s^2", "m/s^2", 1},  {"g0", "m/s^2", 9.80665}, {"rad/s^2", "rad/s^2", 1}, {"deg/s^2", "rad/s^2", deg},
    {"N", "N", 1},          {"kN", "N", 1e3},         {"Nm", "Nm", 1},         {"mNm", "Nm", 1e-3},
    {"W", "W", 1},          {"J", "J", 1},            {"kJ", "J", 1e3},        {"Wh", "J", 3600},
    {"V", "V", 1},          {"mV", "V", 1e-3},        {"A", "A", 1},           {"mA", "A", 1e-3},
    {"ohm", "ohm", 1},      {"mohm", "ohm", 1e-3},    {"%", "1", 1e-2},        {"1", "1", 1},
    {"C", "C", 1},          {"Ah", "C", 3600},        {"mAh", "C", 3.6},       {"mW", "W", 1e-3},
    {"kW", "W", 1e3},       {"mJ", "J", 1e-3},        {"uJ", "J", 1e-6},        {"nJ", "J", 1e-9},
    {"Ns", "Ns", 1},
    {"B", "B", 1},          {"kB", "B", 1e3},         {"MB", "B", 1e6},        {"GB", "B", 1e9},
    {"KiB", "B", 1024},     {"MiB", "B", 1048576},    {"GiB", "B", 1073741824},
    {"bit/s", "bit/s", 1},  {"kbit/s", "bit/s", 1e3}, {"Mbit/s", "bit/s", 1e6},
};
// clang-format on

}  // namespace

Result<double> parse_quantity(std::string_view text, std::string_view unit) {
  text = trim(text);
  // The longest prefix that is a number, then the unit. "1e3" is a number, "1 e" is not.
  std::size_t split = 0;
  double number = 0;
  for (std::size_t n = text.size(); n > 0; --n) {
    const char last = text[n - 1];
    if (!std::isdigit(static_cast<unsigned char>(last)) && last != '.' &&
        !std::isalpha(static_cast<unsigned char>(last)))
      continue;
    if (parse_number(text.substr(0, n), number)) {
      // "1e400" must not be taken for "1e40" with the unit "0".
      if (n < text.size() && std::isdigit(static_cast<unsigned char>(text[n]))) break;
      split = n;
      break;
    }
    if (n > 64) n = 65;  // nobody writes longer numbers; keeps rubbish linear
  }
  if (split == 0)
    return Error{
        "'" + std::string(text.substr(0, 40)) + "' is not a number",
        unit == "1" ? "write a number" : "write a number, in " + std::string(unit) + " or with its unit"};
  std::string_view suffix = trim(text.substr(split));
  if (suffix.empty() || suffix == unit) return number;
  // Densities and rates: "0.03 deg/s/sqrt(Hz)" where rad/s/sqrt(Hz) is wanted.
  for (const std::string_view per : {"/sqrt(Hz)", "/sqrt(s)"}) {
    const auto ends = [&](std::string_view s) {
      return s.size() > per.size() && s.substr(s.size() - per.size()) == per;
    };
    if (!ends(unit) || !ends(suffix)) continue;
    unit.remove_suffix(per.size());
    suffix.remove_suffix(per.size());
    if (suffix == unit) return number;
  }
  std::string fitting;
  for (const Unit& u : units) {
    if (u.si != unit) continue;
    if (u.name == suffix) return number * u.factor;
    fitting += (fitting.empty() ? "" : ", ") + std::string(u.name);
  }
  return Error{"unit '" + std::string(suffix.substr(0, 40)) + "' does not fit",
               fitting.empty() ? "write the bare number" : "units that fit: " + fitting};
}

}  // namespace sandlot
