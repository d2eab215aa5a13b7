#include "app/verbs/calibrate.h"
#include "app/interrupt.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "assets/image/write.h"
#include "base/atomic_file.h"
#include "base/json_text.h"
#include "base/math.h"
#include "base/text.h"
#include "perception/finder.h"
#include "record/playback.h"
#include "sim/load/load.h"
#include "sim/visuals/render_scene.h"

namespace sandlot::app {
namespace {

/// Detections farther off in bearing than that, beyond the edge of the thing, are of something else: of a
/// goal that is half out of the picture a detector tells the middle of the other half.
constexpr double gate_rad = 0.2;
constexpr int most_pictures = 12;

struct Seen {
  std::string label, name;
  double bearing_rad = 0, elevation_rad = 0, range_m = 0, visible = 1;
  double radius_m = 0;  ///< of the truth: half of its size over the ground
};

/// A world with the camera in it.
class Stand {
 public:
  static Result<std::unique_ptr<Stand>> make(const CalibrateOptions& options, bool exact,
                                             Diagnostics& diagnostics);
  Status turn_level(std::vector<std::string> levels);
  Status next_sample(Time not_before);
  template <class M>
  const Topic<M>* topic(const char* part) const {
    return topic_cast<M>(sim_->find_topic("/" + camera_ + "/" + part));
  }
  Simulation& sim() { return *sim_; }
  const model::DeviceDecl& decl() const { return *decl_; }
  const model::Instance& robot() const { return *robot_; }
  double min_visible() const { return min_visible_; }
  const std::vector<std::string>& labels() const { return labels_; }  ///< that the level looks for; none: all
  std::vector<Seen> objects() const;

 private:
  Status set(const char* field, const char* value);
  Status tick();

