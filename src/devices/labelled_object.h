#pragma once
/// Labelled objects: the instances of the world as detectors see them, by Context.
///
/// Frame    B: the body of the canonical link. Sizes are those of the declared pose of all joints.
/// Limits   what has no bounds (a ground plane) is not an object. One colour per object: that of its largest
///          visual.
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "geometry/bounds.h"
#include "geometry/color.h"
#include "model/declarations.h"

namespace sandlot {

struct LabelledObject {
  std::string name;   ///< address: "ball1"
  std::string label;  ///< its class, such as ball: the scenario's, else the model's name
  std::string team;   ///< "" for none
  bool is_robot = false;
  double mass_kg = 0;  ///< of all links; 0 for what forces do not move
  bool moves = false;  ///< false: it stands as it was placed until the world's next revision
  Color color;
  std::uint32_t instance = 0;                       ///< as images name it; > 0, never given twice in a run
  std::vector<std::uint32_t> bodies;                ///< one per link; [0] is B
  std::span<const model::PropertyDecl> properties;  ///< of the user's own, as they are now
  Bounds bounds_B;  ///< of its visuals, or where it has none of its collisions
};

}  // namespace sandlot
