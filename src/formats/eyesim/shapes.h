#pragma once
/// What .robi and .esObj files have in common: meshes by name.
#include "formats/content.h"
#include "formats/eyesim/lines.h"
#include "geometry/mesh.h"
#include "geometry/shape.h"

namespace sandlot::formats::eyesim {

/// A point of model space, which is left-handed (x right, y up, z forward), in ours (x forward, y left, z up).
inline Vec3 from_model_space(Vec3 p) { return {p.z, -p.x, p.y}; }
/// Turns in model space, in degrees: about z first, then x, then y.
Quat turned_in_model_space(Vec3 degrees);
/// From the frame of a mesh, which is right-handed (x left, y up, z forward).
constexpr Quat from_mesh_space{0.5, 0.5, 0.5, 0.5};

/// The mesh that a line names. A missing file is a warning where that is allowed, and where colliders are seen in its place.
/// @return null: it is left out
Result<std::shared_ptr<const TriangleMesh>> mesh_of(const Line& line, const std::string& written, Vec3 scale,
                                                    const std::string& file, const ReadOptions& options,
                                                    Diagnostics& diagnostics, bool has_colliders);

}  // namespace sandlot::formats::eyesim
