#pragma once
/// Picture scene: visuals and lights for cameras, drawn by rays (Embree) without a graphics card.
///
/// It shows the visuals of a world; range sensors have a scene of their own with the collisions
/// (ray_scene.h). Geometry is given once per Model revision, poses once per tick, questions in batches of
/// PictureJobs.
///
/// Geometry   primitives are met where they are (exact silhouettes and normals), meshes and terrain as their
///            triangles with normals smoothed across edges of less than 40 degrees. Of two visuals in one
///            plane the later one is seen.
/// Light      diffuse (Lambert) + specular (Blinn) + emissive + ambient, both sides of every surface; hard
///            shadows of sun, point and spot lights. Textures are filtered along the footprint of the pixel,
///            so far lines fade instead of breaking up.
/// Planes     `rgb` is anti-aliased, with depth of field and motion blur where set; depth, label and instance
///            never are: they are what the ray through the pixel's centre (and the lens's) meets in the
///            middle of the exposure.
/// Limits     no reflections, refractions, transparency (alpha is ignored) or indirect light beyond
///            `ambient`.
/// Cost       trees are built at the first render() after an update(): worlds in which nobody looks pay
///            nothing. Then about 30 ns per pixel and sample and light on a soccer field; a time slice costs
///            an update of all moving visuals.
/// Determinism  pixels depend on scene and job alone: not on the thread count, grouping of jobs or earlier
///              pictures.
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "geometry/color.h"
#include "model/model.h"
#include "optics/lens.h"
#include "optics/ray_scene.h"
#include "optics/texture.h"

namespace sandlot::optics {

/// Appearance of a surface: model::Material with its files read.
struct SurfaceAppearance {
  Color diffuse;  ///< times the texture, if there is one; also what ambient light shows
  Color specular{0, 0, 0, 1}, emissive{0, 0, 0, 1};
  float shininess = 0;                     ///< exponent of the highlight; 0: matt
  std::shared_ptr<const Texture> texture;  ///< null: none. Texture::missing() for one that could not be read
  bool from_mesh = false;                  ///< colours of the mesh's own parts instead of diffuse and texture
  /// With from_mesh: of each part of the mesh, in its order; null: that part's colour alone. May be shorter.
  std::vector<std::shared_ptr<const Texture>> part_textures;
  double tile_m = 1;   ///< planes, being infinite: what the texture covers once
  bool smooth = true;  ///< false: every triangle flat
};

struct PictureShape {
  std::uint32_t group = 0;  ///< index into SceneFrame::X_WG
  Pose X_GC;                ///< shape frame in the group's frame
  Shape shape;
  std::uint32_t body = no_body;  ///< compared with PictureJob::ignore_body
  bool moves = true;             ///< false: the group's pose never changes between revisions
  SurfaceAppearance appearance;
  bool cast_shadows = true;
  std::uint32_t instance = 0;  ///< for the instance plane; 0 is "nothing"
  std::uint16_t label = 0;     ///< for the label plane; 0 is "nothing"
};

/// `light.X_PLight` is the pose in the group's frame; light leaves along its -z, as in model::Light. Spot
/// angles are those of the whole cone: half of them to each side.
struct PictureLight {
  std::uint32_t group = 0;
  model::Light light;
};

struct Surroundings {
  Color background{0.7f, 0.7f, 0.7f, 1};
  Color ambient{0.4f, 0.4f, 0.4f, 1};
};

/// Exposure and rendering options of a camera.
struct Exposure {
  int samples = 1;      ///< per pixel, 1 to 256; 1 looks through pixel centres
  bool shadows = true;  ///< false: lights shine through everything
  double gain = 1;      ///< times all light
  /// True: textures and the picture are sRGB, light is added linearly. False: values as they are.
  bool srgb = false;
  double aperture_m = 0;  ///< diameter of the lens; 0: all is sharp. Pinholes only
  double focus_m = 1;     ///< distance along the optical axis that is sharp
  double shutter_s = 0;   ///< how long each pixel is exposed: moving things blur
  double readout_s = 0;   ///< from the first row's exposure to the last row's; 0: all at once
  /// Moments at which moving things are placed, with shutter or readout; 0: chosen (8 for a shutter, 16 for a
  /// readout).
  int slices = 0;
  bool lit = true;  ///< false: surfaces show their own colour, as under even white light
};

/// One picture. A tick's pose is that of the middle of the first row's exposure.
struct PictureJob {
  Pose X_WS;
  Velocity velocity;  ///< of S in W: used with shutter or readout alone
  std::shared_ptr<const LensTable> lens;
  Exposure exposure;
  std::uint64_t key = 0;  ///< of the places of samples on pixel and lens, such as entity_key() of the camera
  std::uint32_t ignore_body = no_body;  ///< not seen by this camera; its shadow is
  double near_m = 0;                    ///< nearest visible distance
  double far_m = 1e5;                   ///< farthest visible distance
  // Out, each optional (empty) or one value per pixel (rgb: three bytes), rows from the top.
  std::span<std::uint8_t> rgb;
  std::span<float>
      depth_m;  ///< pinholes: along the optical axis; others: distance from S's origin. +inf: nothing there
  std::span<std::uint16_t> label;
  std::span<std::uint32_t> instance;
};

/// A small flat surface that light falls on.
struct LightProbe {
  Vec3 p_W, normal_W;                   ///< unit normal, towards the side that looks
  std::uint32_t ignore_body = no_body;  ///< casts no shadow on it
  Color light{
      0, 0, 0,
      1};  ///< out: what a white matt surface there would send on; ambient and lights, with their shadows
};

class PictureScene {
 public:
  PictureScene();
  ~PictureScene();
  PictureScene(const PictureScene&) = delete;
  PictureScene& operator=(const PictureScene&) = delete;

  /// Replace what is there; trees follow with the next picture.
  void set_shapes(std::span<const PictureShape> shapes);
  void set_lights(std::span<const PictureLight> lights);
  void set_surroundings(const Surroundings& surroundings);
  /// Takes the poses of this tick and, for shutters and rolling shutters, the velocities of the groups (or
  /// none).
  /// @pre frame.X_WG covers all groups; velocities too, or is empty
  void update(const SceneFrame& frame, std::span<const Velocity> velocities = {});

  /// Draws all pictures, on the threads of the current arena. Not to be called from two threads at once.
  void render(std::span<const PictureJob> jobs);

  /// Illuminance at some places: lights, attenuation, cosine and shadows as in pictures. What is nearer
  /// than 0.2 mm casts no shadow; all else does, but for `ignore_body`. Not to be called from two threads at
  /// once.
  void illuminate(std::span<LightProbe> probes);

  const char* isa() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sandlot::optics
