#include <map>
#include <set>
#include <unordered_map>

#include "assets/mesh/reader.h"
#include "base/text.h"
#include "files/text.h"

namespace sandlot::assets::mesh {
namespace {

using Materials = std::map<std::string, Material, std::less<>>;

/// The rest of a line, blanks around it aside: names may have blanks in them.
std::string rest_of(std::string_view line, const Words& words) {
  return std::string(trim(line.substr(words.at())));
}

void read_mtl(std::string_view text, const std::string& file, Materials& materials) {
  const auto name = std::make_shared<const std::string>(file);
  Words in(text);
  std::string_view line;
  Material* open = nullptr;
  while (in.next_line(line)) {
    Words words(line);
    const std::string_view key = words.next();
    if (key == "newmtl") {
      open = &(materials[rest_of(line, words)] = {.color = {1, 1, 1, 1}});
      continue;
    }
    if (!open) continue;
    if (key == "Kd") {
      std::array<double, 3> c{};
      bool good = true;
      for (double& x : c) good = good && number(words.next(), x);
      if (good)
        open->color = {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2]),
                       open->color.a};
    } else if (key == "d" || key == "Tr") {
      double a = 0;
      if (number(words.next(), a)) open->color.a = static_cast<float>(key == "d" ? a : 1 - a);
    } else if (key == "map_Kd") {
      // Options begin with '-' and have numbers or words; the file name is what stands last.
      const std::string rest = rest_of(line, words);
      const std::size_t last = !rest.empty() && rest.front() == '-' ? rest.find_last_of(" \t") + 1 : 0;
      open->texture = rest.substr(last);
      open->place = {name, in.line() - 1, 0};
    }
  }
}

struct Obj {
  Builder& out;
  std::vector<Vec3> points;
  std::vector<std::array<float, 2>> uvs;
  std::unordered_map<std::uint64_t, std::uint32_t> made;  ///< (point, uv) -> vertex; only looked up
  std::vector<std::uint32_t> plain;                       ///< the same without uv
  Materials materials;
  std::string name, material;
  bool part_open = false;
  std::vector<std::uint32_t> corners;

  /// Numbers count from 1, or back from the end when negative. Zero-based, or false.
  static bool resolve(std::string_view word, std::size_t count, std::uint32_t& index) {
    std::int64_t i = 0;
    if (!integer(word, i)) return false;
    if (i < 0) i += static_cast<std::int64_t>(count) + 1;
    if (i < 1 || i > static_cast<std::int64_t>(count)) return false;
    index = static_cast<std::uint32_t>(i - 1);
    return true;
  }

  Status face(Words& words, int line) {
    if (!out.wanted(name)) return {};
    if (!part_open) {
      const auto found = materials.find(material);
      out.begin_part(name, found == materials.end() ? Material{} : found->second);
      part_open = true;
    }
    corners.clear();
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      // point, point/uv, point/uv/normal or point//normal
      const std::size_t slash = word.find('/');
      const std::string_view first = word.substr(0, slash),
                             rest = slash == std::string_view::npos ? "" : word.substr(slash + 1),
                             second = rest.substr(0, rest.find('/'));
      std::uint32_t point = 0, uv = 0;
      const bool has_uv = !second.empty();
      if (!resolve(first, points.size(), point) || (has_uv && !resolve(second, uvs.size(), uv)))
        return out.error("face corner '" + std::string(word.substr(0, 40)) + "' names no vertex",
                         "there are " + std::to_string(points.size()) + " so far", line);
      constexpr std::uint32_t none = ~std::uint32_t{0};
      if (!has_uv) {
        plain.resize(points.size(), none);
        if (plain[point] == none) plain[point] = out.vertex(points[point]);
        corners.push_back(plain[point]);
        continue;
      }
      const auto [at, is_new] = made.try_emplace(std::uint64_t{point} << 32 | uv, 0);
      if (is_new) at->second = out.vertex(points[point], uvs[uv]);
      corners.push_back(at->second);
    }
    if (corners.size() < 3) return out.error("a face has three corners or more", "", line);
    return out.polygon(corners, line);
  }
};

}  // namespace

Status read_obj(std::string_view bytes, Builder& out, Diagnostics& diagnostics) {
  Obj obj{out};
  Words in(bytes);
  std::string_view line;
  std::string joined;
  std::set<std::string> libraries;  // already read
  while (true) {
    const int here = in.line();
    if (!in.next_line(line)) break;
    if (line.find('\0') != std::string_view::npos) return out.error("is not a text file", "", here);
    if (!line.empty() && line.back() == '\\') {  // goes on in the next line
      joined.clear();
      bool more = true;
      while (more && !line.empty() && line.back() == '\\') {
        joined.append(line.substr(0, line.size() - 1));
        joined += ' ';
        more = in.next_line(line);
      }
      if (more) joined.append(line);
      line = joined;
    }
    Words words(line);
    const std::string_view key = words.next();
    if (key == "v") {
      Vec3 p;
      for (std::size_t i = 0; i < 3; ++i)
        if (!number(words.next(), p[i])) return out.error("a vertex has three finite numbers", "", here);
      obj.points.push_back(p);
    } else if (key == "vt") {
      double u = 0, v = 0;
      if (!number(words.next(), u)) return out.error("a texture vertex has finite numbers", "", here);
      const std::string_view second = words.next();
      if (!second.empty() && !number(second, v))
        return out.error("a texture vertex has finite numbers", "", here);
      obj.uvs.push_back({static_cast<float>(u), static_cast<float>(v)});
    } else if (key == "f") {
      SL_TRY(obj.face(words, here));
    } else if (key == "o" || key == "g") {
      obj.name = rest_of(line, words);
      obj.part_open = false;
      out.note_name(obj.name);
    } else if (key == "usemtl") {
      obj.material = rest_of(line, words);
      obj.part_open = false;
      // Once for each: unknown ones become known as grey.
      if (obj.materials.try_emplace(obj.material).second)
        diagnostics.warn(
            out.error("material '" + obj.material.substr(0, 60) + "' is in no mtllib of the file",
                      "it is drawn grey", here));
    } else if (key == "mtllib") {
      const std::string file = rest_of(line, words);
      if (!libraries.insert(file).second) continue;  // some exporters name it before each part
      const auto text = out.read_beside(file, here);
      if (text) read_mtl(*text, beside(folder_of(out.path()), file), obj.materials);
      else diagnostics.warn(text.error());
    }
  }
  return {};
}

}  // namespace sandlot::assets::mesh
