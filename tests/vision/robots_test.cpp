/// Software of robots on what the simulator gives them: colours in pictures, OpenCV on the same pictures, the
/// laser, whole programs.
#include <opencv2/imgproc.hpp>

#include "app/verbs/calibrate.h"
#include "base/random.h"
#include "devices/cameras/camera_lens.h"
#include "perception/finder.h"
#include "perception/scan_match.h"
#include "sim/load/load.h"
#include "sim/world/simulation.h"
#include "studio.h"

namespace sandlot::test {
namespace {

constexpr double one_degree = math::pi / 180;

/// A ball, goals and two robots on a lit field with shadows; all that stands is 0.5 m from its front to its
/// middle or as given.
struct SoccerField : Studio {
  Vec3 ball{1.8, 0.5, 0.11}, magenta{2.6, -0.7, 0}, cyan{-1.5, 1.2, 0}, blue{4.5, 0.2, 0}, yellow{-4.5, 0, 0};
  SoccerField() {
    surroundings = {{0.72f, 0.78f, 0.85f, 1}, {0.45f, 0.45f, 0.45f, 1}};
    optics::PictureLight sun;
    sun.light.X_PLight.q = quat_from_rpy(0.4, 0.35, 0);
    sun.light.color = {0.6f, 0.6f, 0.58f, 1};
    sun.light.cast_shadows = true;
    lights.push_back(sun);
    add(Plane{{0, 0, 1}}, {}, {0.24f, 0.42f, 0.22f, 1});
    add(Box{{8, 0.12, 0.001}}, {{0, -1.5, 0}, {}}, {0.95f, 0.95f, 0.95f, 1});  // a line
    add(Sphere{0.11}, {ball, {}}, {0.95f, 0.42f, 0.05f, 1});
    add(Cylinder{0.2, 0.5}, {magenta + Vec3{0, 0, 0.25}, {}}, {0.85f, 0.1f, 0.65f, 1});
    add(Cylinder{0.2, 0.5}, {cyan + Vec3{0, 0, 0.25}, {}}, {0.05f, 0.7f, 0.75f, 1});
    add(Box{{0.4, 2, 1}}, {blue + Vec3{0, 0, 0.5}, {}}, {0.08f, 0.2f, 0.85f, 1});
    add(Box{{0.4, 2, 1}}, {yellow + Vec3{0, 0, 0.5}, {}}, {0.9f, 0.85f, 0.05f, 1});
    ready();
  }
  static perception::FinderSpec spec() {
    using perception::Form, perception::range_around;
    perception::FinderSpec out;
    out.targets = {{"ball", range_around(0.95, 0.42, 0.05)},
                   {"magenta", range_around(0.85, 0.1, 0.65), Form::standing, 0.4, 0, 0.2},
                   {"cyan", range_around(0.05, 0.7, 0.75), Form::standing, 0.4, 0, 0.2},
                   {"blue", range_around(0.08, 0.2, 0.85), Form::standing, 2, 0, 0.2},
                   {"yellow", range_around(0.9, 0.85, 0.05), Form::standing, 2, 0, 0.2}};
    out.min_pixels = 12;
    return out;
  }
};

perception::ImageView view_of(const cv::Mat& rgb) {
  return {rgb.cols, rgb.rows, rgb.step, false, {rgb.data, rgb.step * static_cast<std::size_t>(rgb.rows)}};
}
void add_noise(cv::Mat& rgb, std::uint64_t seed) {
  cv::RNG random(seed);
  cv::Mat noise(rgb.size(), CV_16SC3), wide;
  random.fill(noise, cv::RNG::NORMAL, 0, 8);
  rgb.convertTo(wide, CV_16S);
  cv::Mat(wide + noise).convertTo(rgb, CV_8U);
  for (int i = 0; i < rgb.rows * rgb.cols / 100; ++i)  // one pixel in a hundred is anything
    rgb.at<cv::Vec3b>(random.uniform(0, rgb.rows), random.uniform(0, rgb.cols)) = cv::Vec3b(
        static_cast<uchar>(random.next()), static_cast<uchar>(random.next()),
        static_cast<uchar>(random.next()));
}

struct Wanted {
  const char* label;
  Vec3 at;
  double bearing_rad, range_m;
};
void expect_found(const std::vector<perception::Found>& found, const perception::FinderSpec& spec,
                  const std::vector<Wanted>& wanted) {
  EXPECT_EQ(found.size(), wanted.size());
  for (const Wanted& w : wanted) {
    int times = 0;
    for (const auto& f : found) {
      if (spec.targets[f.target].label != w.label) continue;
      ++times;
      EXPECT_NEAR(f.bearing_rad, math::atan2(w.at.y, w.at.x), w.bearing_rad) << w.label;
      EXPECT_NEAR(f.range_m, math::hypot(w.at.x, w.at.y), w.range_m) << w.label;
    }
    EXPECT_EQ(times, 1) << w.label;
  }
}

TEST(Vision, ColoursAreFoundInADirectedPicture) {
  SoccerField field;
  const optics::Lens lens = *optics::pinhole_of_fov(400, 300, 80 * one_degree);
  const Pose X_BS{{0.05, 0, 0.45}, quat_from_rpy(0, 10 * one_degree, 0)};
  msg::CameraInfo info;
  cameras::fill_info(info, lens, "eye");
  perception::Finder finder(SoccerField::spec(), *perception::CameraModel::of(info), X_BS);
  Studio::Shot shot = field.shoot(lens, X_BS, 2);
  std::vector<perception::Found> found;
  // A pixel is 4 mrad. The ground at 1.8 m is seen at 10 degrees: 4 mrad are 4 cm along it, and the ball's
  // middle is known to some tenths of that. Feet are known to half a pixel: at 2.4 m 3 cm, at 4.3 m 10 cm; of
  // the arc of a round one 4 cm more.
  const std::vector<Wanted> wanted{{"ball", field.ball, 0.01, 0.04},
                                   {"magenta", field.magenta, 0.01, 0.1},
                                   {"blue", field.blue, 0.03, 0.25}};
  ASSERT_TRUE(finder.find(view_of(shot.rgb), found));
  expect_found(found, SoccerField::spec(), wanted);
  add_noise(shot.rgb, 5);
  ASSERT_TRUE(finder.find(view_of(shot.rgb), found));
  expect_found(found, SoccerField::spec(), wanted);

  // The same by what everybody writes with OpenCV: hue, a threshold, the largest outline.
  cv::Mat hsv, mask;
  cv::cvtColor(shot.rgb, hsv, cv::COLOR_RGB2HSV);
  cv::inRange(hsv, cv::Scalar(5, 120, 40), cv::Scalar(20, 255, 255), mask);
  cv::morphologyEx(mask, mask, cv::MORPH_OPEN, cv::Mat::ones(2, 2, CV_8U));
  std::vector<std::vector<cv::Point>> outlines;
  cv::findContours(mask, outlines, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
  ASSERT_FALSE(outlines.empty());
  const auto largest = *std::max_element(outlines.begin(), outlines.end(), [](const auto& a, const auto& b) {
    return cv::contourArea(a) < cv::contourArea(b);
  });
  cv::Point2f middle;
  float radius = 0;
  cv::minEnclosingCircle(largest, middle, radius);
  const Vec3 ball_S = inverse(X_BS) * field.ball;
  const auto at = *optics::project(lens, ball_S);
  EXPECT_NEAR(middle.x, at[0], 1.5);
  EXPECT_NEAR(middle.y, at[1], 1.5);
  EXPECT_NEAR(radius, optics::intrinsics(lens)[0] * 0.11 / norm(ball_S), 1.5);
}

TEST(SlowVision, ColoursAreFoundAllAround) {
  SoccerField field;
  const double a = std::sqrt(233.3) * 5e-3, b = std::sqrt(1135.7) * 5e-3;
  const Pose X_BS{{0, 0, 0.7}, {}};
  const optics::Lens lens = *optics::omni_that_fills(480, 480, {.a_m = a, .b_m = b, .rim_m = 0.05});
  msg::CameraInfo info;
  cameras::fill_info(info, lens, "omni");
  Studio::Shot shot = field.shoot(lens, X_BS, 2);
  add_noise(shot.rgb, 6);
  // A pixel is half a degree: at 1.9 m the ground is seen at 17 degrees, half a pixel is 3 cm of it; at 2.7 m
  // 6 cm; at 4.3 m 14 cm.
  const std::vector<Wanted> wanted{{"ball", field.ball, 0.02, 0.06},
                                   {"magenta", field.magenta, 0.02, 0.15},
                                   {"cyan", field.cyan, 0.02, 0.12},
                                   {"blue", field.blue, 0.05, 0.4},
                                   {"yellow", field.yellow, 0.05, 0.4}};
  perception::Finder finder(SoccerField::spec(), *perception::CameraModel::of(info), X_BS);
  std::vector<perception::Found> found;
  ASSERT_TRUE(finder.find(view_of(shot.rgb), found));
  expect_found(found, SoccerField::spec(), wanted);

  // The same with a mirror of which nothing is known: measured by balls laid out on the ground, whose pixels
  // are counted.
  std::vector<perception::Sighting> laid;
  Studio plain;
  plain.surroundings = {{0, 0, 0, 1}, {1, 1, 1, 1}};
  for (int ring = 0; ring < 14; ++ring)
    plain.add(Sphere{0.02 + 0.006 * ring}, {}, {1, 1, 1, 1}, static_cast<std::uint32_t>(ring));
  plain.frame.X_WG.assign(14, {});
  plain.ready();
  for (int turn = 0; turn < 2; ++turn) {
    std::vector<Vec3> at;
    for (int ring = 0; ring < 14; ++ring) {
      const double range = 0.25 * std::pow(1.28, ring), angle = 2.4 * ring + turn;
      at.push_back({range * math::cos(angle), range * math::sin(angle), 0.02 + 0.006 * ring});
      plain.frame.X_WG[static_cast<std::size_t>(ring)].p = at.back();
    }
    plain.scene.update(plain.frame);
    cv::Mat labels, sizes, middles;
    const int n = cv::connectedComponentsWithStats(plain.shoot(lens, X_BS, 1).gray > 128, labels, sizes,
                                                   middles);
    for (int i = 1; i < n; ++i) {
      // Whose patch it is, is what one who lays them out knows.
      const cv::Point2d p(middles.at<double>(i, 0), middles.at<double>(i, 1));
      for (const Vec3 ball : at) {
        const auto true_place = *optics::project(lens, inverse(X_BS) * ball);
        if (math::hypot(true_place[0] - p.x, true_place[1] - p.y) < 1.5)
          laid.push_back({p.x, p.y, inverse(X_BS) * ball});
      }
    }
  }
  ASSERT_GE(laid.size(), 20u);
  const auto fitted = perception::CameraModel::fit_polynomial(480, 480, 239.5, 239.5, laid);
  ASSERT_TRUE(fitted);
  perception::Finder by_measure(SoccerField::spec(), *fitted, X_BS);
  ASSERT_TRUE(by_measure.find(view_of(shot.rgb), found));
  expect_found(found, SoccerField::spec(),
               {{"ball", field.ball, 0.02, 0.1},
                {"magenta", field.magenta, 0.02, 0.2},
                {"cyan", field.cyan, 0.02, 0.2},
                {"blue", field.blue, 0.05, 0.6},
                {"yellow", field.yellow, 0.05, 0.6}});
}

std::unique_ptr<Simulation> simulation(const std::string& file, std::vector<formats::Override> overrides,
                                       std::optional<std::string_view> text = {}) {
  Diagnostics diagnostics;
  LoadOptions options;
  options.overrides = overrides;
  options.text = text;
  auto setup = load(file, options, diagnostics);
  EXPECT_TRUE(setup) << (setup ? "" : setup.error().text());
  if (!setup) return nullptr;
  auto sim = Simulation::create(std::move(*setup), {}, diagnostics);
  EXPECT_TRUE(sim) << (sim ? "" : sim.error().text());
  return sim ? std::move(*sim) : nullptr;
}
Pose place(const Simulation& sim, const char* name) {
  return sim.engine().states()[sim.engine().bodies(*sim.find_instance(name))[0].index].X_WB;
}

struct Eyes {
  const char* name;
  std::vector<formats::Override> set;
  bool pictures;
};
void PrintTo(const Eyes& eyes, std::ostream* out) { *out << eyes.name; }
class SlowVisionSeeks : public testing::TestWithParam<Eyes> {};
INSTANTIATE_TEST_SUITE_P(
    Levels, SlowVisionSeeks,
    testing::Values(Eyes{"picture", {}, true}, Eyes{"objects", {{"level", "objects"}}, false},
                    Eyes{"mirror", {{"eye", "omni"}, {"level", "objects"}, {"omni_level", "image"}}, true}));

/// The ball lies 2.8 m off, outside the view of the directed camera. The same program gets there with
/// whatever it sees by.
TEST_P(SlowVisionSeeks, AndFindsTheBall) {
  auto set = GetParam().set;
  for (const char* small : {"robots[0].devices.eye.width=160", "robots[0].devices.eye.height=120",
                            "robots[0].devices.eye.samples=1", "robots[0].devices.omni.width=240",
                            "robots[0].devices.omni.height=240", "robots[0].devices.omni.samples=1"}) {
    const std::string_view text(small);
    set.push_back(
        {std::string(text.substr(0, text.find('='))), std::string(text.substr(text.find('=') + 1))});
  }
  const auto sim = simulation("scenarios/ball.yaml", set);
  ASSERT_TRUE(sim);
  const Pose before = place(*sim, "ball");
  double gone = 0, least = 1e9;
  for (int i = 0; i < 1300; ++i) {
    const Status status = sim->tick();
    ASSERT_TRUE(static_cast<bool>(status));
    const Vec3 to = place(*sim, "ball").p - place(*sim, "seeker").p;
    gone = math::hypot(to.x, to.y);
    least = std::min(least, gone);
    if (gone < 0.5 && i > 300) break;
  }
  // It stops 0.45 m from the ball's middle and never touches it. Its eyes err by some centimetres there.
  EXPECT_LT(gone, 0.5);
  EXPECT_GT(least, 0.35);
  EXPECT_LT(norm(place(*sim, "ball").p - before.p), 0.02);
  const TopicBase* const image = sim->find_topic(std::string("/seeker/") +
                                                 (GetParam().set.size() > 1 ? "omni" : "eye") + "/image");
  ASSERT_TRUE(image);
  EXPECT_EQ(image->count > 0, GetParam().pictures);  // at level objects none was drawn
}

TEST(SlowVision, ALaserLocalisesWhileItAvoidsWalls) {
  const auto sim = simulation("tests/room.yaml", {}, R"(
version: 1
name: room
world: ../examples/embed/room.sdf
physics: planar
time: {step: 20 ms, substeps: 1, control_interval: 5}
seed: 3
robots:
  - name: rover
    model: ../models/rover/model.sdf
    pose: [-1.5, -0.5, 0.3]
    controller: {kind: wander, radius: 0.18}
)");
  ASSERT_TRUE(sim);
  using perception::Wall;
  std::vector<Wall> walls{{-3, -2, 3, -2}, {3, -2, 3, 2}, {3, 2, -3, 2}, {-3, 2, -3, -2}};
  for (int i = 0; i < 16; ++i) {
    const double a = math::pi / 8 * i, b = a + math::pi / 8;
    walls.push_back(
        {1 + 0.2 * math::cos(a), 0.5 + 0.2 * math::sin(a), 1 + 0.2 * math::cos(b), 0.5 + 0.2 * math::sin(b)});
  }
  const auto* scan = topic_cast<msg::LaserScan>(sim->find_topic("rover/laser"));
  ASSERT_TRUE(scan);
  const Pose X_BL{{0, 0, 0.25}, {}};
  perception::Pose2 guess{-1.5, -0.5, 0.3};
  std::uint64_t count = 0;
  double worst = 0, worst_turn = 0, driven = 0, nearest = 1e9;
  Vec3 last = place(*sim, "rover").p;
  int matched = 0;
  for (int i = 0; i < 3000; ++i) {
    ASSERT_TRUE(static_cast<bool>(sim->tick()));
    const Pose truth = place(*sim, "rover");
    driven += norm(truth.p - last);
    last = truth.p;
    nearest = std::min({nearest, 3 - std::abs(truth.p.x), 2 - std::abs(truth.p.y),
                        math::hypot(truth.p.x - 1, truth.p.y - 0.5) - 0.2});
    if (scan->count == count) continue;
    count = scan->count;
    // No odometry: from where it was a tenth of a second ago.
    const perception::ScanMatch match = perception::match_scan(scan->message, X_BL, walls, guess);
    ASSERT_TRUE(match.converged) << sim->now().s();
    guess = match.pose;
    ++matched;
    worst = std::max(worst, math::hypot(guess.x - truth.p.x, guess.y - truth.p.y));
    worst_turn = std::max(worst_turn, std::abs(math::wrap_angle(guess.theta - yaw_of(truth.q))));
  }
  EXPECT_GT(driven, 10);
  EXPECT_GT(matched, 500);
  // 271 beams with 1 cm of noise: a third of them on each pair of walls, 1 cm / sqrt(90), five of them and as
  // much for the pillar's corners; and the robot moves up to 1 cm between the scan and the end of a tick.
  EXPECT_LT(worst, 0.02);
  EXPECT_LT(worst_turn, 0.01);
  EXPECT_GT(nearest, 0.175);  // its radius: it touched nothing
}

app::CalibrateOptions calibration(int samples) {
  app::CalibrateOptions options;
  options.file = "scenarios/ball.yaml";
  options.camera = "seeker/eye";
  options.samples = samples;
  options.labels = {"ball"};
  options.overrides = {{"robots[0].devices.eye.width", "160"},
                       {"robots[0].devices.eye.height", "120"},
                       {"robots[0].devices.eye.samples", "1"}};
  return options;
}

TEST(SlowVision, CalibrationGivesKnownErrorsBack) {
  app::CalibrateOptions options = calibration(700);
  options.detector = "objects";
  options.overrides = {{"objects",
                        "{labels: [ball], miss_rate: 0.05, miss_rate_per_m: 0.03, ghost_rate: 1, "
                        "bearing_std: 0.02, range_std: 0.03, range_std_per_m: 0.02}"},
                       {"robots[0].devices.eye.width", "16"},
                       {"robots[0].devices.eye.height", "12"},
                       {"robots[0].devices.eye.samples", "1"}};
  Diagnostics diagnostics;
  const auto c = app::calibrate_camera(options, diagnostics);
  ASSERT_TRUE(c) << c.error().text();
  EXPECT_EQ(c->pictures, 700);
  ASSERT_GT(c->sighted, 450);  // some are behind posts or cut by the edge
  const app::DetectorFit& fit = c->fit;
  const double n = c->sighted, middle = 0.5 * (fit.nearest_m + fit.farthest_m), p = 0.05 + 0.03 * middle;
  // As in DetectorFit, ranges spread by (farthest - nearest) / sqrt(12); four deviations.
  const double spread = (fit.farthest_m - fit.nearest_m) / std::sqrt(12.0), rate = std::sqrt(p * (1 - p) / n);
  EXPECT_NEAR(fit.miss_rate + middle * fit.miss_rate_per_m, p, 4 * rate);
  EXPECT_NEAR(fit.miss_rate_per_m, 0.03, 4 * rate / spread);
  // 80 ms per picture, 56 s in all; a ghost near the ball is taken for it, few are.
  EXPECT_NEAR(c->seconds, 56, 1);
  EXPECT_NEAR(fit.ghost_rate_hz, 1, 4 / std::sqrt(56.0) + 0.05);
  EXPECT_NEAR(fit.bearing_std_rad, 0.02, 0.02 * 4 * 0.71 / std::sqrt(n));
  const double sigma = 0.03 + 0.02 * middle;
  EXPECT_NEAR(fit.range_std_m + middle * fit.range_std_per_m, sigma, 4 * sigma * 0.76 / std::sqrt(n));
  EXPECT_NEAR(fit.range_std_per_m, 0.02, 4 * sigma * 0.76 / std::sqrt(n) / spread);
}

TEST(SlowVision, CalibrationMeasuresTheReferenceDetector) {
  Diagnostics diagnostics;
  const auto c = app::calibrate_camera(calibration(120), diagnostics);
  ASSERT_TRUE(c) << c.error().text();
  ASSERT_GT(c->sighted, 80);
  EXPECT_GT(c->found, 0.85 * c->sighted);
  EXPECT_LT(c->ghosts, 5);
  EXPECT_LT(c->fit.bearing_std_rad, 0.02);
  // A pixel is 10 mrad; at 4 m the ground is seen at 3.6 degrees, where a tenth of a pixel is 6 cm.
  EXPECT_LT(c->fit.range_std_m + 4 * c->fit.range_std_per_m, 0.5);
  const std::string yaml = app::calibration_yaml(calibration(120), *c);
  EXPECT_NE(yaml.find("seeker_eye_objects:\n    miss_rate: "), std::string::npos) << yaml;

  app::CalibrateOptions wrong = calibration(1);
  wrong.camera = "seeker/ear";
  const auto none = app::calibrate_camera(wrong, diagnostics);
  ASSERT_FALSE(none);
  EXPECT_NE(none.error().fix.find("seeker/eye"), std::string::npos) << none.error().text();
  wrong = calibration(1);
  wrong.labels = {"elephant"};
  EXPECT_FALSE(app::calibrate_camera(wrong, diagnostics));
}

}  // namespace
}  // namespace sandlot::test
