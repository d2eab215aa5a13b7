/// Section 2 of the paper: the matrix of each drive against the motion of a robot whose motors a program turns, and the ways of the
/// high-level driving interface.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

#include "app/papers/eyesim.h"
#include "app/papers/pictures.h"
#include "base/math.h"

namespace sandlot::app::eyesim {
namespace {

constexpr double pi = std::numbers::pi;

double mm(double m) { return 1000 * m; }
double degrees(double rad) { return rad * 180 / pi; }
/// Without "-0".
std::string fixed(double x, int digits = 2) {
  std::string out = fmt::format("{:.{}f}", x, digits);
  if (out.find_first_not_of("-0.") == std::string::npos && out.front() == '-') out.erase(0, 1);
  return out;
}

/// Of a robot that stands at the origin, for Figures 1 and 2.
draw::ViewpointOptions portrait() {
  return {.from = Vec3{0.36, 0.36, 0.26}, .at = Vec3{0, 0, 0.05}, .width = 320, .height = 240};
}

/// One line `motion NAME BEGIN END PERCENT... TICKS...` of a program, and the true motion meanwhile.
struct Motion {
  std::string name;
  double duration_s = 0;
  std::vector<double> percent, ticks;
  Twist measured;
  std::size_t first = 0, last = 0;  ///< in the run's times
};

Result<std::vector<Motion>> motions_of(const ProgramRun& run, const std::string& robot, std::size_t motors) {
  const std::vector<Pose2> poses = poses_of(run);
  std::vector<Motion> out;
  const auto numbers = run.numbers(robot, "motion");
  const auto words = run.lines(robot, "motion");
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].size() != 3 + 2 * motors) return missing_line(robot, "motion");
    Motion& motion = out.emplace_back();
    motion.name = words[i][0];
    for (char& c : motion.name)
      if (c == '_') c = ' ';
    motion.first = index_of(run, numbers[i][1] / 1000);
    motion.last = index_of(run, numbers[i][2] / 1000);
    if (motion.last <= motion.first) return missing_line(robot, "motion");
    motion.duration_s = run.times_s[motion.last] - run.times_s[motion.first];
    for (std::size_t m = 0; m < motors; ++m) {
      motion.percent.push_back(numbers[i][3 + m]);
      motion.ticks.push_back(numbers[i][3 + motors + m]);
    }
    motion.measured = twist_through(std::span(poses).subspan(motion.first, motion.last - motion.first + 1),
                                    motion.duration_s);
  }
  return out;
}

std::string csv_row(const char* drive, const std::string& name, const Twist& predicted,
                    const Twist& measured) {
  return fmt::format("{},\"{}\",{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}\n", drive, name, predicted.x_mps,
                     predicted.y_mps, predicted.turn_radps, measured.x_mps, measured.y_mps,
                     measured.turn_radps);
}

// --- two wheels ---

constexpr double bare_c = pi * 0.054 / 1100, bare_d = 0.12;  ///< of bare.robi

