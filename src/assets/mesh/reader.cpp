#include "assets/mesh/reader.h"

#include <algorithm>
#include <charconv>
#include <cmath>

#include "files/text.h"
#include "geometry/triangulate.h"

namespace sandlot::assets::mesh {
namespace {

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '\f' || c == '\v'; }

float unit(float x, float otherwise) { return std::isfinite(x) ? std::clamp(x, 0.0f, 1.0f) : otherwise; }

/// Corners of a face on the plane that it leans to least, counter-clockwise where the face is.
Loop2 flattened(const std::vector<Vec3>& p) {
  Vec3 normal;  // Newell: sums the cross products of neighbours, so bent faces have one too
  for (std::size_t i = 0; i < p.size(); ++i) normal += cross(p[i] - p[0], p[(i + 1) % p.size()] - p[0]);
  const Vec3 size{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
  const std::size_t out = size.x > size.y && size.x > size.z ? 0 : size.y > size.z ? 1 : 2;
  std::size_t u = (out + 1) % 3, v = (out + 2) % 3;
  if (normal[out] < 0) std::swap(u, v);
  Loop2 loop;
  for (const Vec3& each : p) loop.push_back({each[u], each[v]});
  return loop;
}

bool is_convex(const Loop2& p) {
  const std::size_t n = p.size();
  for (std::size_t i = 0; i < n; ++i) {
    const auto &a = p[i], &b = p[(i + 1) % n], &c = p[(i + 2) % n];
    if ((b[0] - a[0]) * (c[1] - b[1]) - (b[1] - a[1]) * (c[0] - b[0]) < 0) return false;
  }
  return true;
}

}  // namespace

void Builder::note_name(const std::string& name) {
  found_submesh = found_submesh || name == options_.submesh;
  constexpr std::size_t enough_to_suggest_from = 100;
  if (names.size() < enough_to_suggest_from && std::find(names.begin(), names.end(), name) == names.end())
    names.push_back(name);
}

void Builder::begin_part(const std::string& name, const Material& material) {
  note_name(name);
  // An empty part makes room for the next, so that their number is bounded like the triangles.
  if (!mesh.parts.empty() && mesh.parts.back().triangles == 0) mesh.parts.pop_back();
  const Color c = material.color, otherwise;
  mesh.parts.push_back(
      {.name = name,
       .first_triangle = static_cast<std::uint32_t>(mesh.triangles.size()),
       .triangles = 0,
       .color = {unit(c.r, otherwise.r), unit(c.g, otherwise.g), unit(c.b, otherwise.b), unit(c.a, 1)},
       .texture = material.texture});
  if (!material.texture.empty())
    textures.try_emplace(material.texture, material.place.file ? material.place : Place{file_, 0, 0});
}

std::uint32_t Builder::vertex(Vec3 p, std::array<float, 2> uv) {
  mesh.vertices.push_back(p);
  for (float& x : uv)
    if (!std::isfinite(x)) x = 0;
  mesh.texture_uv.push_back(uv);
  return static_cast<std::uint32_t>(mesh.vertices.size() - 1);
}

Status Builder::check_count(std::uint64_t count, int line) const {
  if (count <= options_.max_triangles) return {};
  return error("has " + std::to_string(count) + " triangles or more",
               "at most " + std::to_string(options_.max_triangles) + " are read: simplify the mesh", line);
}

Status Builder::triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c, int line) {
  SL_TRY(check_count(mesh.triangles.size() + 1, line));
  mesh.triangles.push_back({a, b, c});
  ++mesh.parts.back().triangles;
  return {};
}

Status Builder::polygon(const std::vector<std::uint32_t>& corners, int line) {
  constexpr std::size_t cut_properly = 1000;
  if (corners.size() > 3 && corners.size() <= cut_properly) {
    std::vector<Vec3> points;
    for (const std::uint32_t c : corners) points.push_back(mesh.vertices[c]);
    const Loop2 loop = flattened(points);
    if (!is_convex(loop)) {
      const auto pieces = triangulate({loop});
      for (const auto& [a, b, c] : pieces) SL_TRY(triangle(corners[a], corners[b], corners[c], line));
      if (!pieces.empty()) return {};
    }
  }
  for (std::size_t i = 2; i < corners.size(); ++i)
    SL_TRY(triangle(corners[0], corners[i - 1], corners[i], line));
  return {};
}

