/// Sections 4 and 5 of the paper: distance sensors and cameras with errors, as programs see them; figure 5.
#include <fmt/format.h>

#include <cmath>
#include <map>
#include <numbers>

#include "app/papers/eyesim.h"
#include "app/papers/pictures.h"
#include "base/math.h"
#include "draw/plan.h"
#include "draw/plot.h"
#include "messages/messages.h"
#include "sim/world/simulation.h"
#include "statistics/intervals.h"

namespace sandlot::app::eyesim {
namespace {

// --- distance sensors ---

constexpr std::array<const char*, 3> psd_robots{"Bare", "Bare_2", "Bare_3"};
constexpr std::array<double, 3> distances_mm{150, 500, 1500};
constexpr double psd_std_mm = 10, rounding_variance = 1.0 / 12;  ///< readings are whole millimetres

/// Readings of each robot as counts by millimetre.
using Counts = std::array<std::map<int, std::uint64_t>, 3>;

Result<Counts> readings(const Report& report, double errors, int repeat) {
  SL_ASSIGN(
      const std::vector<ProgramRun> all,
      report.runs.repeated({.file = "eyesim_paper/psd.sim",
                            .duration_s = 60,
                            .stop_when = "Bare/controller.ended > 0 and Bare_2/controller.ended > 0 and "
                                         "Bare_3/controller.ended > 0",
                            .errors = errors},
                           repeat));
  Counts out;
  for (const ProgramRun& run : all)
    for (std::size_t robot = 0; robot < 3; ++robot) {
      const auto bins = run.numbers(psd_robots[robot], "bin");
      if (bins.empty()) return missing_line("psd.sim", "bin");
      for (const auto& bin : bins) out[robot][static_cast<int>(bin[0])] += static_cast<std::uint64_t>(bin[1]);
    }
  return out;
}

statistics::Sample sample_of(const std::map<int, std::uint64_t>& counts) {
  statistics::Sample out;
  for (const auto& [mm, count] : counts)
    for (std::uint64_t i = 0; i < count; ++i) out.add(mm);
  return out;
}

/// Shares of the readings by their error, and the normal density.
Result<std::string> histogram(const std::map<int, std::uint64_t>& counts, double truth_mm) {
  draw::Table table;
  table.names = {"error", "readings", "normal law"};
  table.units = {"mm", "", ""};
  table.columns.resize(3);
  const double total = static_cast<double>(sample_of(counts).count());
  for (int mm = -40; mm <= 40; ++mm) {
    const auto found = counts.find(static_cast<int>(truth_mm) + mm);
    table.columns[0].push_back(mm);
    table.columns[1].push_back(found == counts.end() ? 0 : 100 * static_cast<double>(found->second) / total);
    table.columns[2].push_back(100 / (psd_std_mm * std::sqrt(2 * std::numbers::pi)) *
                               math::exp(-0.5 * mm * mm / (psd_std_mm * psd_std_mm)));
  }
  return draw::draw_plot({table}, {.x = "error",
                                   .title = "Readings at 500 mm, sigma 10 mm",
                                   .x_label = "error [mm]",
                                   .y_label = "share of the readings [%]"});
}

Status distance_sensors(const Report& report, std::vector<Check>& all) {
  report.page.heading("Section 5: errors of distance sensors (PSD)");
  SL_ASSIGN(const Counts exact, readings(report, 0, 1));
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < 3; ++i)
    rows.push_back({fmt::format("{:g} mm", distances_mm[i]),
                    fmt::format("{} to {} mm", exact[i].begin()->first, exact[i].rbegin()->first)});
  report.page.paragraph(
      "Three robots stand in front of a wall; a program takes 1000 readings by PSDGet, one in each time "
      "slot. "
      "Without errors (a ray against the shapes of the world, section 4.1):");
  report.page.table({"true distance", "readings"}, rows);
  report.page.paragraph(fmt::format(
      "With `error psd 10`, and with twice that error, over {} runs. Readings are whole millimetres, which "
      "adds 1/12 mm^2 to the variance: the deviation is sqrt(sigma^2 + 1/12).",
      report.context.repeat));
  std::vector<Check> checks;
  Counts shown;
  for (const double factor : {1.0, 2.0}) {
    SL_ASSIGN(const Counts counts, readings(report, factor, report.context.repeat));
    if (factor == 1) shown = counts;
    for (std::size_t i = 0; i < 3; ++i) {
      const statistics::Sample sample = sample_of(counts[i]);
      const double sigma = factor * psd_std_mm;
      const std::string name = fmt::format("{:g} mm, sigma {:g} mm: ", distances_mm[i], sigma);
      checks.push_back(mean_check(name + "mean", "mm", distances_mm[i], sample));
      checks.push_back(
          deviation_check(name + "deviation", "mm", std::sqrt(sigma * sigma + rounding_variance), sample));
    }
  }
  check_table(report.page, checks);
  SL_ASSIGN(const std::string figure, histogram(shown[1], distances_mm[1]));
  report.page.figure(figure, "Errors of the readings, and the normal density that the model names.");
  all.insert(all.end(), checks.begin(), checks.end());
  return {};
}

// --- cameras ---

struct Pictures {
  std::vector<msg::Image> all;  ///< one after the other, as the program has shown them on its screen
  assets::Picture overview;
};

Result<Pictures> pictures(const Report& report, const std::string& file, double errors, int count,
                          bool overview = false) {
  Pictures out;
  std::uint64_t seen = 0;
  ProgramRunSpec spec{.file = "eyesim_paper/" + file, .duration_s = 1 + 1.2 * count, .errors = errors};
  if (overview) {
    spec.view.emplace();
    spec.view->from = Vec3{-0.35, 0.3, 1.5};
    spec.view->at = Vec3{1.45, 1.2, 0};
  }
  spec.watch = [&](const Simulation& simulation) {
    const auto* const topic = dynamic_cast<const Topic<msg::Image>*>(
        simulation.find_topic("/S4/screen/pixels"));
    if (!topic || topic->count == seen || static_cast<int>(out.all.size()) == count) return;
    seen = topic->count;
    const msg::Image& image = topic->message;
    // The screen is black until the first picture, and shows each of them for a second.
    const bool black = std::all_of(image.data.begin(), image.data.end(), [](auto x) { return x == 0; });
    if (!black && (out.all.empty() || out.all.back().data != image.data)) out.all.push_back(image);
  };
  SL_ASSIGN(ProgramRun run, report.runs.run(spec));
  if (out.all.empty() || (errors > 0 && static_cast<int>(out.all.size()) < count))
    return missing_line(file, "looks");
  out.overview = std::move(run.picture);
  return out;
}

PictureTile tile_of(std::string title, const msg::Image& image) {
  return {std::move(title), static_cast<int>(image.width), static_cast<int>(image.height), image.data};
}

/// Differences of the channels that no error of five deviations takes beyond black or white.
Check grey_level_check(const msg::Image& original, const Pictures& noisy, double sigma) {
  statistics::Sample sample;
  for (const msg::Image& image : noisy.all)
    for (std::size_t i = 0; i < original.data.size(); ++i) {
      const int before = original.data[i];
      if (before > 5 * sigma && before < 255 - 5 * sigma) sample.add(image.data[i] - before);
    }
  return deviation_check(fmt::format("gaussian, sigma {:g} levels: deviation", sigma), "levels",
                         std::sqrt(sigma * sigma + rounding_variance), sample);
}

struct Pixels {
  std::uint64_t counted = 0, changed = 0, white = 0, black = 0;
  statistics::Sample levels;  ///< of changed pixels
};

/// Pixels that are neither black nor white without errors.
Pixels pixels_of(const msg::Image& original, const Pictures& noisy) {
  Pixels out;
  const auto all_are = [](const std::uint8_t* rgb, int x) {
    return rgb[0] == x && rgb[1] == x && rgb[2] == x;
  };
  for (const msg::Image& image : noisy.all)
    for (std::size_t i = 0; i + 2 < original.data.size(); i += 3) {
      const std::uint8_t* const before = &original.data[i];
      const std::uint8_t* const after = &image.data[i];
      if (all_are(before, 0) || all_are(before, 255)) continue;
      ++out.counted;
      if (std::equal(before, before + 3, after)) continue;
      ++out.changed;
      out.white += all_are(after, 255);
      out.black += all_are(after, 0);
      for (int c = 0; c < 3; ++c) out.levels.add(after[c]);
    }
  return out;
}

Status cameras(const Report& report, std::vector<Check>& all) {
  report.page.heading("Sections 4 and 5: the camera and its errors");
  const int count = std::min(report.context.repeat, 20);
  SL_ASSIGN(const Pictures original, pictures(report, "gaussian.sim", 0, 1, true));
  const msg::Image& exact = original.all.front();
  report.page.paragraph(
      "A program takes pictures by CAMGet and shows them on its screen by LCDImage, from which the pictures "
      "below are taken: 320 x 240 pixels, as programs have them.");
  report.page.figure(picture_svg({app::tile_of(original.overview)}, 1),
                     "The room as a person sees it: in front the robot with the camera.");
  std::vector<Check> checks;
  SL_ASSIGN(const Pictures gaussian, pictures(report, "gaussian.sim", 1, count));
  checks.push_back(grey_level_check(exact, gaussian, 10));
  std::vector<Pictures> impulses;
  for (const char* const file : {"salt_and_pepper.sim", "hundreds_and_thousands.sim"})
    for (const double factor : {1.0, 2.0}) {
      SL_ASSIGN(Pictures taken, pictures(report, file, factor, count));
      impulses.push_back(std::move(taken));
    }
  for (std::size_t i = 0; i < 4; ++i) {
    const double p = i % 2 == 0 ? 0.05 : 0.1;
    const Pixels seen = pixels_of(exact, impulses[i]);
    const std::string name = fmt::format("{}, P_e {:g}: ", i < 2 ? "salt and pepper" : "100s and 1000s", p);
    checks.push_back(rate_check(name + "changed pixels", p, seen.changed, seen.counted));
    if (i < 2) {
      checks.push_back(rate_check(name + "white", p / 2, seen.white, seen.counted));
      checks.push_back(rate_check(name + "black", p / 2, seen.black, seen.counted));
    } else {
      checks.push_back(mean_check(name + "mean level", "levels", 127.5, seen.levels));
      checks.push_back(
          deviation_check(name + "its deviation", "levels", std::sqrt((256.0 * 256 - 1) / 12), seen.levels));
    }
  }
  report.page.figure(picture_svg({tile_of("Original image", exact),
                                  tile_of("Salt & pepper noise, P_e = 0.05", impulses[0].all.front()),
                                  tile_of("100s & 1000s noise, P_e = 0.05", impulses[2].all.front()),
                                  tile_of("Normal noise, sigma = 10 levels", gaussian.all.front())},
                                 2),
                     "Figure 5 of the paper, and the additive model beside it.");
  report.page.paragraph(fmt::format(
      "Pixels of {} pictures against the one without errors. Counted are channels that five deviations keep "
      "between black and white, and of impulse noise pixels that are neither black nor white without it. "
      "Levels are whole: 1/12 more variance.",
      count));
  check_table(report.page, checks);
  report.page.table(
      {"the paper", "here"},
      {{"f(i) = s(i) + n(i), n white, normal, of zero mean, for distance sensors and vision.",
        "The same. Values beyond black and white are cut, as are distances beyond the sensor's range."},
       {"f(i) = (1 - e) s(i) + e n(i), e = 1 with the probability P_e; n is randomly the greatest grey level "
        "or "
        "0 (salt and pepper), or a random colour (hundreds and thousands).",
        "The same; black and white are equally probable, and colours uniform in each channel: mean 127.5, "
        "deviation sqrt((256^2 - 1) / 12) = 73.9."},
       {"Figure 5 is of a scene that is not described.", "A room of our own."}});
  all.insert(all.end(), checks.begin(), checks.end());
  return {};
}

/// Figure 4.
Status sensors_seen(const Report& report) {
  report.page.heading("Section 4: sensors");
  SL_ASSIGN(const ProgramRun run,
            report.runs.run({.file = "robios/distbug.sim", .duration_s = 8, .draws = true}));
  report.page.figure(run.drawing,
                     "Sensors as a person sees them: a robot that follows the walls of a trap by its laser "
                     "scanner (examples/robios/distbug.c), its way, and where its beams end.");
  report.page.table({"the paper", "here"},
                    {{"Figure 4: beams of distance sensors, graphically and as numbers; outlines of the "
                      "camera's field of view; messages by radio.",
                      "The page of a run (--port 8765) shows beams with numbers, frusta of cameras and radio "
                      "messages; drawings such as the one above "
                      "show laser scans."}});
  return {};
}

}  // namespace

Status sensor_errors(const Report& report) {
  std::vector<Check> checks;
  SL_TRY(sensors_seen(report));
  SL_TRY(distance_sensors(report, checks));
  SL_TRY(cameras(report, checks));
  return report.context.write("sensors.csv", csv_of(checks));
}

}  // namespace sandlot::app::eyesim
