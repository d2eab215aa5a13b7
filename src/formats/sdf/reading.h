#pragma once
/// State of reading one document: the options, the warnings, the resolved frames.
#include "formats/sdf/frames.h"
#include "formats/sdf/sdf.h"
#include "formats/sdf/values.h"

namespace sandlot::formats {

struct Reading {
  const SdfOptions& options;
  Notes& notes;
  const ResolvedFrames& frames;

  /// The pose of an element: as resolved, or as written.
  Result<Pose> pose(const Xml& element) const;
  /// The file that `uri`, written at `element`, names; nothing and one warning when it is missing and may be.
  Result<std::optional<std::string>> find(const Xml& element, const std::string& uri,
                                          const char* without) const;
  /// The file of a texture. One that is missing is a warning and keeps its name: cameras show a checker.
  std::string find_texture(const Xml& element, const std::string& uri) const;
};

/// The child of a child ..., or null.
const Xml* descend(const Xml& element, std::initializer_list<const char*> path);

/// The shapes of <geometry>: one, several for a mesh in convex parts, none for what is empty or left out. `X_LG` is
/// moved by the offset of a heightmap.
Result<std::vector<Shape>> read_shapes(const Xml& owner, Pose& X_LG, const Reading& in);

/// The <inertial> of a link; computed from its collisions where the file leaves that to us.
/// @param densities_kgpm3  of the collisions of `link`, in their order
Result<model::Inertial> read_inertial(const Xml& element, const model::Link& link,
                                      const std::vector<double>& densities_kgpm3, bool is_static,
                                      const Reading& in);

/// The <surface> of a collision, or the default.
Result<model::Surface> read_surface(const Xml& owner, Notes& notes);

Result<model::Material> read_material(const Xml& visual, const Reading& in);

/// Type, axes, limits and dynamics of a joint.
Status read_joint_motion(const Xml& element, model::Joint& out, const Reading& in);
/// <sandlot:safety> of a joint, if there: limits that its motors keep.
Status read_safety(const Xml& joint, model::Joint& out, const Reading& in);
/// <sandlot:rollers> of a joint, if there: its child is a wheel with rollers.
Status read_rollers(const Xml& joint, model::Joint& out, const Reading& in);
/// A gearbox couples the turns of two links, which no joint of ours does.
bool is_gearbox(const Xml& element);

Result<model::Light> read_light(const Xml& element, const Reading& in);

/// What an <actor> does, from its <script>. `X_WA` places the actor.
Result<model::Motion> read_motion(const Xml& element, const Pose& X_WA, const Reading& in);

}  // namespace sandlot::formats
