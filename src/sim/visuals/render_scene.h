#pragma once
/// Render scene: visuals and lights of the world as cameras draw them, and its labelled objects as detectors name them.
///
/// Built with the first device that needs it, or when a client requests a picture; nothing here is State.
/// Groups of the picture scene are the engine's bodies, and one more that stands still: the world's own lights hang on it.
#include <map>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "optics/picture.h"
#include "sim/visuals/ground_paint.h"
#include "sim/visuals/labelled_objects.h"

namespace sandlot {

class RenderScene {
 public:
  optics::PictureScene pictures;
  std::vector<LabelledObject> labelled_objects;

  /// Takes over what stands in the world now. A texture that cannot be read is a warning and a checker.
  void rebuild(std::span<const Owned<SimulationParts::Entity>> entities, const Engine& engine,
               const model::Setup& setup, std::span<const GroundPaint> paint, Diagnostics& diagnostics);
  /// The poses and velocities of this tick, and the lights of devices.
  void update(const Engine& engine, std::uint64_t tick, std::uint64_t revision);
  /// Other poses of the same bodies until the next update: the world between two ticks.
  void show(std::span<const Pose> X_WB);

 private:
  using TexturePointer = std::shared_ptr<const optics::Texture>;
  TexturePointer texture(const std::string& file, const Place& place, Diagnostics& diagnostics);
  optics::SurfaceAppearance look_of(const model::Visual& visual, Diagnostics& diagnostics);

  std::map<std::string, TexturePointer> textures_;  ///< by file: kept while the world is, read once
  /// A light of a device, as it was handed to the pictures.
  struct Lamp {
    const SceneLight* light;
    std::uint32_t group;
    Color shown;
  };
  void set_lights();

  std::vector<optics::PictureLight> fixed_lights_;  ///< all but those of devices
  std::vector<Lamp> lamps_;
  SceneFrame frame_;
  std::vector<Velocity> velocities_;
};

}  // namespace sandlot