  std::unique_ptr<Simulation> sim_;
  std::string camera_;
  const model::DeviceDecl* decl_ = nullptr;
  const model::Instance* robot_ = nullptr;
  double min_visible_ = 0.15;
  std::vector<std::string> labels_;
};

Status Stand::tick() {
  SL_TRY(sim_->tick());
  for (const Outcome& outcome : sim_->outcomes())
    if (!outcome.status) return outcome.status;
  return {};
}

Status Stand::set(const char* field, const char* value) {
  sim_->submit(ParameterRequest{camera_, field, Node::scalar(value)});
  return {};
}

Result<std::unique_ptr<Stand>> Stand::make(const CalibrateOptions& options, bool exact,
                                           Diagnostics& diagnostics) {
  LoadOptions how;
  how.overrides = options.overrides;
  how.paths = options.paths;
  how.seed = options.seed;
  SL_ASSIGN(model::Setup setup, record::load_with_playbacks(options.file, how, diagnostics));
  setup.stop.reset();
  auto stand = std::make_unique<Stand>();
  stand->camera_ = options.camera;
  SL_ASSIGN(stand->sim_,
            Simulation::create(std::move(setup), {.run_programs = options.as_it_runs, .paths = options.paths},
                               diagnostics));

  std::vector<std::string> cameras;
  for (const auto& entity : stand->sim_->entities())
    for (const auto& device : entity->devices) {
      const std::string_view kind = stand->sim_->kind(*device).name;
      if (kind != "camera" && kind != "omni_camera") continue;
      cameras.push_back(device->path);
      if (device->path != options.camera) continue;
      stand->decl_ = &device->decl;
      stand->robot_ = &entity->instance;
    }
  if (!stand->decl_)
    return Error{"there is no camera '" + options.camera.substr(0, 100) + "' in " + options.file,
                 cameras.empty() ? "calibrate needs a device of the kind camera or omni_camera"
                                 : suggestion(options.camera, cameras)};
  SL_TRY(stand->turn_level(exact ? std::vector<std::string>{"image", "objects"}
                                 : std::vector<std::string>{"objects"}));
  if (exact)
    for (const char* field : {"miss_rate", "miss_rate_per_m", "miss_rate_hidden", "ghost_rate", "confusion",
                              "bearing_std", "range_std", "range_std_per_m"})
      SL_TRY(stand->set((std::string("objects/") + field).c_str(), "0"));
  const Node* const objects = stand->decl_->config.find("objects");
  if (const Node* const labels = objects ? objects->find("labels") : nullptr)
    for (const Node& label : labels->items()) stand->labels_.push_back(label.text());
  if (exact) {
    const Node* least = objects ? objects->find("min_visible") : nullptr;
    if (double given = 0; least && parse_number(least->text(), given)) stand->min_visible_ = given;
    SL_TRY(stand->set("objects/min_visible", "0.02"));
    SL_TRY(stand->set("objects/names", "true"));
  }
  SL_TRY(stand->tick());
  return stand;
}

Status Stand::turn_level(std::vector<std::string> levels) {
  sim_->submit(LevelRequest{camera_, std::move(levels)});
  return {};
}

Status Stand::next_sample(Time not_before) {
  const auto* objects = topic<msg::ObjectArray>("objects");
  SL_CHECK(objects != nullptr);
  const std::uint64_t count = objects->count;
  for (std::uint64_t ticks = 0; objects->count == count || objects->stamp < not_before; ++ticks) {
    SL_TRY(tick());
    if (sim_->stop_reason()) return Error{"the run ended: " + *sim_->stop_reason()};
    if (ticks > 1'000'000) return Error{"the camera takes no pictures"};
  }
  return {};
}

std::vector<Seen> Stand::objects() const {
  std::vector<Seen> out;
  const std::vector<LabelledObject>& things = sim_->render_scene().labelled_objects;
  for (const msg::Object& object : topic<msg::ObjectArray>("objects")->message.objects) {
    out.push_back(
        {object.label, object.name, object.bearing, object.elevation, object.range, object.visible});
    for (const LabelledObject& thing : things)
      if (!object.name.empty() && thing.name == object.name)
        out.back().radius_m = 0.5 * math::hypot(thing.bounds_B.size().x, thing.bounds_B.size().y);
  }
  return out;
}

/// Objects of one label and colour, as their models declare them.
struct Wanted {
  perception::Target target;
  double height_m = 0;
};

std::vector<Wanted> wanted_of(Simulation& sim, const Stand& stand, const CalibrateOptions& options,
                              Diagnostics& diagnostics) {
  std::vector<Wanted> out;
  std::vector<std::string> grey;
  for (const LabelledObject& thing : sim.render_scene().labelled_objects) {
    if (thing.name == stand.robot().name) continue;
    if (!options.labels.empty() &&
        std::find(options.labels.begin(), options.labels.end(), thing.label) == options.labels.end())
      continue;
    const auto red = static_cast<double>(thing.color.r), green = static_cast<double>(thing.color.g),
               blue = static_cast<double>(thing.color.b);
    if (options.detector == "picture" && !perception::has_hue(perception::hsv_of(red, green, blue))) {
      if (std::find(grey.begin(), grey.end(), thing.label) == grey.end()) grey.push_back(thing.label);
      continue;
    }
    const Vec3 size = thing.bounds_B.size();
    const double most = std::max({size.x, size.y, size.z}), least = std::min({size.x, size.y, size.z});
    Wanted w;
    w.target.label = thing.label;
    w.target.colour = perception::range_around(red, green, blue);
    w.height_m = size.z;
    if (least > 0.85 * most && most < 1) {
      w.target.form = perception::Form::ball;
      w.target.size_m = most;
    } else {
      w.target.form = perception::Form::standing;
      w.target.size_m = std::max(size.x, size.y);
      w.target.depth_m = 0.5 * std::min(size.x, size.y);
      w.target.foot_m = std::max(0.0, sim.engine().states()[thing.bodies[0]].X_WB.p.z + thing.bounds_B.low.z);
    }
    const auto alike = [&](const Wanted& other) {
      return other.target.label == w.target.label &&
             std::abs(other.target.colour.hue_rad - w.target.colour.hue_rad) < 0.1 &&
             std::abs(other.target.colour.min_saturation - w.target.colour.min_saturation) < 0.2;
    };
    if (out.size() < 200 && std::none_of(out.begin(), out.end(), alike)) out.push_back(w);
  }
  for (const std::string& label : grey)
    diagnostics.warn({"things with the label '" + label.substr(0, 100) +
                          "' are black, white or grey for the most part, and so is much else in a picture",
                      "they are left out: their errors have to come from elsewhere"});
  return out;
}

/// Places objects anywhere in view and the robot's front anywhere; the same in all stands.
class Shuffle {
 public:
  Shuffle(Simulation& sim, const Stand& stand, const CalibrateOptions& options, double half_view_rad)
      : half_view_rad_(half_view_rad), most_m_(options.max_range_m) {
    for (const LabelledObject& thing : sim.render_scene().labelled_objects) {
      const Pose X = sim.engine().states()[thing.bodies[0]].X_WB;
      const Vec3 size = thing.bounds_B.size();
      const double radius = 0.5 * math::hypot(size.x, size.y);
      if (thing.name == stand.robot().name) robot_ = {thing.name, X, radius};
      else if (!thing.moves) fixed_.push_back({thing.name, X, radius});
      else if (options.labels.empty() ||
               std::find(options.labels.begin(), options.labels.end(), thing.label) != options.labels.end())
        things_.push_back({thing.name, X, radius});
      else fixed_.push_back({thing.name, X, radius});
    }
  }
  std::vector<PoseRequest> next(Stream& random) {
    std::vector<PoseRequest> out;
    std::vector<Piece> placed{robot_};
    const double yaw = math::pi * (2 * random.uniform() - 1);
    out.push_back({robot_.name, {robot_.X.p, quat_from_axis_angle({0, 0, 1}, yaw)}});
    for (Piece piece : things_) {
      for (int attempt = 0; attempt < 30; ++attempt) {
        const double nearest = robot_.radius_m + piece.radius_m + 0.05;
        const double range = nearest + std::max(0.0, most_m_ - nearest) * random.uniform();
        const double bearing = yaw + half_view_rad_ * (2 * random.uniform() - 1);
        const auto [s, c] = math::sincos(bearing);
        piece.X.p.x = robot_.X.p.x + range * c;
        piece.X.p.y = robot_.X.p.y + range * s;
        const auto clear = [&](const Piece& other) {
          return math::hypot(other.X.p.x - piece.X.p.x, other.X.p.y - piece.X.p.y) >
                 other.radius_m + piece.radius_m + 0.02;
        };
        if (!std::all_of(placed.begin(), placed.end(), clear)) continue;
        if (!std::all_of(fixed_.begin(), fixed_.end(),
                         [&](const Piece& f) { return f.radius_m > 3 || clear(f); }))
          continue;
        placed.push_back(piece);
        out.push_back({piece.name, piece.X});
        break;
      }
    }
    return out;
  }
  bool empty() const { return things_.empty() && fixed_.empty(); }

