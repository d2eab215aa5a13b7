#include "model/substance.h"

#include <array>

#include "base/text.h"

namespace sandlot::model {
namespace {

/// Stands where the argument goes.
constexpr double arg = -1;

struct Preset {
  const char* name;
  Substance substance;
  double usual, low, high;     ///< of the argument
  double warn_low, warn_high;  ///< outside of these it is strange
  double most;                 ///< beyond it, it is an error
};
constexpr Preset presets[] = {
    {"metal", {arg, 0.01, 200, 0.8}, 0.5, 0.1, 1, 0, 2, 100},
    {"plastic", {arg, 0.01, 40, 0.5}, 0.8, 0.5, 2, 0, 3, 100},
    {"rubber", {3, 0, arg, 0.95}, 20, 5, 50, 5, 50, 1e6},
    {"foam", {2, 0.1, arg, 0}, 10, 1, 30, 1, 30, 1e6},
    {"snow", {arg, arg, 40, 0}, 0.5, 0, 1, 0, 1, 1},
};

Substance made(const Preset& preset, double argument) {
  Substance out = preset.substance;
  const bool snow = out.slip == arg;
  if (out.roughness == arg) out.roughness = snow ? 1 - argument : argument;
  if (out.slip == arg) out.slip = argument;
  if (out.hardness == arg) out.hardness = argument;
  return out;
}

/// What of the substance the preset's argument is.
double argument_of(const Preset& preset, const Substance& substance) {
  if (preset.substance.slip == arg) return substance.slip;
  return preset.substance.hardness == arg ? substance.hardness : substance.roughness;
}

Result<NamedSubstance> from_preset(const Preset& preset, double argument) {
  const bool hardness = preset.substance.hardness == arg;
  // A hardness of 0 would be no surface at all.
  if (!(argument >= 0 && argument <= preset.most) || (hardness && !(argument > 0)))
    return Error{std::string("no ") + preset.name + "(" + number_text(argument) + "): its argument is " +
                     (hardness                       ? "a hardness above 0"
                      : preset.substance.slip == arg ? "a slip from 0 to 1"
                                                     : "a roughness from 0 to " + number_text(preset.most)),
                 "usual is " + number_text(preset.low) + " to " + number_text(preset.high)};
  NamedSubstance out{made(preset, argument), ""};
  if (argument < preset.warn_low || argument > preset.warn_high)
    out.warning = std::string(preset.name) + "(" + number_text(argument) + ") is outside the usual " +
                  number_text(preset.low) + " to " + number_text(preset.high);
  return out;
}

Result<NamedSubstance> from_numbers(std::string_view text) {
  std::array<double, 4> n{};
  std::size_t count = 0;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t begin = text.find_first_not_of(" \t\n\r,[]", at);
    if (begin == std::string_view::npos) break;
    at = std::min(text.find_first_of(" \t\n\r,[]", begin), text.size());
    double x = 0;
    if (count == n.size() || !parse_number(text.substr(begin, at - begin), x))
      return Error{"'" + std::string(text.substr(0, 60)) + "' is not a substance",
                   "for example metal(0.5), plastic, rubber(20), foam(10), snow(0.5), or four numbers: "
                   "roughness, slip, hardness, elasticity"};
    n[count++] = x;
  }
  const Substance s{n[0], n[1], n[2], n[3]};
  const auto within = [](double x, double low, double high) { return x >= low && x <= high; };
  if (count != n.size() || !within(s.roughness, 0, 100) || !within(s.slip, 0, 100) ||
      !within(s.hardness, 1e-6, 1e6) || !within(s.elasticity, 0, 1))
    return Error{"'" + std::string(text.substr(0, 60)) + "' is not a substance",
                 "four numbers are roughness 0..100, slip 0..100, hardness above 0, elasticity 0..1"};
  return NamedSubstance{s, ""};
}

}  // namespace

Result<NamedSubstance> substance_from(std::string_view text) {
  const std::size_t open = text.find('(');
  const std::string_view name = text.substr(0, open);
  for (const Preset& preset : presets) {
    if (name != preset.name) continue;
    if (open == std::string_view::npos) return from_preset(preset, preset.usual);
    double argument = 0;
    if (text.back() != ')' || !parse_number(text.substr(open + 1, text.size() - open - 2), argument))
      return Error{"'" + std::string(text.substr(0, 60)) + "' is not a substance",
                   std::string("write ") + preset.name + "(" + number_text(preset.usual) + ")"};
    return from_preset(preset, argument);
  }
  return from_numbers(text);
}

std::string text_of(const Substance& s) {
  for (const Preset& preset : presets) {
    const double argument = argument_of(preset, s);
    if (argument >= 0 && argument <= preset.most && made(preset, argument) == s)
      return std::string(preset.name) + "(" + number_text(argument) + ")";
  }
  return number_text(s.roughness) + " " + number_text(s.slip) + " " + number_text(s.hardness) + " " +
         number_text(s.elasticity);
}

}  // namespace sandlot::model
