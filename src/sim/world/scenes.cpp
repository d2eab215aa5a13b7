#include "sim/world/scenes.h"

#include "sim/visuals/ground_paint.h"
#include "sim/visuals/render_scene.h"

namespace sandlot {

Scenes::Scenes(const model::Setup& setup) : setup_(setup) {}
Scenes::~Scenes() = default;

void Scenes::use(const Engine& engine) {
  engine_ = &engine;
  rays_ = engine.rays();
  if (rays_) return;
  ray_scene_ = std::make_unique<RayScene>();
  rays_ = ray_scene_.get();
}

void Scenes::paint(std::vector<GroundPaint> paint) { paint_ = std::move(paint); }

void Scenes::rebuild(Entities entities, std::uint64_t revision, bool needed, Diagnostics& diagnostics) {
  rebuild_ray_scene(entities, revision);
  rebuild_render_scene(entities, needed, diagnostics);
}

void Scenes::rebuild_ray_scene(Entities entities, std::uint64_t revision) {
  if (!ray_scene_) return;
  std::vector<SceneShape> shapes;
  frame_.X_WG.assign(engine_->states().size(), Pose{});
  for (const auto& entity : entities) {
    const model::Model& model = *entity->instance.model;
    const auto bodies = engine_->bodies(entity->id);
    for (std::size_t link = 0; link < model.links.size(); ++link)
      for (const model::Collision& collision : model.links[link].collisions)
        shapes.push_back({bodies[link].index, collision.X_LC, collision.shape, bodies[link].index,
                          !model.is_static || entity->instance.motion.has_value()});
  }
  ray_scene_->set_shapes(shapes);
  frame_.revision = revision;
}

void Scenes::rebuild_render_scene(Entities entities, bool needed, Diagnostics& diagnostics) {
  if (!render_scene_ && !needed) return;
  if (!render_scene_) render_scene_ = std::make_unique<RenderScene>();
  render_scene_->rebuild(entities, *engine_, setup_, paint_, diagnostics);
}

void Scenes::update(std::uint64_t tick, std::uint64_t revision) {
  if (render_scene_) render_scene_->update(*engine_, tick, revision);
  if (!ray_scene_) return;
  const auto states = engine_->states();
  frame_.tick = tick;
  frame_.X_WG.resize(states.size());
  for (std::size_t i = 0; i < states.size(); ++i) frame_.X_WG[i] = states[i].X_WB;
  ray_scene_->update(frame_);
}

}  // namespace sandlot