 private:
  struct Piece {
    std::string name;
    Pose X;
    double radius_m = 0;
  };
  double half_view_rad_, most_m_;
  Piece robot_;
  std::vector<Piece> things_, fixed_;
};

double bearing_off(const Seen& is, const Seen& detected) {
  return std::abs(math::wrap_angle(detected.bearing_rad - is.bearing_rad));
}
/// Whether a detection may belong to an object, whatever its label.
bool is_near(const Seen& is, const Seen& detected) {
  return bearing_off(is, detected) < gate_rad + math::atan2(is.radius_m, is.range_m) &&
         std::abs(detected.range_m - is.range_m) < std::max(0.6, 0.6 * is.range_m) + is.radius_m;
}

/// Pairs what was detected with what is there, the nearest bearings first, and counts. Another label at the
/// place of a thing is a confusion, where nothing with the right one is about as near.
/// @param aside  things that are not in the truth: a strip of a goal at the picture's edge is none, and no
/// ghost either
void compare(const std::vector<Seen>& truth, const std::vector<Seen>& aside,
             const std::vector<Seen>& detected, double min_visible, std::vector<Sighted>& sighted,
             Calibration& out) {
  constexpr double other_label_rad = 0.05;
  struct Pair {
    double off;
    std::size_t t, d;
  };
  std::vector<Pair> pairs;
  std::vector<std::size_t> of_truth(truth.size(), detected.size());
  std::vector<bool> used(detected.size()), beside(detected.size());
  for (std::size_t d = 0; d < detected.size(); ++d) {
    beside[d] = std::any_of(aside.begin(), aside.end(), [&](const Seen& is) {
      return is.label == detected[d].label && is_near(is, detected[d]);
    });
    for (std::size_t t = 0; t < truth.size(); ++t) {
      const bool same_label = truth[t].label == detected[d].label;
      if (is_near(truth[t], detected[d]) && (same_label || !beside[d]))
        pairs.push_back({bearing_off(truth[t], detected[d]) + (same_label ? 0 : other_label_rad), t, d});
    }
  }
  std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) { return a.off < b.off; });
  for (const Pair& pair : pairs)
    if (of_truth[pair.t] == detected.size() && !used[pair.d]) of_truth[pair.t] = pair.d, used[pair.d] = true;
  for (std::size_t t = 0; t < truth.size(); ++t) {
    if (truth[t].visible < min_visible)
      continue;  // too little of it to be missed, and no ghost when detected
    Sighted s{truth[t].range_m, truth[t].visible};
    auto& label = out.labels[truth[t].label];
    ++label.sighted, ++out.sighted;
    if (of_truth[t] < detected.size()) {
      const Seen& d = detected[of_truth[t]];
      s.found = true;
      s.confused = d.label != truth[t].label;
      s.bearing_error_rad = math::wrap_angle(d.bearing_rad - truth[t].bearing_rad);
      s.range_error_m = d.range_m - truth[t].range_m;
      ++label.found, ++out.found;
      label.confused += s.confused, out.confused += s.confused;
      if (!s.confused) {
        label.bearing_squares += s.bearing_error_rad * s.bearing_error_rad;
        label.range_squares += s.range_error_m * s.range_error_m;
      }
    }
    sighted.push_back(s);
  }
  for (std::size_t d = 0; d < detected.size(); ++d)
    if (!used[d] && !beside[d]) ++out.labels[detected[d].label].ghosts, ++out.ghosts;
}

