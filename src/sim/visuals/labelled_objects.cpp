#include "sim/visuals/labelled_objects.h"

#include <algorithm>

#include "geometry/mesh.h"

namespace sandlot {
namespace {

/// Links of the declared pose, seen from the canonical one.
Pose in_first(const model::Model& model, std::size_t link) {
  return inverse(model.links.front().X_ML) * model.links[link].X_ML;
}

Bounds bounds_of_model(const model::Model& model) {
  Bounds visuals, collisions;
  for (std::size_t i = 0; i < model.links.size(); ++i) {
    const Pose X_BL = in_first(model, i);
    for (const model::Visual& visual : model.links[i].visuals)
      visuals.include(bounds_of(visual.shape, X_BL * visual.X_LC));
    for (const model::Collision& collision : model.links[i].collisions)
      collisions.include(bounds_of(collision.shape, X_BL * collision.X_LC));
  }
  return visuals.empty() ? collisions : visuals;
}

/// Colour of the visual with the largest bounding box: the colour that a person would name.
Color color_of(const model::Model& model) {
  Color color;
  double largest = -1;
  for (const model::Link& link : model.links)
    for (const model::Visual& visual : link.visuals) {
      const Bounds box = bounds_of(visual.shape);
      if (box.empty()) continue;
      const Vec3 size = box.size();
      const double surface = size.x * size.y + size.y * size.z + size.z * size.x;
      if (surface <= largest) continue;
      largest = surface;
      color = visual.material.diffuse;
      const auto* const mesh = std::get_if<Mesh>(&visual.shape);
      if (!mesh || !visual.material.from_mesh) continue;
      std::uint32_t most = 0;
      for (const MeshPart& part : mesh->mesh->parts)
        if (part.triangles > most) most = part.triangles, color = part.color;
    }
  return color;
}

}  // namespace

std::vector<LabelledObject> labelled_objects_of(std::span<const Owned<SimulationParts::Entity>> entities,
                                                const Engine& engine) {
  std::vector<LabelledObject> things;
  for (const auto& entity : entities) {
    const model::Instance& instance = entity->instance;
    const Bounds bounds = bounds_of_model(*instance.model);
    if (bounds.empty()) continue;
    LabelledObject& thing = things.emplace_back();
    thing.name = instance.name;
    const std::string& of_model = instance.model->label.empty() ? instance.model->name
                                                                : instance.model->label;
    thing.label = instance.label.empty() ? of_model : instance.label;
    thing.team = instance.team;
    thing.properties = instance.properties;
    thing.is_robot = instance.is_robot;
    thing.moves = !instance.model->is_static || instance.motion.has_value();
    if (!instance.model->is_static && !instance.motion)
      for (const model::Link& link : instance.model->links) thing.mass_kg += link.inertial.mass_kg;
    thing.color = color_of(*instance.model);
    thing.instance = picture_instance(*entity);
    for (const BodyId body : engine.bodies(entity->id)) thing.bodies.push_back(body.index);
    thing.bounds_B = bounds;
  }
  return things;
}

}  // namespace sandlot
