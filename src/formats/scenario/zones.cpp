#include <map>

#include "base/text.h"
#include "formats/scenario/tree.h"
#include "model/substance.h"

namespace sandlot::formats {
namespace {

Result<model::SurfaceZone> read_zone(const Node& node, const scenario_spec::Zone& keys,
                                     const std::string& path, Diagnostics& diagnostics) {
  model::SurfaceZone zone;
  zone.name = keys.name;
  zone.place = node.place();
  if (keys.name.empty()) return node.error("the zone's name is empty", "", path + "/name");
  if (keys.polygon_m.empty() == !keys.centre_m)
    return node.error("expected one of 'polygon' and 'centre'", "a polygon's corners, or centre and radius",
                      path);
  if (keys.centre_m) {
    zone.centre_W = {(*keys.centre_m)[0], (*keys.centre_m)[1], 0};
    zone.radius_m = keys.radius_m;
  } else if (const Node* const radius = node.find("radius")) {
    return radius->error("a polygon has no radius", "give 'centre' for a round zone", path + "/radius");
  }
  double area_m2 = 0;
  for (std::size_t i = 0, n = keys.polygon_m.size(); i < n; ++i) {
    const auto& [x, y] = keys.polygon_m[i];
    const auto& [next_x, next_y] = keys.polygon_m[(i + 1) % n];
    zone.outline_W.push_back({x, y, 0});
    area_m2 += (x * next_y - next_x * y) / 2;
  }
  if (!zone.outline_W.empty() && !(std::abs(area_m2) > 1e-12))
    return node.find("polygon")->error("the polygon has no area", "three corners not in a line",
                                       path + "/polygon");
  model::Surface& surface = zone.surface;
  surface.mu = surface.mu2 = keys.friction;
  surface.rolling_resistance_m = keys.rolling_resistance_m;
  surface.belt_velocity_mps = {keys.belt_velocity_mps[0], keys.belt_velocity_mps[1], 0};
  surface.touches = !keys.no_contact;
  if (const Node* const substance = node.find("substance")) {
    auto read = model::substance_from(keys.substance);
    if (!read) return substance->error(read.error().what, read.error().fix, path + "/substance");
    if (!read->warning.empty())
      diagnostics.warn({read->warning, "", substance->place(), path + "/substance"});
    surface.substance = read->substance;
  }
  return zone;
}

}  // namespace

Status read_zones(const Node& root, const std::vector<scenario_spec::Zone>& keys,
                  std::vector<model::SurfaceZone>& out, Diagnostics& diagnostics) {
  std::map<std::string, Place> names;
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const Node& each = root.find("ground_zones")->items()[i];
    const std::string path = "/ground_zones/" + std::to_string(i);
    SL_ASSIGN(model::SurfaceZone zone, read_zone(each, keys[i], path, diagnostics));
    if (const auto [known, fresh] = names.emplace(zone.name, zone.place); !fresh)
      return each.find("name")->error("two zones are called '" + zone.name + "'",
                                      "the other one is at " + to_string(known->second), path + "/name");
    out.push_back(std::move(zone));
  }
  return {};
}

}  // namespace sandlot::formats