/// The picture with frames about what was found and crosses where the truth is.
Status draw(const std::string& path, const perception::ImageView& view,
            const std::vector<perception::Found>& found, const perception::CameraModel& camera,
            const std::vector<Seen>& truth) {
  std::vector<std::uint8_t> rgb;
  const auto row = static_cast<std::size_t>(3 * view.width);
  for (std::size_t v = 0; v < static_cast<std::size_t>(view.height); ++v)
    for (std::size_t i = 0; i < row; ++i)
      rgb.push_back(view.data[v * view.step + (view.bgr ? i / 3 * 3 + 2 - i % 3 : i)]);
  const auto dot_at = [&](int u, int v, std::uint8_t shade) {
    if (u < 0 || v < 0 || u >= view.width || v >= view.height) return;
    std::fill_n(rgb.begin() + 3 * (static_cast<std::ptrdiff_t>(v) * view.width + u), 3, shade);
  };
  for (const perception::Found& f : found)
    for (int grow = 1; grow <= 2; ++grow) {  // white on black, to be seen on anything
      const int left = f.patch.left - 1 - grow, right = f.patch.right + 1 + grow,
                top = f.patch.top - 1 - grow, bottom = f.patch.bottom + 1 + grow;
      const std::uint8_t shade = grow == 1 ? 255 : 0;
      for (int u = left; u <= right; ++u) dot_at(u, top, shade), dot_at(u, bottom, shade);
      for (int v = top; v <= bottom; ++v) dot_at(left, v, shade), dot_at(right, v, shade);
    }
  for (const Seen& seen : truth) {
    const auto [s, c] = math::sincos(seen.bearing_rad);
    const auto [up, flat] = math::sincos(seen.elevation_rad);
    const Vec3 wanted{flat * c, flat * s, up};
    double best = 0.999;
    int best_u = -9, best_v = -9;
    for (int v = 0; v < view.height; ++v)
      for (int u = 0; u < view.width; ++u) {
        const auto ray = camera.ray(u, v);
        if (!ray || !(dot(ray->direction, wanted) > best)) continue;
        best = dot(ray->direction, wanted);
        best_u = u, best_v = v;
      }
    for (int k = -3; k <= 3; ++k) dot_at(best_u + k, best_v, 0), dot_at(best_u, best_v + k, 0);
  }
  return assets::write_png(path, {view.width, view.height, 3, rgb});
}

}  // namespace