Status differential(const Report& report, std::string& csv, assets::Picture& picture) {
  SL_ASSIGN(ProgramRun run, report.runs.run({.file = "eyesim_paper/wheels.sim",
                                             .duration_s = 30,
                                             .stop_when = "Bare/controller.ended > 0",
                                             .values = pose_values("Bare"),
                                             .view = portrait()}));
  picture = std::move(run.picture);
  SL_ASSIGN(const std::vector<Motion> motions, motions_of(run, "Bare", 2));
  if (motions.size() < 5) return missing_line("wheels.sim", "motion");
  report.page.paragraph(fmt::format(
      "Differential drive (bare.robi: wheels of 54 mm, 1100 ticks a turn, d = 120 mm, hence c = {:.5f} mm a "
      "tick). A program "
      "turns the motors and reads the encoders; the paper's matrix makes v and the turning rate of the "
      "encoders' speeds, beside the robot's true motion over 2 s:",
      mm(bare_c)));
  std::vector<std::vector<std::string>> rows;
  double worst_mmps = 0, worst_degps = 0;
  for (const Motion& each : motions) {
    const double left = each.ticks[0] / each.duration_s, right = each.ticks[1] / each.duration_s;
    const Twist paper = paper_differential(bare_c, bare_d, left, right);
    rows.push_back({each.name, fixed(left, 1), fixed(right, 1), fixed(mm(paper.x_mps)),
                    fixed(mm(each.measured.x_mps)), fixed(degrees(paper.turn_radps)),
                    fixed(degrees(each.measured.turn_radps)), fixed(mm(each.measured.y_mps))});
    worst_mmps = std::max(worst_mmps, std::abs(mm(paper.x_mps - each.measured.x_mps)));
    worst_degps = std::max(worst_degps, std::abs(degrees(paper.turn_radps - each.measured.turn_radps)));
    csv += csv_row("differential", each.name, paper, each.measured);
  }
  report.page.table({"motion", "left [ticks/s]", "right [ticks/s]", "v, paper [mm/s]", "v, measured",
                     "turning rate, paper [deg/s]", "measured", "sideways, measured [mm/s]"},
                    rows);
  // A wheel alone gives a column of the matrix.
  const auto column = [&](std::size_t motion, std::size_t wheel) {
    const double speed = motions[motion].ticks[wheel] / motions[motion].duration_s;
    return Twist{motions[motion].measured.x_mps / speed, 0, motions[motion].measured.turn_radps / speed};
  };
  const Twist left = column(0, 0), right = column(1, 1);
  report.page.paragraph("The matrix itself, from the motions with one wheel alone:");
  report.page.table(
      {"entry", "paper", "measured"},
      {{"v by left, right [mm/tick]", fmt::format("c/2, c/2 = {0:.5f}, {0:.5f}", mm(bare_c / 2)),
        fmt::format("{:.5f}, {:.5f}", mm(left.x_mps), mm(right.x_mps))},
       {"turning rate by left, right [deg/tick]",
        fmt::format("-c/d, c/d = {:.5f}, {:.5f}", -degrees(bare_c / bare_d), degrees(bare_c / bare_d)),
        fmt::format("{:.5f}, {:.5f}", degrees(left.turn_radps), degrees(right.turn_radps))}});
  report.page.table(
      {"the paper", "here"},
      {{"[v, turning rate] = [[c/2, c/2], [-c/d, c/d]] [left, right]",
        fmt::format(
            "The same: v differs by at most {:.2g} mm/s, the turning rate by {:.2g} deg/s. What is "
            "left is the resolution of the encoders: one tick of a wheel in {:.3g} s is {:.2g} mm/s and "
            "{:.2g} deg/s.",
            worst_mmps, worst_degps, motions[0].duration_s, mm(bare_c / 2) / motions[0].duration_s,
            degrees(bare_c / bare_d) / motions[0].duration_s)}});
  return {};
}

// --- four Mecanum wheels ---

/// Omni: wheels of 80 mm, 1400 deg/s, 1000 ticks a turn, 240 mm apart both ways.
constexpr double omni_c = pi * 0.08 / 1000, omni_d = 0.24, omni_full_ticks = 1400.0 / 360 * 1000;

