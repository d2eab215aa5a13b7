#include <algorithm>
#include <charconv>
#include <filesystem>
#include <limits>

#include "base/bytes.h"
#include "base/hash.h"
#include "base/text.h"
#include "files/text.h"
#include "wire/asset_table.h"

namespace sandlot::wire {
namespace {

/// A float of a double that may be larger than any float.
float narrow(double x) {
  constexpr double most = std::numeric_limits<float>::max();
  return static_cast<float>(std::clamp(x, -most, most));
}
std::uint32_t size32(std::size_t size) { return static_cast<std::uint32_t>(size); }

template <class T>
std::uint64_t hash_of(const std::vector<T>& values) {
  return hash64(std::as_bytes(std::span(values)));
}
std::uint64_t hash_of(const TriangleMesh& mesh) {
  return hash_combine(hash_of(mesh.vertices), hash_of(mesh.triangles));
}
std::uint64_t hash_of(const HeightGrid& grid) { return hash_of(grid.height_m); }

/// They look the same: where they come from does not count.
bool same(const TriangleMesh& a, const TriangleMesh& b) {
  const auto same_part = [](const MeshPart& p, const MeshPart& q) {
    return p.first_triangle == q.first_triangle && p.triangles == q.triangles && p.color == q.color &&
           p.texture == q.texture;
  };
  return a.vertices == b.vertices && a.triangles == b.triangles && a.texture_uv == b.texture_uv &&
         std::equal(a.parts.begin(), a.parts.end(), b.parts.begin(), b.parts.end(), same_part);
}
bool same(const HeightGrid& a, const HeightGrid& b) {
  return a.columns == b.columns && a.rows == b.rows && a.size_x_m == b.size_x_m && a.size_y_m == b.size_y_m &&
         a.height_m == b.height_m;
}

std::vector<std::byte> encode(const TriangleMesh& mesh, const std::vector<std::uint32_t>& textures) {
  ByteWriter w;
  w.buffer().reserve(20 + mesh.vertices.size() * 20 + mesh.triangles.size() * 12 + mesh.parts.size() * 28);
  const bool uv = !mesh.texture_uv.empty();
  for (const std::uint32_t number : {0x314d4c53u, size32(mesh.vertices.size()), size32(mesh.triangles.size()),
                                     uv ? 1u : 0u, size32(mesh.parts.size())})
    write(w, number);
  for (const Vec3& v : mesh.vertices) write(w, std::array{narrow(v.x), narrow(v.y), narrow(v.z)});
  for (const auto& each : mesh.texture_uv) write(w, each);
  for (const auto& each : mesh.triangles) write(w, each);
  for (std::size_t i = 0; i < mesh.parts.size(); ++i) {
    const MeshPart& part = mesh.parts[i];
    write(w, part.first_triangle), write(w, part.triangles);
    write(w, std::array{part.color.r, part.color.g, part.color.b, part.color.a});
    write(w, textures[i]);
  }
  return std::move(w.buffer());
}

std::vector<std::byte> encode(const HeightGrid& grid, const std::vector<std::uint32_t>&) {
  ByteWriter w;
  write(w, std::uint32_t{0x31474c53});
  write(w, std::uint32_t(grid.columns)), write(w, std::uint32_t(grid.rows));
  write(w, narrow(grid.size_x_m)), write(w, narrow(grid.size_y_m));
  w.raw(grid.height_m.data(), grid.height_m.size() * sizeof(float));
  return std::move(w.buffer());
}

Error no_such(std::string_view path) {
  return Error{"the world has no asset '" + std::string(path.substr(0, 60)) + "'"};
}

}  // namespace

template <class LabelledObject>
std::uint32_t AssetTable::find_or_add(Table<LabelledObject>& table,
                                      const std::shared_ptr<const LabelledObject>& thing) {
  if (const auto known = table.by_pointer.find(thing.get());
      known != table.by_pointer.end() && !known->second.thing.expired())
    return known->second.number;
  std::uint32_t number = size32(table.all.size());
  const std::uint64_t hash = hash_of(*thing);
  const auto [first, last] = table.by_hash.equal_range(hash);
  for (auto each = first; each != last; ++each)
    if (same(*table.all[each->second].thing, *thing)) number = each->second;
  if (number < table.all.size()) {
    table.all[number].thing = thing;  // of the two the one that is in use anyway
  } else {
    table.all.push_back({thing, {}, nullptr});
    table.by_hash.emplace(hash, number);
  }
  if (table.by_pointer.size() > 2 * table.all.size() + 64)
    std::erase_if(table.by_pointer, [](const auto& each) { return each.second.thing.expired(); });
  table.by_pointer[thing.get()] = {thing, number};
  return number;
}

std::uint32_t AssetTable::number_of(const std::shared_ptr<const TriangleMesh>& mesh) {
  const std::lock_guard lock(mutex_);
  const std::uint32_t number = find_or_add(meshes_, mesh);
  auto& textures = meshes_.all[number].textures;
  if (textures.empty())
    for (const MeshPart& part : mesh->parts)
      textures.push_back(part.texture.empty() ? 0 : texture_number(part.texture) + 1);
  return number;
}
std::uint32_t AssetTable::number_of(const std::shared_ptr<const HeightGrid>& grid) {
  const std::lock_guard lock(mutex_);
  return find_or_add(grids_, grid);
}
std::uint32_t AssetTable::number_of_texture(const std::string& file) {
  const std::lock_guard lock(mutex_);
  return texture_number(file);
}
std::uint32_t AssetTable::texture_number(const std::string& file) {
  const auto [found, fresh] = texture_numbers_.try_emplace(file, size32(textures_.size()));
  if (fresh) textures_.push_back(file);
  return found->second;
}

template <class LabelledObject>
Result<Assets::Body> AssetTable::body(Table<LabelledObject>& table, std::string_view path,
                                      std::uint32_t number) {
  Kept<LabelledObject> kept;
  {
    const std::lock_guard lock(mutex_);
    if (number >= table.all.size()) return no_such(path);
    kept = table.all[number];
  }
  // Written without the lock: the simulation's thread may be waiting for it.
  if (!kept.bytes) {
    kept.bytes = std::make_shared<const std::vector<std::byte>>(encode(*kept.thing, kept.textures));
    const std::lock_guard lock(mutex_);
    auto& there = table.all[number].bytes;
    if (!there) there = kept.bytes;
    kept.bytes = there;
  }
  return Assets::Body{"application/octet-stream", kept.bytes};
}

Result<Assets::Body> AssetTable::texture(std::string_view path, std::uint32_t number) {
  std::string file;
  {
    const std::lock_guard lock(mutex_);
    if (number >= textures_.size()) return no_such(path);
    file = textures_[number];
  }
  // Whoever asks may be a stranger: where the file lies is none of their business.
  const std::string name = "the texture '" + std::filesystem::path(file).filename().string() + "'";
  const Result<std::string> read = read_text_file(file, most_texture_bytes);
  if (!read) return Error{name + ": " + read.error().what};
  const std::string& text = *read;
  const bool png = starts_with(text, "\x89PNG\r\n\x1a\n"), jpeg = starts_with(text, "\xff\xd8\xff");
  if (!png && !jpeg) return Error{name + " is neither a PNG nor a JPEG", "convert it to one of them"};
  const auto bytes = std::as_bytes(std::span(text));
  return Assets::Body{png ? "image/png" : "image/jpeg",
                      std::make_shared<const std::vector<std::byte>>(bytes.begin(), bytes.end())};
}

Result<Assets::Body> AssetTable::get(std::string_view path) {
  const struct {
    std::string_view prefix;
    int what;
  } all[] = {{"mesh/a", 0}, {"grid/g", 1}, {"texture/t", 2}};
  for (const auto& [prefix, what] : all) {
    if (!starts_with(path, prefix)) continue;
    const std::string_view digits = path.substr(prefix.size());
    std::uint32_t number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (error != std::errc() || end != digits.data() + digits.size()) break;
    return what == 0   ? body(meshes_, path, number)
           : what == 1 ? body(grids_, path, number)
                       : texture(path, number);
  }
  return no_such(path);
}

Assets::Assets() : table_(std::make_shared<AssetTable>()) {}

Result<Assets::Body> Assets::get(std::string_view path) const { return table_->get(path); }

}  // namespace sandlot::wire