Result<Calibration> calibrate_camera(const CalibrateOptions& asked, Diagnostics& diagnostics,
                                     const std::function<bool(double)>& progress) {
  const bool by_picture = asked.detector == "picture";
  SL_ASSIGN(const auto stand, Stand::make(asked, true, diagnostics));
  CalibrateOptions options = asked;
  if (options.labels.empty()) options.labels = stand->labels();
  std::unique_ptr<Stand> other;
  if (!by_picture) {
    Diagnostics again;
    SL_ASSIGN(other, Stand::make(options, false, again));
  }
  Simulation& sim = stand->sim();
  SL_TRY(stand->next_sample({}));
  if (other) SL_TRY(other->next_sample({}));

  const auto* info = stand->topic<msg::CameraInfo>("camera_info");
  SL_CHECK(info != nullptr && info->count > 0);
  SL_ASSIGN(const perception::CameraModel camera, perception::CameraModel::of(info->message));
  const model::Model& model = *stand->robot().model;
  const Pose X_BS = inverse(model.links.front().X_ML) * model.links[stand->decl().link].X_ML *
                    stand->decl().X_LS;
  const std::vector<Wanted> wanted = wanted_of(sim, *stand, options, diagnostics);
  if (wanted.empty())
    return Error{"there is nothing to see beside '" + stand->robot().name + "'",
                 options.labels.empty() ? "put a ball or other robots into the scenario"
                                        : "no thing has one of these labels"};
  perception::FinderSpec spec;
  spec.targets.clear();
  for (const Wanted& w : wanted) spec.targets.push_back(w.target);
  std::uint32_t base = 0;
  for (const LabelledObject& thing : sim.render_scene().labelled_objects)
    if (thing.name == stand->robot().name) base = thing.bodies[0];
  spec.base_height_m = sim.engine().states()[base].X_WB.p.z;
  perception::Finder finder(spec, camera, X_BS);
  const double half_view = camera.around() ? math::pi
                                           : math::atan(0.5 * info->message.width / info->message.k[0]);
  Shuffle shuffle(sim, *stand, options, half_view);

  Calibration out;
  std::vector<Sighted> sighted;
  std::vector<perception::Found> found;
  const Pose X_SB = inverse(X_BS);
  const Time step = sim.setup().step;
  Time last = sim.now();
  for (int picture = 0; picture < options.samples; ++picture) {
    Time not_before;
    if (!options.as_it_runs) {
      Stream random(sim.setup().seed, entity_key("calibrate"), Purpose::noise,
                    static_cast<std::uint64_t>(picture));
      for (PoseRequest& request : shuffle.next(random)) {
        if (other) other->sim().submit(request);
        sim.submit(std::move(request));
      }
      not_before = sim.now() + step;
    }
    SL_TRY(stand->next_sample(not_before));
    if (other) SL_TRY(other->next_sample(not_before));
    out.seconds += (sim.now() - last).s();
    last = sim.now();
    std::vector<Seen> truth = stand->objects(), detected;
    const auto unwanted = [&](const Seen& s) {
      return std::none_of(wanted.begin(), wanted.end(),
                          [&](const Wanted& w) { return w.target.label == s.label; });
    };
    std::erase_if(truth, unwanted);
    if (other) {
      detected = other->objects();
      std::erase_if(detected, unwanted);
    } else {
      const auto* image = stand->topic<msg::Image>("image");
      SL_ASSIGN(const perception::ImageView view, perception::image_view(image->message));
      SL_TRY(finder.find(view, found));
      for (const perception::Found& f : found) {
        const Wanted& w = wanted[f.target];
        Vec3 middle = f.position_B;
        if (w.target.form == perception::Form::standing) middle.z += 0.5 * w.height_m;
        const Vec3 at = X_SB * middle;
        detected.push_back({w.target.label, "", math::atan2(at.y, at.x), 0, norm(at), f.visible});
      }
      if (!options.pictures.empty() && picture < most_pictures)
        SL_TRY(draw(fmt::format("{}/{:02}.png", options.pictures, picture), view, found, camera, truth));
    }
    std::vector<Seen> aside;
    for (const LabelledObject& thing : sim.render_scene().labelled_objects) {
      const auto is_it = [&](const Seen& seen) { return seen.name == thing.name; };
      if (thing.name == stand->robot().name || std::any_of(truth.begin(), truth.end(), is_it)) continue;
      const auto& states = sim.engine().states();
      const Vec3 middle_W = states[thing.bodies[0]].X_WB * thing.bounds_B.centre();
      const Vec3 at = X_SB * (inverse(states[base].X_WB) * middle_W);
      const Vec3 size = thing.bounds_B.size();
      aside.push_back({thing.label, thing.name, math::atan2(at.y, at.x), 0, norm(at), 0,
                       0.5 * math::hypot(size.x, size.y)});
    }
    compare(truth, aside, detected, stand->min_visible(), sighted, out);
    ++out.pictures;
    if (progress && !progress(static_cast<double>(picture + 1) / options.samples)) {
      out.interrupted = true;
      break;
    }
  }
  out.fit = fit_detector(sighted, out.ghosts, out.seconds);
  return out;
}