Status mecanum(const Report& report, std::string& csv, assets::Picture& picture) {
  SL_ASSIGN(ProgramRun run, report.runs.run({.file = "eyesim_paper/mecanum.sim",
                                             .duration_s = 40,
                                             .stop_when = "Omni/controller.ended > 0",
                                             .values = pose_values("Omni"),
                                             .view = portrait()}));
  picture = std::move(run.picture);
  SL_ASSIGN(const std::vector<Motion> motions, motions_of(run, "Omni", 4));
  if (motions.size() < 8) return missing_line("mecanum.sim", "motion");
  report.page.paragraph(fmt::format(
      "Omni-directional drive (Omni: Mecanum wheels of 80 mm, 1000 ticks a turn, 240 mm apart both from left "
      "to right and from front "
      "to back, hence c = {:.5f} mm a tick). Speeds are those ordered, since the robot has no encoders. "
      "Turning rates by the paper's third row, and by the row that four rolling wheels have, (-1, 1, -1, 1) "
      "c/4d:",
      mm(omni_c)));
  std::vector<std::vector<std::string>> rows;
  double worst_mmps = 0, worst_degps = 0;
  std::array<Twist, 4> columns{};
  for (std::size_t m = 0; m < motions.size(); ++m) {
    const Motion& each = motions[m];
    std::array<double, 4> w{};
    std::string speeds;
    for (std::size_t i = 0; i < 4; ++i) {
      w[i] = each.percent[i] / 100 * omni_full_ticks;
      speeds += (i ? ", " : "") + fixed(w[i], 0);
    }
    const Twist paper = paper_mecanum(omni_c, omni_d, w), rolling = rolling_mecanum(omni_c, omni_d, w);
    rows.push_back({each.name, speeds, fixed(mm(paper.x_mps), 1) + ", " + fixed(mm(paper.y_mps), 1),
                    fixed(mm(each.measured.x_mps), 1) + ", " + fixed(mm(each.measured.y_mps), 1),
                    fixed(degrees(paper.turn_radps)), fixed(degrees(rolling.turn_radps)),
                    fixed(degrees(each.measured.turn_radps))});
    worst_mmps = std::max({worst_mmps, std::abs(mm(rolling.x_mps - each.measured.x_mps)),
                           std::abs(mm(rolling.y_mps - each.measured.y_mps))});
    worst_degps = std::max(worst_degps, std::abs(degrees(rolling.turn_radps - each.measured.turn_radps)));
    csv += csv_row("mecanum", each.name, paper, each.measured);
    if (m < 4)
      columns[m] = {each.measured.x_mps / w[m], each.measured.y_mps / w[m], each.measured.turn_radps / w[m]};
  }
  report.page.table({"motion", "FL, FR, BL, BR [ticks/s]", "v_x, v_y, paper [mm/s]", "measured",
                     "turning rate, paper [deg/s]", "rolling wheels", "measured"},
                    rows);
  const auto row = [&](const auto& entry) {
    return fmt::format("{:.5f}, {:.5f}, {:.5f}, {:.5f}", entry(columns[0]), entry(columns[1]),
                       entry(columns[2]), entry(columns[3]));
  };
  report.page.paragraph("The matrix itself, from the motions with one wheel alone:");
  report.page.table({"row", "paper", "measured"},
                    {{"v_x [mm/tick]", fmt::format("(1, 1, 1, 1) c/4, c/4 = {:.5f}", mm(omni_c / 4)),
                      row([](const Twist& t) { return mm(t.x_mps); })},
                     {"v_y [mm/tick]", "(-1, 1, 1, -1) c/4", row([](const Twist& t) { return mm(t.y_mps); })},
                     {"turning rate [deg/tick]",
                      fmt::format("(-1, 1, 1, -1) c/4d, c/4d = {:.5f}", degrees(omni_c / 4 / omni_d)),
                      row([](const Twist& t) { return degrees(t.turn_radps); })}});
  SL_ASSIGN(const ProgramRun drawn, report.runs.run({.file = "robios/mecanum.sim",
                                                     .duration_s = 15,
                                                     .stop_when = "Omni/controller.ended > 0",
                                                     .draws = true}));
  report.page.figure(drawn.drawing,
                     "A program drives ahead, to the left, back and to the right by the four motors alone "
                     "(examples/robios/mecanum.c), without a turn, then turns on the spot.");
  report.page.table(
      {"the paper", "here"},
      {{"Rows of v_x and v_y: (1, 1, 1, 1) c/4 and (-1, 1, 1, -1) c/4.",
        fmt::format("The same, within {:.2g} mm/s.", worst_mmps)},
       {"Row of the turning rate: (-1, 1, 1, -1) c/4d, which is the second row over d.",
        fmt::format("(-1, 1, -1, 1) c/4d, within {:.2g} deg/s. By the row as printed a robot that drives "
                    "sideways would turn, and one with turning wheels on left and right would not: the signs "
                    "of the two back "
                    "wheels are taken for a misprint.",
                    worst_degps)},
       {"d is the distance between the left and the right wheels.",
        "Right for wheels on a square, as here. In general it is half of that distance and half of the one "
        "between front and back wheels, together."}});
  return {};
}

// --- a car, and ways ---

constexpr double car_wheelbase_m = 0.2;

Status ackermann(const Report& report, std::string& csv, assets::Picture& picture) {
  std::vector<std::string> values = pose_values("Ackermann");
  values.emplace_back("Ackermann.joints.front_left_steering.position");
  values.emplace_back("Ackermann.joints.front_right_steering.position");
  SL_ASSIGN(ProgramRun run, report.runs.run({.file = "eyesim_paper/car.sim",
                                             .duration_s = 40,
                                             .stop_when = "Ackermann/controller.ended > 0",
                                             .values = values,
                                             .view = portrait()}));
  picture = std::move(run.picture);
  SL_ASSIGN(const std::vector<Motion> motions, motions_of(run, "Ackermann", 0));
  if (motions.size() < 5) return missing_line("car.sim", "motion");
  report.page.paragraph(
      "Ackermann steering (Ackermann: axles 200 mm apart). Programs order v and the turning rate, from which "
      "the steering angle follows, tan(angle) = axle distance * turning rate / v, here at the middle of the "
      "front axle of the angles of both wheels:");
  std::vector<std::vector<std::string>> rows;
  for (const Motion& each : motions) {
    const double left = run.values[3][each.last], right = run.values[4][each.last];
    // Cotangents of the two angles have their mean in the middle of the axle.
    const double tangent = std::abs(left) < 1e-9 ? 0 : 2 / (1 / math::tan(left) + 1 / math::tan(right));
    const double turn = each.measured.x_mps * tangent / car_wheelbase_m;
    rows.push_back({each.name, fixed(mm(each.measured.x_mps)), fixed(degrees(left)), fixed(degrees(right)),
                    fixed(degrees(math::atan(tangent))), fixed(degrees(turn)),
                    fixed(degrees(each.measured.turn_radps))});
    csv += csv_row("ackermann", each.name, {each.measured.x_mps, 0, turn}, each.measured);
  }
  report.page.table({"motion", "v [mm/s]", "left wheel [deg]", "right wheel [deg]", "steering angle [deg]",
                     "turning rate by the angle [deg/s]", "measured"},
                    rows);
  report.page.table(
      {"the paper", "here"},
      {{"No formula is required for Ackermann steering: speed and driving angle are directly controlled.",
        "The rear axle rolls by the angle without slip. v is that of the rear axle's middle, the robot's own "
        "point."}});
  return {};
}

