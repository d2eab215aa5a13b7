#include "sim/load/world.h"

#include "sim/load/declared_devices.h"

namespace sandlot {

Status take_world(formats::WorldContent content, const SearchPath& path, model::Setup& setup,
                  Diagnostics& diagnostics) {
  for (model::Instance& instance : content.instances) {
    SL_TRY(translate_devices(instance, path, diagnostics));
    instance.is_robot = instance.is_robot || !instance.devices.empty();
    setup.instances.push_back(std::move(instance));
  }
  setup.media.insert(setup.media.begin(), content.media.begin(), content.media.end());
  static_cast<model::Environment&>(setup) = std::move(content);
  return {};
}

model::Instance bare_ground() {
  auto ground = std::make_shared<model::Model>();
  ground->name = "ground";
  ground->is_static = true;
  model::Link link;
  link.name = "link";
  link.collisions.push_back({"collision", {}, Plane{{0, 0, 1}}, {}, {}});
  link.visuals.push_back({"visual", {}, Plane{{0, 0, 1}}, {}, true, {}});
  ground->links.push_back(std::move(link));
  model::Instance instance;
  instance.name = instance.original_name = "ground";
  instance.model = std::move(ground);
  return instance;
}

model::Light sun() {
  model::Light light;
  light.name = "sun";
  light.X_PLight = {{0, 0, 10}, quat_between({0, 0, -1}, normalised(Vec3{-0.5, 0.1, -0.9}))};
  light.color = {0.8f, 0.8f, 0.8f, 1};
  light.specular = {0.2f, 0.2f, 0.2f, 1};
  light.cast_shadows = true;
  return light;
}

}  // namespace sandlot