std::string calibration_yaml(const CalibrateOptions& options, const Calibration& calibration) {
  const DetectorFit& fit = calibration.fit;
  std::string name = options.camera;
  for (char& c : name)
    if (c == '/' || c == '-' || c == '.') c = '_';
  const auto number = [](double x) { return fmt::format("{:.4g}", std::abs(x) < 1e-9 ? 0 : x); };
  std::string text = fmt::format(
      "# Errors of a detector in the pictures of {}, for its level `objects`.\n"
      "# Measured by sandlot calibrate in {} pictures: {} things to be seen from {:.2g} to {:.2g} m, {} "
      "found ({} taken for something else), {} ghosts.\n",
      options.camera, calibration.pictures, calibration.sighted, fit.nearest_m, fit.farthest_m,
      calibration.found, calibration.confused, calibration.ghosts);
  for (const auto& [label, counts] : calibration.labels) {
    text += fmt::format("#   {}: {} of {} found ({} taken for something else), {} ghosts", label,
                        counts.found, counts.sighted, counts.confused, counts.ghosts);
    if (const int right = counts.found - counts.confused; right > 0)
      text += fmt::format("; rms error {:.2g} rad, {:.2g} m", std::sqrt(counts.bearing_squares / right),
                          std::sqrt(counts.range_squares / right));
    text += "\n";
  }
  text += fmt::format(
      "# Mean errors, which are part of the deviations: bearing {:.2g} rad, range {:.2g} m.\n",
      fit.bearing_mean_rad, fit.range_mean_m);
  text += fmt::format(
      "# Include this file and give the camera `objects: ${{{}_objects}}`, or paste the keys below its "
      "`objects`.\nvars:\n  {}_objects:\n",
      name, name);
  const auto line = [&](const char* key, double value, const char* unit) {
    text += fmt::format("    {}: {}{}\n", key, number(value), unit);
  };
  line("miss_rate", fit.miss_rate, "");
  line("miss_rate_per_m", fit.miss_rate_per_m, "");
  line("miss_rate_hidden", fit.miss_rate_hidden, "");
  line("ghost_rate", fit.ghost_rate_hz, "");
  line("confusion", fit.confusion, "");
  line("bearing_std", fit.bearing_std_rad, "");
  line("range_std", fit.range_std_m, "");
  line("range_std_per_m", fit.range_std_per_m, "");
  return text;
}

int calibrate(const CalibrateOptions& options) {
  catch_interrupts();
  Diagnostics diagnostics;
  const bool draw = isatty(STDERR_FILENO) == 1;
  int shown = -1;
  const auto calibration = calibrate_camera(options, diagnostics, [&](double part) {
    const int percent = static_cast<int>(100 * part);
    if (draw && percent != shown) std::fprintf(stderr, "\rlooking %3d %%", shown = percent);
    return !interrupted();
  });
  if (draw && shown >= 0) std::fputs("\r              \r", stderr);
  print_warnings(diagnostics);
  if (!calibration) return complain(calibration.error());
  if (calibration->sighted == 0) {
    std::fprintf(stderr, "error: in %d pictures there was nothing to be seen\n", calibration->pictures);
    return exit_failed;
  }
  const std::string yaml = calibration_yaml(options, *calibration);
  if (!options.out.empty())
    if (const Status written = write_file(options.out, yaml); !written) return complain(written.error());
  if (options.json) {
    const DetectorFit& fit = calibration->fit;
    const nlohmann::ordered_json json{{"camera", options.camera},
                                      {"pictures", calibration->pictures},
                                      {"sighted", calibration->sighted},
                                      {"found", calibration->found},
                                      {"confused", calibration->confused},
                                      {"ghosts", calibration->ghosts},
                                      {"seconds", calibration->seconds},
                                      {"objects",
                                       {{"miss_rate", fit.miss_rate},
                                        {"miss_rate_per_m", fit.miss_rate_per_m},
                                        {"miss_rate_hidden", fit.miss_rate_hidden},
                                        {"ghost_rate", fit.ghost_rate_hz},
                                        {"confusion", fit.confusion},
                                        {"bearing_std", fit.bearing_std_rad},
                                        {"range_std", fit.range_std_m},
                                        {"range_std_per_m", fit.range_std_per_m}}}};
    std::puts(json_text(json).c_str());
  } else if (options.out.empty()) {
    std::fputs(yaml.c_str(), stdout);
  } else {
    fmt::print("{}: {} of {} found in {} pictures\n", options.out, calibration->found, calibration->sighted,
               calibration->pictures);
  }
  return finish_output(calibration->interrupted ? exit_failed : exit_ok);
}

}  // namespace sandlot::app
