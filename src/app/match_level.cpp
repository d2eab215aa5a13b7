#include "app/match_level.h"

#include <algorithm>
#include <chrono>
#include <optional>
#include <string_view>

#include "run/prepare.h"

namespace sandlot::app {
namespace {

/// Simulated per wall time. Robots take their places for the kick-off meanwhile: senses, players and drives work, the ball lies still.
Result<double> measure(const RunSpec& spec, double margin) {
  constexpr double warm_up_s = 0.2;                 // simulated: the first pictures make the scene
  constexpr double longest_s = 0.5, enough_s = 20;  // wall time; simulated
  Diagnostics diagnostics;
  SL_ASSIGN(PreparedRun run, prepare(spec, {}, diagnostics));
  Simulation& match = *run.simulation;
  using Clock = std::chrono::steady_clock;
  const auto since = [](Clock::time_point begin) {
    return std::chrono::duration<double>(Clock::now() - begin).count();
  };
  const Clock::time_point first = Clock::now();
  while (match.now().s() < warm_up_s) {
    SL_TRY(match.tick());
    // Hopeless: it need not be known how hopeless.
    if (since(first) > 5 * warm_up_s / margin) return match.now().s() / since(first);
  }
  const double begin_s = match.now().s();
  const Clock::time_point begin = Clock::now();
  while (since(begin) < longest_s && match.now().s() - begin_s < enough_s && !match.stop_reason())
    SL_TRY(match.tick());
  return (match.now().s() - begin_s) / since(begin);
}

}  // namespace

std::vector<formats::Override> MatchLevel::overrides() const {
  return {{"sense", sense}, {"drive", drive}, {"engine", engine}};
}

std::vector<MatchLevel> candidate_levels(const std::vector<formats::Override>& fixed) {
  std::vector<MatchLevel> out;
  for (MatchLevel level :
       {MatchLevel{"image", "roller", "rigid"}, MatchLevel{"image", "contact", "rigid"},
        MatchLevel{"objects", "roller", "rigid"}, MatchLevel{"objects", "contact", "rigid"},
        MatchLevel{"objects", "ideal", "rigid"}, MatchLevel{"world", "ideal", "planar"}}) {
    for (const formats::Override& each : fixed) {
      std::string_view name = each.path;
      if (name.starts_with("vars.")) name.remove_prefix(5);
      if (name == "sense") level.sense = each.value;
      else if (name == "drive") level.drive = each.value;
      else if (name == "engine") level.engine = each.value;
    }
    if (std::find(out.begin(), out.end(), level) == out.end()) out.push_back(std::move(level));
  }
  return out;
}

Result<MeasuredLevel> choose_level(const RunSpec& spec, double margin) {
  std::optional<MeasuredLevel> chosen;
  Error refused;
  for (const MatchLevel& level : candidate_levels(spec.overrides)) {
    RunSpec one{.file = spec.file, .overrides = level.overrides(), .paths = spec.paths};
    one.overrides.insert(one.overrides.end(), spec.overrides.begin(), spec.overrides.end());
    one.seed = spec.seed;
    one.threads = spec.threads;
    one.may_be_endless = true;
    const Result<double> factor = measure(one, margin);
    if (!factor) {
      refused = factor.error();
      continue;
    }
    chosen = MeasuredLevel{level, *factor};
    if (*factor >= margin) break;
  }
  if (!chosen) return refused;
  return *chosen;
}

}  // namespace sandlot::app
