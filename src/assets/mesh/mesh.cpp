#include "assets/mesh/mesh.h"

#include <algorithm>
#include <bit>
#include <cctype>
#include <cmath>
#include <filesystem>
#include <map>
#include <mutex>
#include <unordered_map>

#include "assets/mesh/reader.h"
#include "base/text.h"
#include "files/resources.h"
#include "files/text.h"

namespace sandlot::assets {
namespace {

namespace fs = std::filesystem;

/// Farther than any robot goes; beyond, products of coordinates lose all digits.
constexpr double farthest_m = 1e9;

std::string extension_of(const std::string& path) {
  std::string out = fs::path(path).extension().string();
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

/// A texture's name as a path: exporters write URIs and Windows paths.
std::string decoded(const std::string& name) {
  std::string text = mesh::percent_decoded(name);
  text.erase(std::min(text.find('\0'), text.size()));
  std::replace(text.begin(), text.end(), '\\', '/');
  for (const std::string_view scheme : {"file://", "./"})
    if (starts_with(text, scheme)) text.erase(0, scheme.size());
  return text;
}

struct TextureFile {
  std::string path;
  bool is_there = false;
};
/// File of a texture: where it is, or where it would be by its name in the mesh.
TextureFile find_texture(const std::string& name, const std::string& mesh_path) {
  const std::string folder = folder_of(mesh_path), file = decoded(name),
                    bare = fs::path(file).filename().string();
  for (const std::string& each : {file, bare, "../materials/textures/" + bare}) {
    const std::string path = beside(folder, each);
    std::error_code failed;
    if (!bare.empty() && fs::is_regular_file(path, failed)) return {path, true};
  }
  return {beside(folder, file), false};
}

/// A texture that is not there.
struct Missing {
  std::string file;
  Error error;
};

struct Parsed {
  TriangleMesh mesh;
  std::vector<Missing> missing;
};

struct VertexKey {
  std::array<std::uint64_t, 4> bits;
  friend bool operator==(const VertexKey&, const VertexKey&) = default;
};
struct HashVertex {
  std::size_t operator()(const VertexKey& key) const {
    std::uint64_t h = 0x9E3779B97F4A7C15u;
    for (const std::uint64_t b : key.bits) h = (h ^ b ^ (h >> 29)) * 0xBF58476D1CE4E5B9u;
    return static_cast<std::size_t>(h ^ (h >> 32));
  }
};

/// Makes one vertex of those that are equal, drops triangles without area and vertices that none uses.
void tidy(TriangleMesh& mesh) {
  const bool has_uv = !mesh.texture_uv.empty();
  std::unordered_map<VertexKey, std::uint32_t, HashVertex> numbers;  // only looked up
  constexpr std::uint32_t none = ~std::uint32_t{0};
  std::vector<std::uint32_t> number(mesh.vertices.size(), none);
  TriangleMesh out;
  out.triangles.reserve(mesh.triangles.size());
  const auto vertex = [&](std::uint32_t v) {
    if (number[v] != none) return number[v];
    const Vec3 p = mesh.vertices[v];
    VertexKey key{{std::bit_cast<std::uint64_t>(p.x + 0.0), std::bit_cast<std::uint64_t>(p.y + 0.0),
                   std::bit_cast<std::uint64_t>(p.z + 0.0), 0}};
    if (has_uv) key.bits[3] = std::bit_cast<std::uint64_t>(mesh.texture_uv[v]);
    const auto [at, is_new] = numbers.try_emplace(key, static_cast<std::uint32_t>(out.vertices.size()));
    if (is_new) {
      out.vertices.push_back(p);
      if (has_uv) out.texture_uv.push_back(mesh.texture_uv[v]);
    }
    return number[v] = at->second;
  };
  for (MeshPart& part : mesh.parts) {
    const auto first = static_cast<std::uint32_t>(out.triangles.size());
    for (std::uint32_t t = part.first_triangle; t < part.first_triangle + part.triangles; ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      const Vec3 ab = mesh.vertices[b] - mesh.vertices[a], ac = mesh.vertices[c] - mesh.vertices[a],
                 bc = mesh.vertices[c] - mesh.vertices[b];
      // A sliver whose height is lost in the rounding of its corners has no normal to speak of.
      const double longest2 = std::max({dot(ab, ab), dot(ac, ac), dot(bc, bc)});
      if (!(norm(cross(ab, ac)) > 1e-12 * longest2)) continue;
      out.triangles.push_back({vertex(a), vertex(b), vertex(c)});
    }
    part.first_triangle = first;
    part.triangles = static_cast<std::uint32_t>(out.triangles.size()) - first;
  }
  std::erase_if(mesh.parts, [](const MeshPart& part) { return part.triangles == 0; });
  mesh.vertices = std::move(out.vertices);
  mesh.texture_uv = std::move(out.texture_uv);
  mesh.triangles = std::move(out.triangles);
}

void centre(TriangleMesh& mesh) {
  if (mesh.vertices.empty()) return;
  Vec3 low = mesh.vertices.front(), high = low;
  for (const Vec3& v : mesh.vertices)
    for (std::size_t i = 0; i < 3; ++i) low[i] = std::min(low[i], v[i]), high[i] = std::max(high[i], v[i]);
  const Vec3 middle = 0.5 * (low + high);
  for (Vec3& v : mesh.vertices) v -= middle;
}

constexpr std::string_view collada[] = {".dae"}, stl[] = {".stl"}, obj[] = {".obj"},
                           gltf[] = {".gltf", ".glb"}, ms3d[] = {".ms3d"}, ply[] = {".ply"};

/// The mesh formats there are: one entry each.
constexpr MeshFormat formats[] = {
    {"collada", "COLLADA meshes with colours and textures.", collada, mesh::read_collada},
    {"stl", "STL meshes, text or binary: triangles alone.", stl,
     [](std::string_view bytes, mesh::Builder& out, Diagnostics&) { return mesh::read_stl(bytes, out); }},
    {"obj", "Wavefront OBJ meshes with their MTL file.", obj, mesh::read_obj},
    {"gltf", "glTF 2 meshes, text or binary.", gltf, mesh::read_gltf},
    {"ms3d", "MilkShape 3D meshes.", ms3d,
     [](std::string_view bytes, mesh::Builder& out, Diagnostics&) { return mesh::read_ms3d(bytes, out); }},
    {"ply", "PLY meshes, text or binary.", ply,
     [](std::string_view bytes, mesh::Builder& out, Diagnostics&) { return mesh::read_ply(bytes, out); }},
};

Status read_by_extension(std::string_view bytes, const std::string& extension, mesh::Builder& out,
                         Diagnostics& diagnostics) {
  std::string known;
  for (const MeshFormat& format : formats)
    for (const std::string_view each : format.extensions) {
      if (each == extension) return format.read(bytes, out, diagnostics);
      known += " " + std::string(each);
    }
  return out.error("is not in a mesh format that is read here", "known are" + known);
}

Result<Parsed> parse(std::string_view bytes, const std::string& path, const MeshOptions& options,
                     Diagnostics& diagnostics) {
  mesh::Builder out(path, options);
  const Vec3 scale = options.scale;
  if (!is_finite(scale) || scale.x == 0 || scale.y == 0 || scale.z == 0)
    return out.error("the scale of the mesh must be three finite numbers other than 0");
  if (bytes.empty()) return out.error("is empty");
  SL_TRY(read_by_extension(bytes, extension_of(path), out, diagnostics));

  Parsed parsed{std::move(out.mesh), {}};
  TriangleMesh& mesh = parsed.mesh;
  mesh.source = path;
  mesh.source_scale = scale;
  mesh.source_part = options.submesh;
  mesh.source_centred = options.centre;
  if (!options.submesh.empty() && !out.found_submesh)
    return out.error("has no submesh '" + options.submesh.substr(0, 80) + "'",
                     suggestion(options.submesh, out.names));
  if (!options.submesh.empty())
    std::erase_if(mesh.parts, [&](const MeshPart& part) { return part.name != options.submesh; });
  if (out.textures.empty()) mesh.texture_uv.clear();
  for (Vec3& v : mesh.vertices) {
    v = {v.x * scale.x, v.y * scale.y, v.z * scale.z};
    if (!(std::abs(v.x) < farthest_m && std::abs(v.y) < farthest_m && std::abs(v.z) < farthest_m))
      return out.error("has a vertex more than 1e9 m away", "is its unit or scale right?");
  }
  if (scale.x * scale.y * scale.z < 0)
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
  tidy(mesh);
  if (mesh.triangles.empty())
    return out.error("has no triangles", "lines, points and faces without area do not count");
  if (options.centre) centre(mesh);
  std::map<std::string, std::string> files;  // by the name in the mesh
  for (MeshPart& part : mesh.parts) {
    if (part.texture.empty()) continue;
    const auto [known, fresh] = files.try_emplace(part.texture);
    if (fresh) {
      auto [file, is_there] = find_texture(part.texture, path);
      if (!is_there)
        parsed.missing.push_back({file,
                                  {"does not exist", "put it beside the mesh or into ../materials/textures",
                                   out.textures.at(part.texture)}});
      known->second = std::move(file);
    }
    part.texture = known->second;
  }
  return parsed;
}

/// Meshes in use, by file and options.
class Cache {
 public:
  struct Entry {
    std::weak_ptr<const TriangleMesh> mesh;
    std::vector<Error> warnings;
    std::vector<Missing> missing;
  };
  std::shared_ptr<const TriangleMesh> find(const std::string& key, Entry& entry) {
    const std::lock_guard lock(mutex_);
    const auto found = entries_.find(key);
    if (found == entries_.end()) return nullptr;
    entry = found->second;
    return entry.mesh.lock();
  }
  /// The mesh another thread was quicker to add, or `mesh`.
  std::shared_ptr<const TriangleMesh> add(const std::string& key, std::shared_ptr<const TriangleMesh> mesh,
                                          Entry entry) {
    const std::lock_guard lock(mutex_);
    std::erase_if(entries_, [](const auto& each) { return each.second.mesh.expired(); });
    const auto [at, is_new] = entries_.try_emplace(key, std::move(entry));
    if (const auto present = at->second.mesh.lock(); !is_new && present) return present;
    return mesh;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, Entry> entries_;
};

Cache& cache() {
  static Cache the_cache;
  return the_cache;
}

using Meshes = std::vector<std::shared_ptr<const TriangleMesh>>;

/// Hulls in use, by the mesh they were made from.
class HullCache {
 public:
  /// Empty when there are none.
  Meshes find(const std::shared_ptr<const TriangleMesh>& mesh, Simplification how) {
    const std::lock_guard lock(mutex_);
    return find_locked(mesh, how);
  }
  Meshes add(const std::shared_ptr<const TriangleMesh>& mesh, Simplification how, Meshes hulls) {
    const std::lock_guard lock(mutex_);
    std::erase_if(entries_, [](const auto& each) { return each.second.mesh.expired(); });
    if (Meshes present = find_locked(mesh, how); !present.empty()) return present;
    entries_[{mesh.get(), how}] = {mesh, {hulls.begin(), hulls.end()}};
    return hulls;
  }

 private:
  struct Entry {
    std::weak_ptr<const TriangleMesh> mesh;
    std::vector<std::weak_ptr<const TriangleMesh>> hulls;
  };
  Meshes find_locked(const std::shared_ptr<const TriangleMesh>& mesh, Simplification how) const {
    const auto found = entries_.find({mesh.get(), how});
    // An address may have been given out again.
    if (found == entries_.end() || found->second.mesh.lock() != mesh) return {};
    Meshes out;
    for (const auto& each : found->second.hulls) {
      out.push_back(each.lock());
      if (!out.back()) return {};
    }
    return out;
  }
  std::mutex mutex_;
  std::map<std::pair<const TriangleMesh*, Simplification>, Entry>
      entries_;  // found by address, never walked in order
};

HullCache& hull_cache() {
  static HullCache the_cache;
  return the_cache;
}

/// Empty when the file cannot be looked at; the error comes from reading it.
std::string cache_key(const std::string& path, const MeshOptions& o) {
  std::error_code failed;
  const auto size = fs::file_size(path, failed);
  if (failed) return "";
  const auto time = fs::last_write_time(path, failed);
  if (failed) return "";
  std::string key = canonical_path(path);
  for (const auto n :
       {static_cast<std::uint64_t>(size), static_cast<std::uint64_t>(time.time_since_epoch().count()),
        std::bit_cast<std::uint64_t>(o.scale.x), std::bit_cast<std::uint64_t>(o.scale.y),
        std::bit_cast<std::uint64_t>(o.scale.z), std::uint64_t{o.centre}, static_cast<std::uint64_t>(o.up),
        std::uint64_t{o.max_triangles}, std::uint64_t{o.max_bytes}})
    key += '\n' + std::to_string(n);
  return key + '\n' + o.submesh;
}

/// Robots share meshes: each warning is given once.
void pass_on(const std::vector<Error>& warnings, Diagnostics& diagnostics) {
  for (const Error& warning : warnings) {
    const std::string text = warning.text();
    if (std::none_of(diagnostics.warnings.begin(), diagnostics.warnings.end(),
                     [&](const Error& each) { return each.text() == text; }))
      diagnostics.warn(warning);
  }
}

void pass_on(const std::vector<Missing>& missing, Diagnostics& diagnostics) {
  for (const Missing& each : missing) warn_of_texture(each.file, each.error, diagnostics);
}

}  // namespace

Result<TriangleMesh> parse_mesh(std::string_view bytes, const std::string& path, const MeshOptions& options,
                                Diagnostics& diagnostics) {
  SL_ASSIGN(Parsed parsed, parse(bytes, path, options, diagnostics));
  if (options.textures) pass_on(parsed.missing, diagnostics);
  return std::move(parsed.mesh);
}

Result<std::shared_ptr<const TriangleMesh>> read_mesh(const std::string& path, const MeshOptions& options,
                                                      Diagnostics& diagnostics) {
  const std::string key = cache_key(path, options);
  Cache::Entry entry;
  std::shared_ptr<const TriangleMesh> mesh = key.empty() ? nullptr : cache().find(key, entry);
  if (!mesh) {
    SL_ASSIGN(const std::string bytes, read_text_file(path, options.max_bytes));
    Diagnostics own;
    SL_ASSIGN(Parsed parsed, parse(bytes, path, options, own));
    mesh = std::make_shared<const TriangleMesh>(std::move(parsed.mesh));
    entry = {mesh, std::move(own.warnings), std::move(parsed.missing)};
    if (!key.empty()) mesh = cache().add(key, mesh, entry);
  }
  pass_on(entry.warnings, diagnostics);
  if (options.textures) pass_on(entry.missing, diagnostics);
  return mesh;
}

Result<std::vector<std::shared_ptr<const TriangleMesh>>> collision_meshes(
    std::shared_ptr<const TriangleMesh> mesh, Simplification how) {
  if (how == Simplification::none) return Meshes{std::move(mesh)};
  Meshes out = hull_cache().find(mesh, how);
  if (out.empty()) {
    const auto add_hull = [&](const TriangleMesh& of) {
      TriangleMesh hull = convex_hull(of.vertices);
      hull.source = mesh->source;
      hull.is_hull = true;
      if (!hull.triangles.empty()) out.push_back(std::make_shared<const TriangleMesh>(std::move(hull)));
    };
    if (how == Simplification::convex_hull) add_hull(*mesh);
    else
      for (const TriangleMesh& part : connected_parts(*mesh)) add_hull(part);
    if (out.empty()) return Error{"is flat: there is no solid around it", "", place_in(mesh->source)};
    out = hull_cache().add(mesh, how, std::move(out));
  }
  return out;
}

std::span<const MeshFormat> mesh_formats() { return formats; }

}  // namespace sandlot::assets
