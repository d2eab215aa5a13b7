#include <cctype>

#include "assets/mesh/reader.h"

namespace sandlot::assets::mesh {
namespace {

constexpr std::size_t header_bytes = 84, triangle_bytes = 50;

std::string lower(std::string_view word) {
  std::string out(word);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

Status read_binary(std::string_view bytes, std::uint32_t count, Builder& out) {
  SL_TRY(out.check_count(count));
  if ((bytes.size() - header_bytes) / triangle_bytes < count)
    return out.error("ends too early: it should have " + std::to_string(count) + " triangles and has " +
                         std::to_string((bytes.size() - header_bytes) / triangle_bytes),
                     "the file is cut off or damaged");
  out.begin_part("", {});
  Bytes in(bytes.substr(header_bytes));
  for (std::uint32_t t = 0; t < count; ++t) {
    in.skip(12);  // the normal follows from the corners
    std::array<std::uint32_t, 3> corners{};
    for (std::uint32_t& corner : corners) {
      const auto x = in.get<float>(), y = in.get<float>(), z = in.get<float>();
      const Vec3 p{x, y, z};
      if (!is_finite(p))
        return out.error("triangle " + std::to_string(t) + " has a corner that is not a number");
      corner = out.vertex(p);
    }
    in.skip(2);
    SL_TRY(out.triangle(corners[0], corners[1], corners[2]));
  }
  return {};
}

Status read_ascii(std::string_view bytes, Builder& out) {
  Words in(bytes);
  std::string_view line;
  std::array<std::uint32_t, 3> corners{};
  int count = -1;  // corners of the open facet
  bool in_solid = false;
  while (true) {
    const int here = in.line();
    if (!in.next_line(line)) break;
    Words words(line);
    const std::string word = lower(words.next());
    if (word == "solid") {
      in_solid = true;
      std::string name;
      for (std::string_view w = words.next(); !w.empty(); w = words.next())
        name += (name.empty() ? "" : " ") + std::string(w);
      out.begin_part(name, {});
    } else if (word == "facet") {
      count = 0;
    } else if (word == "vertex") {
      Vec3 p;
      for (std::size_t i = 0; i < 3; ++i)
        if (!number(words.next(), p[i])) return out.error("a vertex has three finite numbers", "", here);
      if (count < 0 || count > 2) return out.error("a facet has three vertices", "", here);
      corners[static_cast<std::size_t>(count++)] = out.vertex(p);
    } else if (word == "endfacet") {
      if (count != 3) return out.error("a facet has three vertices", "", here);
      SL_TRY(out.triangle(corners[0], corners[1], corners[2], here));
      count = -1;
    } else if (word == "endsolid") {
      in_solid = false;
    } else if (!word.empty() && word != "outer" && word != "endloop") {
      return out.error("'" + word.substr(0, 40) + "' is not a word of an STL file", "is the file damaged?",
                       here);
    }
  }
  if (in_solid) return out.truncated();
  return {};
}

}  // namespace

Status read_stl(std::string_view bytes, Builder& out) {
  // Binary files may begin with "solid" too. Their size tells them apart; a cut off one has bytes that no text has.
  const bool solid = lower(bytes.substr(0, 5)) == "solid";
  if (bytes.size() >= header_bytes) {
    Bytes in(bytes.substr(80));
    const auto count = in.get<std::uint32_t>();
    const bool fits = bytes.size() == header_bytes + std::uint64_t{count} * triangle_bytes;
    const bool text = solid && bytes.find('\0') == std::string_view::npos;
    if (fits || !text) return read_binary(bytes, count, out);
  } else if (!solid) {
    return out.error("is not a STL file", "an STL file begins with 'solid' or has a header of 84 bytes");
  }
  return read_ascii(bytes, out);
}

}  // namespace sandlot::assets::mesh
