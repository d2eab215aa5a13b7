#pragma once
/// Links of a model: mass, collision shapes and visuals.
#include <cstdint>
#include <string>
#include <vector>

#include "base/fields.h"
#include "base/result.h"
#include "geometry/color.h"
#include "geometry/pose.h"
#include "geometry/shape.h"
#include "model/surface.h"

namespace sandlot::model {

struct Inertial {
  double mass_kg = 1;
  Pose X_LCo;             ///< Co: the centre of mass, with the axes of the tensor below
  Vec3 moments{1, 1, 1};  ///< [kg m^2] ixx iyy izz about Co
  Vec3 products;          ///< [kg m^2] ixy ixz iyz

  static void fields(auto& s, auto&& visit) {
    visit(Field{"mass", "kg", "Mass."}, s.mass_kg);
    visit(Field{"pose", "", "Centre of mass and axes of the tensor in the link."}, s.X_LCo);
    visit(Field{"moments", "kg m^2", "Moments ixx iyy izz about the centre of mass."}, s.moments);
    visit(Field{"products", "kg m^2", "Products ixy ixz iyz about the centre of mass."}, s.products);
  }
};

/// Appearance of a visual. PBR and scripts of materials are reduced to this.
struct Material {
  Color diffuse;
  Color specular{0, 0, 0, 1}, emissive{0, 0, 0, 1};
  float shininess = 0;
  std::string texture;
  bool from_mesh = true;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"diffuse", "1", "Diffuse colour, times the texture if there is one."}, s.diffuse);
    visit(Field{"specular", "1", "Colour of highlights."}, s.specular);
    visit(Field{"emissive", "1", "Colour of the light that the surface emits."}, s.emissive);
    visit(Field{"shininess", "1", "Exponent of the highlight; 0: matt."}, s.shininess);
    visit(Field{"texture", "", "File of the colour texture; empty for none."}, s.texture);
    visit(Field{"from_mesh", "", "Whether a mesh shows its own colours: the file has no material."},
          s.from_mesh);
  }
};

struct Collision {
  std::string name;
  Pose X_LC;
  Shape shape;
  Surface surface;
  Place place;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the collision."}, s.name);
    visit(Field{"pose", "", "Pose in the link."}, s.X_LC);
    visit(Field{"shape", "", "Shape."}, s.shape);
    visit(Field{"surface", "", "Contact behaviour."}, s.surface);
  }
};

struct Visual {
  std::string name;
  Pose X_LC;
  Shape shape;
  Material material;
  bool cast_shadows = true;
  Place place;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the visual."}, s.name);
    visit(Field{"pose", "", "Pose in the link."}, s.X_LC);
    visit(Field{"shape", "", "Shape."}, s.shape);
    visit(Field{"material", "", "Appearance."}, s.material);
    visit(Field{"cast_shadows", "", "Whether the visual casts shadows."}, s.cast_shadows);
  }
};

struct Link {
  std::string name;
  Pose X_ML;
  Inertial inertial;
  std::vector<Collision> collisions;
  std::vector<Visual> visuals;
  bool gravity = true;
  Place place;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"name", "", "Name of the link."}, s.name);
    visit(Field{"pose", "", "Pose in the model."}, s.X_ML);
    visit(Field{"inertial", "", "Mass and inertia."}, s.inertial);
    visit(Field{"collisions", "", "Shapes that touch."}, s.collisions);
    visit(Field{"visuals", "", "Shapes that are seen."}, s.visuals);
    visit(Field{"gravity", "", "Whether gravity acts on the link."}, s.gravity);
  }
};

}  // namespace sandlot::model
