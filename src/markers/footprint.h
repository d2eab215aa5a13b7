#pragma once
/// Footprint: what the collisions of a robot or object cover of the ground, seen from above, against the area of a marker.
///
/// Counted   each collision that can touch and of which a part is above z = 0, as its silhouette (geometry/silhouette.h): whole,
///           though a part of it may be below.
/// Limits    nothing of planes and terrain. Heights do not matter otherwise: what flies over an area overlaps it.
/// Cost      a silhouette per collision, for a mesh one that looks at all its vertices; what is far from the area is
///           not passed over any faster.
#include "markers/marker.h"

namespace sandlot {

bool overlaps(const Marker& marker, const Engine& engine, const model::Model& model, InstanceId id);

}  // namespace sandlot
