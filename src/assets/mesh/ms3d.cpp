#include "assets/mesh/reader.h"

namespace sandlot::assets::mesh {
namespace {

struct Triangle {
  std::array<std::uint16_t, 3> corner;
  std::array<std::array<float, 2>, 3> uv;
};

}  // namespace

Status read_ms3d(std::string_view bytes, Builder& out) {
  Bytes in(bytes);
  if (!in.has(14) || in.text(10) != "MS3D000000") return out.error("is not a MS3D file");
  if (const auto version = in.get<std::int32_t>(); version != 3 && version != 4)
    return out.error("is MS3D version " + std::to_string(version), "versions 3 and 4 are read");

  if (!in.has(2)) return out.truncated();
  const auto vertices = in.get<std::uint16_t>();
  if (!in.has(std::uint64_t{vertices} * 15)) return out.truncated();
  std::vector<Vec3> points;
  for (int i = 0; i < vertices; ++i) {
    in.skip(1);
    const auto x = in.get<float>(), y = in.get<float>(), z = in.get<float>();
    points.push_back({x, y, z});
    if (!is_finite(points.back())) return out.error("vertex " + std::to_string(i) + " is not a number");
    in.skip(2);
  }

  if (!in.has(2)) return out.truncated();
  const auto count = in.get<std::uint16_t>();
  if (!in.has(std::uint64_t{count} * 70)) return out.truncated();
  std::vector<Triangle> triangles(count);
  for (Triangle& t : triangles) {
    in.skip(2);
    for (std::uint16_t& corner : t.corner) {
      corner = in.get<std::uint16_t>();
      if (corner >= vertices)
        return out.error("a triangle names vertex " + std::to_string(corner) + " of " +
                         std::to_string(vertices));
    }
    in.skip(36);
    for (std::size_t i = 0; i < 3; ++i) t.uv[i][0] = in.get<float>();
    for (std::size_t i = 0; i < 3; ++i) t.uv[i][1] = 1 - in.get<float>();  // downwards in the file
    in.skip(2);
  }

  struct Group {
    std::string name;
    std::vector<std::uint16_t> triangles;
    int material;
  };
  if (!in.has(2)) return out.truncated();
  std::vector<Group> groups(in.get<std::uint16_t>());
  std::vector<bool> taken(count);
  for (Group& g : groups) {
    if (!in.has(35)) return out.truncated();
    in.skip(1);
    g.name = std::string(in.text(32));
    const auto n = in.get<std::uint16_t>();
    if (!in.has(std::uint64_t{n} * 2 + 1)) return out.truncated();
    for (int i = 0; i < n; ++i) {
      const auto t = in.get<std::uint16_t>();
      if (t >= count)
        return out.error("group '" + g.name + "' names triangle " + std::to_string(t) + " of " +
                         std::to_string(count));
      if (taken[t]) return out.error("triangle " + std::to_string(t) + " belongs to two groups");
      taken[t] = true;
      g.triangles.push_back(t);
    }
    g.material = in.get<std::int8_t>();
  }

  std::vector<Material> materials;
  if (!in.has(2)) return out.truncated();
  const auto material_count = in.get<std::uint16_t>();
  if (!in.has(std::uint64_t{material_count} * 361)) return out.truncated();
  for (int i = 0; i < material_count; ++i) {
    in.skip(32 + 16);
    Material m;
    m.color.r = in.get<float>(), m.color.g = in.get<float>(), m.color.b = in.get<float>();
    in.skip(4 + 16 + 16 + 4);
    m.color.a = in.get<float>();
    in.skip(1);
    m.texture = std::string(in.text(128));
    in.skip(128);
    materials.push_back(std::move(m));
  }

  for (const Group& g : groups) {
    out.note_name(g.name);
    if (!out.wanted(g.name)) continue;
    const bool known = g.material >= 0 && static_cast<std::size_t>(g.material) < materials.size();
    out.begin_part(g.name, known ? materials[static_cast<std::size_t>(g.material)] : Material{});
    for (const std::uint16_t t : g.triangles) {
      std::array<std::uint32_t, 3> c{};
      for (std::size_t i = 0; i < 3; ++i)
        c[i] = out.vertex(points[triangles[t].corner[i]], triangles[t].uv[i]);
      SL_TRY(out.triangle(c[0], c[1], c[2]));
    }
  }
  return {};
}

}  // namespace sandlot::assets::mesh
