#include "draw/viewpoint.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "assets/image/visible.h"
#include "base/hash.h"
#include "base/math.h"
#include "base/text.h"
#include "optics/picture.h"
#include "sim/visuals/render_scene.h"
#include "sim/world/simulation.h"

namespace sandlot::draw {
namespace {

constexpr double lag_s = 0.5;

/// At `from`, x towards `at`, z as far up as that leaves.
Pose looking(Vec3 from, Vec3 at) {
  const Vec3 d = at - from;
  const double flat = std::sqrt(d.x * d.x + d.y * d.y);
  // Straight down the upper edge of the picture is +y, as maps have it.
  const double yaw = flat > 1e-9 * norm(d) ? math::atan2(d.y, d.x) : math::pi / 2;
  return {from, quat_from_rpy(0, -math::atan2(d.z, flat), yaw)};
}

bool is_picture(const TopicBase& topic) {
  return topic_cast<msg::Image>(&topic) || topic_cast<msg::CompressedImage>(&topic);
}

/// The topic with the pictures of "robot/camera", or of one of its topics.
Result<std::string> picture_topic(const std::string& camera, const Simulation& simulation) {
  const std::string name = camera.starts_with('/') ? camera : "/" + camera;
  std::vector<std::string> known;
  for (const TopicBase* const topic : simulation.topics()) {
    if (!is_picture(*topic)) continue;
    if (topic->name() == name || topic->name().starts_with(name + "/")) return topic->name();
    known.push_back(topic->name().substr(1));
  }
  if (known.empty())
    return Error{
        "there is no camera '" + camera + "': nothing here sends pictures",
        "look from a place with --from and --at, from above with --overhead, or --camera follow:ROBOT"};
  return Error{"there is no camera '" + camera + "'", suggestion(camera, known)};
}

const LabelledObject* find_thing(const RenderScene& scene, const std::string& name) {
  const auto found = std::find_if(scene.labelled_objects.begin(), scene.labelled_objects.end(),
                                  [&](const LabelledObject& thing) { return thing.name == name; });
  return found == scene.labelled_objects.end() ? nullptr : &*found;
}

RenderScene& scene_at(Simulation& simulation, const Moment* moment) {
  RenderScene& scene = simulation.render_scene();
  if (moment) scene.show(moment->X_WB);
  return scene;
}

Bounds bounds_of_everything(Simulation& simulation) {
  Bounds all;
  for (const LabelledObject& thing : simulation.render_scene().labelled_objects) {
    const Pose& X_WB = simulation.engine().states()[thing.bodies[0]].X_WB;
    for (unsigned corner = 0; corner < 8; ++corner) {
      const Bounds& b = thing.bounds_B;
      all.include(X_WB * Vec3{(corner & 1) ? b.high.x : b.low.x, (corner & 2) ? b.high.y : b.low.y,
                              (corner & 4) ? b.high.z : b.low.z});
    }
  }
  if (all.empty()) all.include(Vec3{});
  return all;
}

}  // namespace

Result<Viewpoint> Viewpoint::make(const ViewpointOptions& options, Simulation& simulation) {
  Viewpoint view;
  view.options_ = options;
  if (options.from.has_value() != options.at.has_value())
    return Error{"--from and --at go together: where from, and where to",
                 "add the other one: --from 3,-3,2 --at 0,0,0"};
  if (options.camera.empty() != options.from.has_value())
    return Error{"a picture is taken either by a camera or from a place",
                 "give one of --camera robot/device, --from 3,-3,2 --at 0,0,0, --overhead"};
  static const std::array<std::string, 4> planes{"rgb", "depth", "labels", "instances"};
  if (std::find(planes.begin(), planes.end(), options.plane) == planes.end())
    return Error{"--plane: there is no '" + options.plane + "'", suggestion(options.plane, planes)};

  const std::string follow = "follow:";
  if (options.camera.starts_with(follow)) {
    view.follow_ = options.camera.substr(follow.size());
  } else if (!options.camera.empty() && options.camera != "overhead") {
    SL_ASSIGN(view.topic_, picture_topic(options.camera, simulation));
    if (options.plane != "rgb")
      return Error{"--plane is for views of their own: a robot's camera sends what it sends",
                   "name another of its topics, as `sandlot info` lists them"};
    if (options.width)
      return Error{"the size of '" + options.camera + "' is its own",
                   "change it with --set, or leave the size out"};
    return view;
  }

  const int width = options.width.value_or(960), height = options.height.value_or(540);
  SL_ASSIGN(const optics::Lens lens, optics::pinhole_of_fov(width, height, options.fov_rad));
  view.lens_ = optics::LensTable::make(lens);
  if (options.from) {
    if (norm(*options.at - *options.from) < 1e-6)
      return Error{"--from and --at are the same point", "look at something else"};
    view.X_WS_ = looking(*options.from, *options.at);
  } else if (!view.follow_.empty()) {
    const RenderScene& scene = simulation.render_scene();
    const LabelledObject* const thing = find_thing(scene, view.follow_);
    if (!thing) {
      std::vector<std::string> known;
      for (const LabelledObject& each : scene.labelled_objects)
        if (each.is_robot || each.moves) known.push_back(each.name);
      return Error{"there is no '" + view.follow_ + "' to follow", suggestion(view.follow_, known)};
    }
    view.distance_m_ = std::max(0.5, 2.2 * norm(thing->bounds_B.size()));
  } else {
    const Bounds all = bounds_of_everything(simulation);
    const Vec3 size = all.size(), middle = all.centre();
    const double half = math::tan(options.fov_rad / 2);
    const double up = 1.03 * std::max({size.x / 2 / half, size.y / 2 / (half * height / width), 0.5});
    view.X_WS_ = looking({middle.x, middle.y, all.high.z + up}, {middle.x, middle.y, all.low.z - 1});
  }
  return view;
}

Result<Pose> Viewpoint::pose(Simulation& simulation, const Moment* moment) {
  if (follow_.empty()) return X_WS_;
  RenderScene& scene = scene_at(simulation, moment);
  const LabelledObject* const thing = find_thing(scene, follow_);
  if (!thing) return Error{"'" + follow_ + "', which the picture follows, has gone"};
  const std::uint32_t body = thing->bodies[0];
  const Pose X_WB = moment ? moment->X_WB[body] : simulation.engine().states()[body].X_WB;
  const Time now = moment ? moment->at : simulation.now();
  const Vec3 place = X_WB * thing->bounds_B.centre();
  const Vec3 ahead = rotate(X_WB.q, {1, 0, 0});
  const double flat = std::sqrt(ahead.x * ahead.x + ahead.y * ahead.y);
  if (!lag_) lag_ = Lag{now, place, flat > 0 ? ahead.x / flat : 1, flat > 0 ? ahead.y / flat : 0};
  // A first-order lag of the heading, so that a robot that turns is seen to turn. One that stands on its nose
  // has none.
  const double share = 1 - math::exp(-(now - lag_->at).s() / lag_s);
  lag_->at = now;
  lag_->place = place;
  if (flat > 0.1) {
    const double x = lag_->heading_x + share * (ahead.x / flat - lag_->heading_x);
    const double y = lag_->heading_y + share * (ahead.y / flat - lag_->heading_y);
    const double length = std::sqrt(x * x + y * y);
    if (length > 1e-6) lag_->heading_x = x / length, lag_->heading_y = y / length;
  }
  const Vec3 heading{lag_->heading_x, lag_->heading_y, 0};
  const Vec3 back = Vec3{0, 0, 0.5 * distance_m_} - distance_m_ * heading;
  // Before what stands between it and the robot the view draws near: else it would show that alone.
  float free_m = 0;
  const optics::Lens one{1, 1, optics::Pinhole{.fx = 1, .fy = 1}};
  optics::PictureJob job{.X_WS = looking(place, place + back), .lens = optics::LensTable::make(one)};
  job.near_m = 0.55 * norm(thing->bounds_B.size());  // not the robot itself
  job.far_m = norm(back);
  job.depth_m = {&free_m, 1};
  scene.pictures.render({&job, 1});
  const double share_of_way = std::min(1.0, 0.9 * static_cast<double>(free_m) / norm(back));
  return looking(place + share_of_way * back, place + 0.2 * distance_m_ * heading);
}

std::uint64_t Viewpoint::messages(const Simulation& simulation) const {
  const TopicBase* const topic = simulation.find_topic(topic_);
  return topic ? topic->count : 0;
}

Result<assets::Picture> Viewpoint::picture(Simulation& simulation, const Moment* moment) {
  if (!topic_.empty()) {
    const TopicBase* const topic = simulation.find_topic(topic_);
    if (!topic) return Error{"the camera '" + topic_ + "' has gone"};
    if (topic->count == 0) return assets::Picture();
    if (const auto* const image = topic_cast<msg::Image>(topic)) return assets::visible(image->message);
    if (const auto* const image = topic_cast<msg::CompressedImage>(topic))
      return assets::visible(image->message);
    return Error{"the topic '" + topic_ + "' has no pictures"};
  }
  RenderScene& scene = scene_at(simulation, moment);
  SL_ASSIGN(const Pose X_WS, pose(simulation, moment));
  const optics::Lens& lens = lens_->lens();
  assets::Picture out{lens.width, lens.height, {}};
  const auto pixels = static_cast<std::size_t>(lens.width) * static_cast<std::size_t>(lens.height);
  optics::PictureJob job{.X_WS = X_WS, .lens = lens_, .key = hash64("view")};
  job.exposure.samples = options_.samples;
  job.exposure.shadows = options_.shadows;
  if (options_.plane == "rgb") {
    out.rgb.resize(3 * pixels);
    job.rgb = out.rgb;
    scene.pictures.render({&job, 1});
    return out;
  }
  if (options_.plane == "depth") {
    std::vector<float> depth(pixels);
    job.depth_m = depth;
    scene.pictures.render({&job, 1});
    out.rgb = assets::distance_colours(depth);
    return out;
  }
  std::vector<std::uint32_t> ids(pixels);
  job.instance = ids;
  scene.pictures.render({&job, 1});
  if (options_.plane == "labels") {
    // A number for each label, in their alphabetical order.
    std::set<std::string> labels;
    for (const LabelledObject& thing : scene.labelled_objects) labels.insert(thing.label);
    std::vector<std::uint32_t> label_of;
    for (const LabelledObject& thing : scene.labelled_objects) {
      label_of.resize(std::max<std::size_t>(label_of.size(), thing.instance + std::size_t{1}));
      label_of[thing.instance] = 1 + static_cast<std::uint32_t>(
                                         std::distance(labels.begin(), labels.find(thing.label)));
    }
    for (std::uint32_t& id : ids) id = id < label_of.size() ? label_of[id] : 0;
  }
  out.rgb = assets::label_colours(ids);
  return out;
}

}  // namespace sandlot::draw
