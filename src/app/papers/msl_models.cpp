#include "app/papers/msl_models.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "app/papers/eyesim.h"
#include "app/papers/pictures.h"
#include "base/math.h"
#include "controllers/soccer_player/keys.h"
#include "draw/plot.h"
#include "messages/messages.h"
#include "sim/world/simulation.h"
#include "statistics/intervals.h"

namespace sandlot::app {
namespace {

constexpr double degrees = 180 / std::numbers::pi;

const std::vector<double>* column_of(const draw::Table& table, const std::string& name) {
  for (std::size_t i = 0; i < table.names.size(); ++i)
    if (table.names[i] == name) return &table.columns[i];
  return nullptr;
}

Result<double> last_of(const draw::Table& table, const std::string& name) {
  const std::vector<double>* const column = column_of(table, name);
  if (!column || column->empty()) return Error{"the run has not logged '" + name + "'"};
  return column->back();
}

// --- Fig. 1, section 4: the robot put together from modules, and its scanner ---

constexpr double scanner_std_mm = 25, scanner_step_mm = 3.90625,
                 scanner_nearest_mm = 500;  ///< preset sick_ld
constexpr std::array<int, 8> beams{0, 60, 120, 240, 480, 600, 660, 700};

Status figure_1(const ReproduceContext& context, ReportPage& page) {
  constexpr double duration_s = 4;
  double scans = 0, steps = 0;
  LoggedRunSpec driving{
      .condition = {"fig1_robot", "fig1_robot", {}}, .values = {"bot1.pose.x"}, .duration_s = duration_s};
  driving.view = draw::ViewpointOptions{
      .from = Vec3{2.6, 5.3, 0.85}, .at = Vec3{1.6, 4.65, 0.25}, .width = 640, .height = 400};
  driving.at_end = [&](const Simulation& simulation) -> Status {
    const TopicBase* const topic = simulation.find_topic("bot1/laser1");
    const auto* const programs = simulation.programs_of("bot1");
    if (!topic || !programs || programs->empty()) return Error{"fig1_robot has no scanner or no program"};
    // The first of each is at the beginning: one more than there are intervals.
    scans = static_cast<double>(topic->count - 1) / duration_s;
    steps = static_cast<double>(programs->front()->steps - 1) / duration_s;
    return {};
  };
  SL_ASSIGN(const LoggedRun run, context.logged(driving));
  page.heading("Figure 1: a robot of three modules");
  page.figure(
      picture_svg({tile_of(run.picture)}, 1),
      "A chassis, a SICK LD and a pan-tilt head with the ids, places and rates of the paper's Figure 1 "
      "(scenarios/fig1_robot.yaml).");

  std::vector<std::string> values;
  for (const int beam : beams) values.push_back(fmt::format("bot1/laser1.ranges[{}]", beam));
  SL_ASSIGN(const LoggedRun standing,
            context.logged({.condition = {"laser", "fig1_robot", {{"robots[0].controllers", "[]"}}},
                            .values = values,
                            .rate_hz = 20,
                            .duration_s = 8}));
  // Each beam about its own mean: the constant part of its error and its distance drop out. The first half second, in which the robot
  // comes to stand, is left out, and so are beams that errors take below the nearest distance.
  statistics::Sample errors;
  std::size_t counted = 0;
  for (const std::string& name : values) {
    const std::vector<double>* const column = column_of(standing.values, name);
    if (!column || column->size() < 20) return Error{"fig1_robot has not logged '" + name + "'"};
    statistics::Sample own;
    for (std::size_t i = 10; i < column->size(); ++i)
      if (std::isfinite((*column)[i])) own.add(1000 * (*column)[i]);
    if (own.count() + 10 < column->size() || own.mean() < scanner_nearest_mm + 5 * scanner_std_mm) continue;
    ++counted;
    // The mean takes a degree of freedom of n: n / (n - 1) of the square is given back.
    const double n = static_cast<double>(own.count());
    for (std::size_t i = 10; i < column->size(); ++i)
      errors.add((1000 * (*column)[i] - own.mean()) * std::sqrt(n / (n - 1)));
  }
  if (counted == 0) return Error{"no beam of the standing robot's scanner can be used"};
  page.table(
      {"of the paper's listing", "there", "here"},
      {{"chassis RCBot, updateRate", "25 Hz", fmt::format("{:.3g} control steps a second", steps)},
       {"laser1, SickLD, scanRate", "20 Hz", fmt::format("{:.3g} scans a second", scans)},
       {"front1, SonyD100, place", "(0.1, 0, 0.325) m", "the same; pan, tilt and zoom are its module's"}});
  page.paragraph(
      "Errors of the scanner of the standing robot (section 4: \"Gaussian noise is added to the exact "
      "distances such that the variance of the real device is met\"; the variance is not printed, ours is "
      "that of the preset sick_ld, to which steps of 3.9 mm add 1/12 of their square):");
  eyesim::check_table(
      page,
      {eyesim::deviation_check(
          fmt::format("deviation of {} beams", counted), "mm",
          std::sqrt(scanner_std_mm * scanner_std_mm + scanner_step_mm * scanner_step_mm / 12), errors)});
  return {};
}

// --- Fig. 2: models, pictures of cameras ---

/// A camera's last picture, and what the vision of our players finds in it.
struct Seen {
  assets::Picture picture;
  std::vector<perception::Found> found;
};

Result<Seen> look(const Simulation& simulation, const std::string& robot, const std::string& device) {
  const auto* const image = topic_cast<msg::Image>(
      simulation.find_topic("/" + robot + "/" + device + "/image"));
  const auto* const info = topic_cast<msg::CameraInfo>(
      simulation.find_topic("/" + robot + "/" + device + "/camera_info"));
  const auto* const entity = simulation.find_entity(robot);
  if (!image || !info || !entity || image->count == 0) return Error{robot + " has no picture of " + device};
  std::optional<Pose> X_BS;
  const model::Model& model = *entity->instance.model;
  for (const auto& each : entity->devices)
    if (each->decl.name == device)
      X_BS = inverse(model.links.front().X_ML) * model.links[each->decl.link].X_ML * each->decl.X_LS;
  if (!X_BS) return Error{robot + " has no device " + device};
  Seen out;
  SL_ASSIGN(out.picture, assets::visible(image->message));
  SL_ASSIGN(const perception::CameraModel camera, perception::CameraModel::of(info->message));
  perception::Finder finder(controllers::soccer_player::usual_vision(), camera, *X_BS);
  SL_ASSIGN(const perception::ImageView view, perception::image_view(image->message));
  SL_TRY(finder.find(view, out.found));
  return out;
}

constexpr const char* observer = "cyan4";

Status figure_2(const ReproduceContext& context, ReportPage& page) {
  // The field, with two robots on other chassis than the rest.
  LoggedRunSpec models{
      .condition =
          {"models",
           "msl_field",
           {{"level", "world"},
            {"robots[3].model", "{builder: msl_robot, number: 4, color: cyan, chassis: differential}"},
            {"robots[3].pose", "[-1.9, 0.9, 0]"},
            {"robots[9].model", "{builder: msl_robot, number: 4, color: magenta, chassis: differential}"},
            {"robots[9].pose", "[-0.7, 1.6, 200 deg]"}}},
      .values = {"ball.pose.x"},
      .duration_s = 0.02};
  models.view = draw::ViewpointOptions{
      .from = Vec3{-1.8, -1.3, 1.3}, .at = Vec3{-1.2, 1.4, 0.3}, .width = 480, .height = 320};
  SL_ASSIGN(const LoggedRun differential, context.logged(models));
  models.condition.settings = {
      {"level", "world"},
      {"robots[3].model", "{builder: msl_robot, number: 4, color: cyan, rollers: 12}"},
      {"robots[3].pose", "[-1.2, 0.6, 20 deg]"}};
  models.view->from = Vec3{-0.55, -0.55, 0.75};
  models.view->at = Vec3{-1.2, 0.6, 0.35};
  SL_ASSIGN(const LoggedRun omni, context.logged(models));
  page.heading("Figure 2: models and cameras");
  page.figure(
      picture_svg({tile_of(differential.picture, "differential drive"),
                   tile_of(omni.picture, "omni-directional drive, wheels of rollers")},
                  2),
      "Figure 2 (a): robots on a field of the league. At the level rollers each roller is a body on a joint "
      "of its own, as in the paper.");

  std::vector<std::string> names{"ball"}, values;
  for (const char* const team : {"cyan", "magenta"})
    for (int i = 1; i <= 6; ++i) names.push_back(fmt::format("{}{}", team, i));
  for (const std::string& name : names)
    for (const char* const axis : {"x", "y", "yaw"}) values.push_back(name + ".pose." + axis);
  const std::array<const char*, 2> devices{"head_eye", "omni"};
  std::array<Seen, 2> seen;
  SL_ASSIGN(const LoggedRun run, context.logged({.condition = {"cameras", "msl_field", {}},
                                                 .values = values,
                                                 .duration_s = 0.1,
                                                 .at_end = [&](const Simulation& simulation) -> Status {
                                                   for (std::size_t i = 0; i < 2; ++i) {
                                                     SL_ASSIGN(seen[i],
                                                               look(simulation, observer, devices[i]));
                                                   }
                                                   return {};
                                                 }}));
  const std::string own = observer;
  SL_ASSIGN(const double x, last_of(run.values, own + ".pose.x"));
  SL_ASSIGN(const double y, last_of(run.values, own + ".pose.y"));
  SL_ASSIGN(const double yaw, last_of(run.values, own + ".pose.yaw"));
  std::vector<PictureTile> tiles;
  std::vector<std::vector<std::string>> rows;
  const auto targets = controllers::soccer_player::usual_vision().targets;
  statistics::Sample ranges, bearings;  ///< errors [%], [deg]
  int false_ones = 0;
  std::string csv = "camera,found,nearest,bearing [deg],true bearing [deg],range [m],true range [m]\n";
  for (std::size_t i = 0; i < 2; ++i) {
    PictureTile tile = tile_of(seen[i].picture, i == 0 ? "directed camera" : "omni-directional camera");
    tile.scale = 1.5;
    for (const perception::Found& found : seen[i].found) {
      const bool ball = targets[found.target].label == "ball";
      // What it is in truth: the nearest of its kind to where it was seen.
      std::string nearest = "nothing";
      double least = 1e9, true_bearing = 0, true_range = 0;
      for (const std::string& name : names) {
        if ((name == "ball") != ball || name == own) continue;
        SL_ASSIGN(const double other_x, last_of(run.values, name + ".pose.x"));
        SL_ASSIGN(const double other_y, last_of(run.values, name + ".pose.y"));
        const double bearing = math::wrap_angle(math::atan2(other_y - y, other_x - x) - yaw);
        const double range = math::hypot(other_x - x, other_y - y);
        const double apart = math::hypot(range * math::cos(bearing) - found.position_B.x,
                                         range * math::sin(bearing) - found.position_B.y);
        if (apart < least) nearest = name, least = apart, true_bearing = bearing, true_range = range;
      }
      // Farther off than a fifth of the way it is none of them.
      const bool is_true = least < 0.2 * true_range;
      if (!is_true) nearest = "nothing";
      if (is_true) ranges.add(100 * std::abs(found.range_m - true_range) / true_range);
      if (is_true) bearings.add(degrees * std::abs(math::wrap_angle(found.bearing_rad - true_bearing)));
      false_ones += !is_true;
      tile.marks.push_back({static_cast<double>(found.patch.left), static_cast<double>(found.patch.top),
                            static_cast<double>(found.patch.right), static_cast<double>(found.patch.bottom),
                            is_true && ball ? fmt::format("{:.1f} m", found.range_m) : "",
                            !is_true ? "#ff3030"
                            : ball   ? "#ffff00"
                                     : "#ffffff"});
      rows.push_back({tile.title, ball ? "ball" : "robot", nearest,
                      fmt::format("{:.1f} deg", degrees * found.bearing_rad),
                      is_true ? fmt::format("{:.1f} deg", degrees * true_bearing) : "-",
                      fmt::format("{:.2f} m", found.range_m),
                      is_true ? fmt::format("{:.2f} m", true_range) : "-"});
      csv += fmt::format("{},{},{},{:.3f},{:.3f},{:.4f},{:.4f}\n", devices[i], ball ? "ball" : "robot",
                         nearest, degrees * found.bearing_rad, degrees * true_bearing, found.range_m,
                         true_range);
    }
    tiles.push_back(std::move(tile));
  }
  page.figure(picture_svg(tiles, 2),
              "Figure 2 (b): pictures of one robot's cameras, processed by the vision of our soccer players "
              "(src/perception), which knows no simulator. Yellow: the ball; white: robots; red: found, but "
              "not there.");
  page.paragraph(
      "What vision finds in both, and what is there in truth: the nearest of its kind, or nothing within a "
      "fifth of its "
      "distance.");
  page.table({"camera", "found", "nearest", "bearing", "true", "range", "true"}, rows);
  SL_TRY(context.write("vision.csv", csv));
  page.table(
      {"the paper", "here"},
      {{"Omni-cameras by cube mapping onto the mesh of a hyperbolic mirror.",
        "Each pixel's ray is reflected by the mirror's equation: no faces of a cube, no seams."},
       {"Focal depth and shadow mapping make pictures more realistic.",
        "Shadows in both pictures; depth of field by the camera keys aperture and focus_distance, off here "
        "(docs/cameras.md)."},
       {"The vision software ran without any changes and yielded satisfactory results (no numbers).",
        fmt::format("Vision gets the messages that a real camera's driver sends. Of what it finds above {} "
                    "are there, {} "
                    "are not; bearings err by {:.2g} deg on average, ranges by {:.2g} %.",
                    ranges.count(), false_ones, bearings.mean(), ranges.mean())}});
  return {};
}

// --- Fig. 3: acceleration ---

Status figure_3(const ReproduceContext& context, ReportPage& page) {
  struct Gains {
    const char *robot, *text, *colour;
  };
  constexpr std::array<Gains, 4> gains{{{"gains_p", "p 0.4", "blue"},
                                        {"gains_p_high", "p 2", "green"},
                                        {"gains_pi", "p 0.4, i 4", "orange"},
                                        {"gains_pi_high", "p 2, i 12", "purple"}}};
  std::vector<std::string> values{"gains_p/left_motor.target"};
  draw::PlotOptions options{.x_label = "time [s]",
                            .y_label = "speed of a wheel [rad/s]",
                            .labels = {"target"},
                            .colours = {"red"},
                            .x_range = {{0.5, 7.5}}};
  for (const Gains& each : gains) {
    values.push_back(std::string(each.robot) + ".joints.left_wheel_joint.velocity");
    options.labels.emplace_back(each.text);
    options.colours.emplace_back(each.colour);
  }
  SL_ASSIGN(LoggedRun run, context.logged({.condition = {"motor_ramp", "motor_ramp", {}}, .values = values}));
  const std::vector<double>* const target = column_of(run.values, values[0]);
  if (!target) return Error{"motor_ramp has not logged the target"};
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < gains.size(); ++i) {
    const std::vector<double>* const speed = column_of(run.values, values[i + 1]);
    if (!speed) return Error{"motor_ramp has not logged " + values[i + 1]};
    const RampResponse response = ramp_response(*target, *speed);
    rows.push_back({gains[i].text, fmt::format("{:.2f}", response.behind),
                    fmt::format("{:.2f}", response.overshoot), fmt::format("{:.2f}", response.short_of)});
  }
  SL_TRY(context.write("ramp.csv", run.csv));
  SL_ASSIGN(const std::string figure, draw::draw_plot({run.values}, options));
  SL_TRY(context.write("figure_3.svg", figure));
  page.heading("Figure 3: a linear increase of the target speed");
  page.figure(figure, "Figure 3, right: the simulated robot for several sets of gains. Red: the target.");
  page.table({"gains [V per rad/s, V per rad]", "behind on the ramp [rad/s]", "overshoot [rad/s]",
              "short of the target after 1 s at the top [rad/s]"},
             rows);
  page.table({"the paper", "here"}, {{"Left: speeds of the real robot in several runs. The gains of its "
                                      "controller were unknown, so several "
                                      "sets were tried in simulation; no numbers.",
                                      "We have no real robot, so the left half is not shown. What was done "
                                      "there by hand, finding gains that "
                                      "meet a recording, is `sandlot fit` (docs/fitting.md)."}});
  return {};
}

}  // namespace

RampResponse ramp_response(std::span<const double> target, std::span<const double> speed) {
  const double low = target.front(), top = *std::max_element(target.begin(), target.end());
  const auto first_top = static_cast<std::size_t>(std::find(target.begin(), target.end(), top) -
                                                  target.begin());
  std::size_t end = first_top;
  while (end < target.size() && target[end] == top) ++end;
  RampResponse out;
  double sum = 0, count = 0, most = top;
  for (std::size_t i = 0; i < first_top; ++i)
    if (target[i] >= (low + top) / 2) sum += target[i] - speed[i], ++count;
  for (std::size_t i = first_top; i < end; ++i) most = std::max(most, speed[i]);
  out.behind = count > 0 ? sum / count : 0;
  out.overshoot = most - top;
  out.short_of = top - speed[end - 1];
  return out;
}

Status add_models(const ReproduceContext& context, ReportPage& page) {
  SL_TRY(figure_1(context, page));
  SL_TRY(figure_2(context, page));
  return figure_3(context, page);
}

}  // namespace sandlot::app
