#pragma once
/// Shared parts of the readers of mesh formats. Not for use outside this folder.
#include <array>
#include <cstdint>
#include <cstring>
#include <map>
#include <string>
#include <string_view>

#include "assets/mesh/mesh.h"
#include "base/result.h"

namespace sandlot::assets::mesh {

struct Material {
  Color color;
  std::string texture;  ///< as the file says it
  Place place;          ///< of the texture's name; no file: the mesh as a whole
};

/// Collects what a reader finds.
class Builder {
 public:
  Builder(std::string path, const MeshOptions& options)
      : path_(std::move(path)), file_(std::make_shared<const std::string>(path_)), options_(options) {}

  const std::string& path() const { return path_; }
  const MeshOptions& options() const { return options_; }
  Error error(std::string what, std::string fix = "", int line = 0) const {
    return {std::move(what), std::move(fix), {file_, line, 0}};
  }
  Error truncated() const { return error("ends too early", "the file is cut off or damaged"); }

  /// Triangles that follow belong to this part.
  void begin_part(const std::string& name, const Material& material);
  /// Parts of other submeshes than the one asked for need not be read, only noted.
  bool wanted(const std::string& name) const { return options_.submesh.empty() || options_.submesh == name; }
  /// For the error that says which there are.
  void note_name(const std::string& name);

  std::uint32_t vertex(Vec3 p, std::array<float, 2> uv = {});
  Status triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, int line = 0);
  /// A face of any number of corners.
  Status polygon(const std::vector<std::uint32_t>& corners, int line = 0);
  /// The error for more triangles than allowed; null when `count` is fine.
  Status check_count(std::uint64_t count, int line = 0) const;

  /// Another file in the mesh's folder or below it.
  Result<std::string> read_beside(const std::string& name, int line = 0) const;

  TriangleMesh mesh;
  std::vector<std::string> names;  ///< the first few
  bool found_submesh = false;
  std::map<std::string, Place> textures;  ///< and where each is named first

 private:
  std::string path_;
  std::shared_ptr<const std::string> file_;
  const MeshOptions& options_;
};

/// Little-endian numbers from a bounded run of bytes.
class Bytes {
 public:
  explicit Bytes(std::string_view bytes) : bytes_(bytes) {}
  bool has(std::uint64_t count) const { return bytes_.size() - at_ >= count; }
  void skip(std::size_t count) { at_ += count; }
  std::size_t at() const { return at_; }
  /// @pre has(sizeof(T))
  template <class T>
  T get() {
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  std::string_view text(std::size_t count) {
    const std::string_view out = bytes_.substr(at_, count);
    at_ += count;
    return out.substr(0, out.find('\0'));
  }

 private:
  std::string_view bytes_;
  std::size_t at_ = 0;
};

/// Words of a text, and the line each is on.
class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}
  /// The next word; empty at the end.
  std::string_view next();
  /// The next line without its end; false at the end.
  bool next_line(std::string_view& out);
  int line() const { return line_; }
  std::size_t at() const { return at_; }

 private:
  std::string_view text_;
  std::size_t at_ = 0;
  int line_ = 1;
};

/// A finite number or false.
bool number(std::string_view word, double& out);
bool integer(std::string_view word, std::int64_t& out);

/// The text with %20 and the like undone, as URIs have them.
std::string percent_decoded(std::string_view text);

/// 3x4, row by row: node transforms, which may scale and shear.
struct Affine {
  std::array<double, 12> m{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};
  friend Affine operator*(const Affine& a, const Affine& b);
  friend Vec3 operator*(const Affine& a, Vec3 p) {
    return {a.m[0] * p.x + a.m[1] * p.y + a.m[2] * p.z + a.m[3],
            a.m[4] * p.x + a.m[5] * p.y + a.m[6] * p.z + a.m[7],
            a.m[8] * p.x + a.m[9] * p.y + a.m[10] * p.z + a.m[11]};
  }
  /// It turns triangles inside out.
  bool mirrors() const;
};
Affine translation(Vec3 p);
Affine scaling(Vec3 s);
Affine rotation(Quat q);

Status read_stl(std::string_view bytes, Builder& out);
Status read_obj(std::string_view bytes, Builder& out, Diagnostics& diagnostics);
Status read_ply(std::string_view bytes, Builder& out);
Status read_ms3d(std::string_view bytes, Builder& out);
Status read_collada(std::string_view bytes, Builder& out, Diagnostics& diagnostics);
Status read_gltf(std::string_view bytes, Builder& out, Diagnostics& diagnostics);

}  // namespace sandlot::assets::mesh
