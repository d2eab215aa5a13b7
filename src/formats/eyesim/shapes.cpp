#include "formats/eyesim/shapes.h"

#include "assets/mesh/mesh.h"
#include "files/resources.h"
#include "files/text.h"
#include "formats/eyesim/paths.h"

namespace sandlot::formats::eyesim {

Quat turned_in_model_space(Vec3 degrees) {
  // Mirrored into ours, a positive turn about right is one about left, those about up and forward go the other way round.
  return quat_from_axis_angle({0, 0, 1}, -radians(degrees.y)) *
         quat_from_axis_angle({0, 1, 0}, radians(degrees.x)) *
         quat_from_axis_angle({1, 0, 0}, -radians(degrees.z));
}

Result<std::shared_ptr<const TriangleMesh>> mesh_of(const Line& line, const std::string& written, Vec3 scale,
                                                    const std::string& file, const ReadOptions& options,
                                                    Diagnostics& diagnostics, bool has_colliders) {
  const std::string folder = folder_of(file);
  const auto found = find_resource(located(written, folder, options.path), folder, options.path, line.place);
  if (!found) {
    if (!options.skip_missing && !has_colliders) return found.error();
    diagnostics.warn(found.error());
    return std::shared_ptr<const TriangleMesh>();
  }
  auto mesh = assets::read_mesh(*found, {.scale = scale, .up = assets::UpAxis::as_written}, diagnostics);
  if (!mesh && !mesh.error().place.file) mesh.error().place = line.place;
  return mesh;
}

}  // namespace sandlot::formats::eyesim
