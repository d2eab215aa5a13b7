#pragma once
/// Contacts of barrels: rollers of wheels, tyres.
///
/// Method   plane: the barrel's farthest point. Ball and capsule: the place of their axis that is deepest in
///          the barrel. Box: the least overlap along its face normals and out of its edges. Mesh, terrain,
///          cone, ellipsoid: each triangle nearby by its face where the barrel's farthest point lies over it,
///          else by its edges; an edge does not count next to a face that pushes the same way, so that seams
///          of a flat floor are not felt. Cylinders and other barrels: see cylinder_contacts.h.
/// Output   one point per surface that is touched; four where a flat end lies on a plane, box or triangle.
/// Exact    plane, ball, capsule; box and triangles while the overlap is small against the barrel.
/// Limits   triangles are a skin with one side: a barrel whose middle has sunk in is not pushed out. A line
///          of contact (an edge along a long profile) is one point.
/// Cost     plane 0.1 us; box 1 us where no edge is near, 10 where one is; triangles 0.3 us each, 3 at their
///          edges.
#include <ode/ode.h>

#include <span>

#include "geometry/pose.h"
#include "geometry/shape.h"
#include "physics/rigid/triangles.h"

namespace sandlot::rigid {

/// Contacts as ODE's geometry, the normal pointing into the barrel; not thinned out.
/// @param triangles  of `other`, where ODE knows it as such
/// @pre other is neither a Cylinder nor a Barrel
int collide_barrel(const Barrel& barrel, const Pose& X_WB, const Shape& other, const Pose& X_WO,
                   const Triangles* triangles, std::span<dContactGeom> out);

}  // namespace sandlot::rigid