Result<std::string> Builder::read_beside(const std::string& name, int line) const {
  std::string file = name;
  std::replace(file.begin(), file.end(), '\\', '/');
  const std::string normal = beside("", file);
  if (file.empty() || file.front() == '/' || normal.substr(0, 2) == ".." ||
      file.find(':') != std::string::npos || file.find('\0') != std::string::npos)
    return error("'" + name.substr(0, 80) + "' is not read: it is not a file in the mesh's folder", "", line);
  auto bytes = read_text_file(beside(folder_of(path_), file), options_.max_bytes);
  if (!bytes)
    return error("'" + name.substr(0, 80) + "', which it names, " +
                     (bytes.error().what == "no such file" ? "does not exist" : bytes.error().what),
                 bytes.error().fix, line);
  return bytes;
}

std::string_view Words::next() {
  while (at_ < text_.size() && is_blank(text_[at_])) {
    if (text_[at_] == '\n') ++line_;
    ++at_;
  }
  const std::size_t begin = at_;
  while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
  return text_.substr(begin, at_ - begin);
}

bool Words::next_line(std::string_view& out) {
  if (at_ >= text_.size()) return false;
  const std::size_t end = std::min(text_.find('\n', at_), text_.size());
  out = text_.substr(at_, end - at_);
  while (!out.empty() && is_blank(out.back())) out.remove_suffix(1);
  at_ = end + 1;
  ++line_;
  return true;
}

bool number(std::string_view word, double& out) {
  if (!word.empty() && word.front() == '+') word.remove_prefix(1);
  const auto [end, failed] = std::from_chars(word.data(), word.data() + word.size(), out);
  if (end != word.data() + word.size() || word.empty()) return false;
  if (failed == std::errc::result_out_of_range &&
      (word.find("e-") != std::string_view::npos || word.find("E-") != std::string_view::npos))
    return out = 0, true;  // too small to tell from 0
  return failed == std::errc() && std::isfinite(out);
}

bool integer(std::string_view word, std::int64_t& out) {
  const auto [end, failed] = std::from_chars(word.data(), word.data() + word.size(), out);
  return failed == std::errc() && end == word.data() + word.size() && !word.empty();
}

std::string percent_decoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    unsigned byte = 0;
    const char* const digits = text.data() + i + 1;
    const bool escape = text[i] == '%' && i + 2 < text.size() &&
                        std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2;
    out += escape ? static_cast<char>(byte) : text[i];
    if (escape) i += 2;
  }
  return out;
}

Affine operator*(const Affine& a, const Affine& b) {
  Affine out;
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 4; ++column) {
      double sum = column == 3 ? a.m[4 * row + 3] : 0;
      for (std::size_t k = 0; k < 3; ++k) sum += a.m[4 * row + k] * b.m[4 * k + column];
      out.m[4 * row + column] = sum;
    }
  return out;
}

bool Affine::mirrors() const {
  const Vec3 x{m[0], m[4], m[8]}, y{m[1], m[5], m[9]}, z{m[2], m[6], m[10]};
  return dot(cross(x, y), z) < 0;
}

Affine translation(Vec3 p) { return {{1, 0, 0, p.x, 0, 1, 0, p.y, 0, 0, 1, p.z}}; }
Affine scaling(Vec3 s) { return {{s.x, 0, 0, 0, 0, s.y, 0, 0, 0, 0, s.z, 0}}; }
Affine rotation(Quat q) {
  const Vec3 x = rotate(q, {1, 0, 0}), y = rotate(q, {0, 1, 0}), z = rotate(q, {0, 0, 1});
  return {{x.x, y.x, z.x, 0, x.y, y.y, z.y, 0, x.z, y.z, z.z, 0}};
}

}  // namespace sandlot::assets::mesh
