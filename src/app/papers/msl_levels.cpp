#include "app/papers/msl_levels.h"

#include <fmt/format.h>

#include <array>

namespace sandlot::app {
namespace {

constexpr std::array<const char*, 3> senses{"image", "objects", "world"};
constexpr std::array<const char*, 3> drives{"roller", "contact", "ideal"};
/// The kick-off is prepared before it: robots stand.
constexpr double begin_s = 14, end_s = 34;

using LevelSettings = std::vector<std::pair<std::string, std::string>>;

/// Simulated time over the time that its ticks take, while the ball is in play.
Result<double> speed_of(const ReproduceContext& context, const std::string& name, LevelSettings settings) {
  SL_ASSIGN(const std::vector<StepTime> steps,
            context.step_times({name, "match", std::move(settings)}, end_s, std::nullopt));
  double sim_s = 0, compute_s = 0;
  for (const StepTime& step : steps) {
    if (step.now.s() < begin_s) continue;
    sim_s += step.step.s();
    compute_s += step.compute_s;
  }
  if (!(compute_s > 0)) return Error{"'" + name + "' ended before the game began"};
  return sim_s / compute_s;
}

/// A match whose teams have levels of their own.
struct Mixed {
  const char *name, *cyan, *magenta;
  LevelSettings settings;
};

std::vector<Mixed> mixed() {
  return {{"mixed_ends",
           "image, rollers",
           "world, ideal",
           {{"drive", "roller"},
            {"cyan_sense", "image"},
            {"magenta_sense", "world"},
            {"magenta_drive", "ideal"}}},
          {"mixed_senses", "image, contact", "objects, contact", {{"cyan_sense", "image"}}},
          {"mixed_drives",
           "objects, rollers",
           "objects, contact",
           {{"drive", "roller"}, {"magenta_drive", "contact"}}}};
}

}  // namespace

Status add_level_table(const ReproduceContext& context, ReportPage& page) {
  std::string csv = "cyan_sense,cyan_drive,magenta_sense,magenta_drive,speed\n";
  double slowest = 0;
  std::vector<std::vector<std::string>> speeds, gains;
  for (const char* const sense : senses) {
    std::vector<std::string>&row = speeds.emplace_back(), &gain = gains.emplace_back();
    row.emplace_back(sense);
    gain.emplace_back(sense);
    for (const char* const drive : drives) {
      SL_ASSIGN(const double speed, speed_of(context, fmt::format("match_{}_{}", sense, drive),
                                             {{"sense", sense}, {"drive", drive}}));
      if (slowest == 0) slowest = speed;
      row.push_back(fmt::format("{:.3g}", speed));
      gain.push_back(fmt::format("{:.3g}", speed / slowest));
      csv += fmt::format("{0},{1},{0},{1},{2:.5g}\n", sense, drive, speed);
    }
  }
  std::vector<std::vector<std::string>> pairs;
  for (const Mixed& each : mixed()) {
    SL_ASSIGN(const double speed, speed_of(context, std::string("match_") + each.name, each.settings));
    pairs.push_back(
        {each.cyan, each.magenta, fmt::format("{:.3g}", speed), fmt::format("{:.3g}", speed / slowest)});
    csv += fmt::format("\"{}\",,\"{}\",,{:.5g}\n", each.cyan, each.magenta, speed);
  }
  SL_TRY(context.write("levels.csv", csv));
  page.paragraph(
      fmt::format("Simulated time over the time that its ticks take, on one core, of the same match of ten "
                  "robots with all their sensors and the same "
                  "programs: scenarios/match.yaml with one seed, from {:g} s to {:g} s. Steps of 4 ms, "
                  "with rollers of 2 ms. "
                  "Rows: what eyes and lasers give; columns: the wheels.",
                  begin_s, end_s));
  std::vector<std::string> head{"senses"};
  head.insert(head.end(), drives.begin(), drives.end());
  page.table(head, speeds);
  page.paragraph("As a multiple of the speed with pictures and rollers:");
  page.table(head, gains);
  page.paragraph("Mixed teams in one match:");
  page.table({"cyan", "magenta", "speed", "multiple"}, pairs);
  return {};
}

}  // namespace sandlot::app