Status ways(const Report& report) {
  SL_ASSIGN(const ProgramRun run, report.runs.run({.file = "eyesim_paper/ways.sim",
                                                   .duration_s = 30,
                                                   .stop_when = "Bare/controller.ended > 0",
                                                   .values = pose_values("Bare"),
                                                   .draws = true}));
  struct Way {
    const char *name, *call;
    Pose2 wanted;
  };
  const double radius_m = 0.5 / (pi / 2);
  const Way wanted[] = {{"straight", "VWStraight(500, 200)", {0.5, 0, 0}},
                        {"turn", "VWTurn(90, 60)", {0, 0, pi / 2}},
                        {"curve", "VWCurve(500, 90, 200)", {radius_m, radius_m, pi / 2}},
                        {"point", "VWDrive(400, 300, 200)", {0.4, 0.3, 2 * math::atan2(0.3, 0.4)}}};
  const auto printed = run.lines("Bare", "way");
  const auto numbers = run.numbers("Bare", "way");
  const std::vector<Pose2> poses = poses_of(run);
  report.page.paragraph(
      "High-level driving: the pose after each way, as seen from its beginning, x ahead, y to the left.");
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < std::size(wanted); ++i) {
    if (i >= printed.size() || printed[i].size() != 3 || printed[i][0] != wanted[i].name)
      return missing_line("ways.sim", "way");
    const Pose2 at = relative(poses[index_of(run, numbers[i][1] / 1000)],
                              poses[index_of(run, numbers[i][2] / 1000)]);
    const auto text = [](const Pose2& p) {
      return fixed(mm(p.x_m), 1) + ", " + fixed(mm(p.y_m), 1) + ", " + fixed(degrees(p.yaw_rad), 1);
    };
    rows.push_back({wanted[i].call, text(wanted[i].wanted), text(at),
                    fixed(mm(math::hypot(at.x_m - wanted[i].wanted.x_m, at.y_m - wanted[i].wanted.y_m)), 1)});
  }
  report.page.table({"call", "ordered x, y [mm], heading [deg]", "true", "off by [mm]"}, rows);
  report.page.figure(run.drawing, "The four ways one after the other, from above.");
  report.page.table(
      {"the paper", "here"},
      {{"VWDriveStraight, VWDriveCurve, VWDriveTurn with an implicit controller for velocity "
        "and position.",
        "They end within 1 mm and 1 mrad of the goal by the robot's odometry, or within a tick of "
        "its encoders."}});
  return {};
}

}  // namespace

Status drives(const Report& report) {
  report.page.heading("Section 2: drive kinematics");
  std::array<assets::Picture, 3> pictures;
  std::string csv =
      "drive,motion,v_x predicted [m/s],v_y predicted,turning rate predicted [rad/s],v_x measured,v_y "
      "measured,turning rate measured\n";
  SL_TRY(differential(report, csv, pictures[0]));
  SL_TRY(mecanum(report, csv, pictures[1]));
  SL_TRY(ackermann(report, csv, pictures[2]));
  report.page.figure(
      picture_svg({tile_of(pictures[0], "differential"), tile_of(pictures[2], "Ackermann"),
                   tile_of(pictures[1], "omni-directional, Mecanum")},
                  3),
      "Figure 2 of the paper, and the simulated half of its Figure 1: the robots that these "
      "numbers are of, as their .robi files describe them. Rollers of Mecanum wheels are not drawn.");
  SL_TRY(ways(report));
  return report.context.write("drives.csv", csv);
}

}  // namespace sandlot::app::eyesim
