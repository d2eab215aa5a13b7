#pragma once
/// Scenes: the world as rays hit it (collisions) and, once somebody needs it, as cameras draw it (visuals). Not State.
#include <memory>
#include <span>
#include <vector>

#include "optics/ray_scene.h"
#include "sim/world/parts.h"

namespace sandlot {

class RenderScene;
struct GroundPaint;  // sim/visuals/ground_paint.h

class Scenes {
 public:
  using Entities = std::span<const Owned<SimulationParts::Entity>>;

  /// `setup` must outlive the scenes.
  explicit Scenes(const model::Setup& setup);
  ~Scenes();
  /// Rays are the engine's own where it casts some. The engine must outlive the scenes.
  void use(const Engine& engine);
  /// Areas that the visuals show on the ground, before the first rebuild().
  void paint(std::vector<GroundPaint> paint);

  const RayCaster& rays() const { return *rays_; }
  /// Null as long as nobody needs it.
  RenderScene* render_scene() const { return render_scene_.get(); }

  /// After entities came or went: takes over their shapes, and their visuals where there is a render scene.
  /// @param needed  there shall be a render scene from now on
  void rebuild(Entities entities, std::uint64_t revision, bool needed, Diagnostics& diagnostics);
  /// The visuals alone, after devices came.
  void rebuild_render_scene(Entities entities, bool needed, Diagnostics& diagnostics);
  /// Takes over the poses of this tick.
  void update(std::uint64_t tick, std::uint64_t revision);

 private:
  void rebuild_ray_scene(Entities entities, std::uint64_t revision);

  const model::Setup& setup_;
  const Engine* engine_ = nullptr;
  std::unique_ptr<RayScene> ray_scene_;  ///< null when the engine casts rays itself
  const RayCaster* rays_ = nullptr;
  SceneFrame frame_;
  std::unique_ptr<RenderScene> render_scene_;
  std::vector<GroundPaint> paint_;
};

}  // namespace sandlot
