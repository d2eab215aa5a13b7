#pragma once
/// The field of a middle size league match as cameras see it: carpet with lines, goals, twelve robots of two
/// thousand triangles each, a ball, people, the sun and four lamps.
#include <algorithm>
#include <cmath>
#include <memory>

#include "base/math.h"
#include "base/random.h"
#include "geometry/mesh.h"
#include "optics/picture.h"

namespace sandlot::bench {

struct MslScene {
  std::vector<optics::PictureShape> shapes;
  std::vector<optics::PictureLight> lights;
  SceneFrame frame;
  std::vector<Pose> robots;  ///< x forward, on the ground

  MslScene();
};

/// Green carpet of 24 x 16 m with the lines of a field of 22 x 14 m, 100 texels per metre.
std::shared_ptr<const optics::Texture> field_texture();

}  // namespace sandlot::bench
