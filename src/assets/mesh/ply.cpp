#include <algorithm>
#include <bit>

#include "assets/mesh/reader.h"

namespace sandlot::assets::mesh {
namespace {

enum class Type { i8, u8, i16, u16, i32, u32, f32, f64 };

struct Property {
  std::string name;
  Type type{};
  bool is_list = false;
  Type count_type{};
};
struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

bool type_of(std::string_view word, Type& out) {
  static constexpr std::pair<std::string_view, Type> names[] = {
      {"char", Type::i8},   {"int8", Type::i8},     {"uchar", Type::u8},   {"uint8", Type::u8},
      {"short", Type::i16}, {"int16", Type::i16},   {"ushort", Type::u16}, {"uint16", Type::u16},
      {"int", Type::i32},   {"int32", Type::i32},   {"uint", Type::u32},   {"uint32", Type::u32},
      {"float", Type::f32}, {"float32", Type::f32}, {"double", Type::f64}, {"float64", Type::f64}};
  for (const auto& [name, type] : names)
    if (name == word) return out = type, true;
  return false;
}
std::size_t size_of(Type type) {
  static constexpr std::size_t sizes[] = {1, 1, 2, 2, 4, 4, 4, 8};
  return sizes[static_cast<std::size_t>(type)];
}

/// One value after the other, whatever the encoding.
class Values {
 public:
  Values(std::string_view body, int line, bool ascii, bool big_endian)
      : words_(body), bytes_(body), line_(line), ascii_(ascii), big_endian_(big_endian) {}
  int line() const { return ascii_ ? line_ + words_.line() - 1 : 0; }

  bool get(Type type, double& out) {
    if (ascii_) return number(words_.next(), out);
    const std::size_t size = size_of(type);
    if (!bytes_.has(size)) return false;
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i)
      bits |= std::uint64_t{bytes_.get<std::uint8_t>()} << 8 * (big_endian_ ? size - 1 - i : i);
    switch (type) {
      case Type::i8: out = static_cast<std::int8_t>(bits); break;
      case Type::i16: out = static_cast<std::int16_t>(bits); break;
      case Type::i32: out = static_cast<std::int32_t>(bits); break;
      case Type::f32: out = std::bit_cast<float>(static_cast<std::uint32_t>(bits)); break;
      case Type::f64: out = std::bit_cast<double>(bits); break;
      default: out = static_cast<double>(bits);
    }
    return true;
  }

 private:
  Words words_;
  Bytes bytes_;
  int line_;
  bool ascii_, big_endian_;
};

struct Header {
  std::vector<Element> elements;
  bool ascii = true, big_endian = false;
};

Status read_header(Words& in, Header& header, const Builder& out) {
  std::string_view line;
  if (!in.next_line(line) || line != "ply") return out.error("is not a PLY file", "", 1);
  while (true) {
    const int here = in.line();
    const auto bad = [&] {
      return out.error("'" + std::string(line.substr(0, 60)) + "' is not understood", "", here);
    };
    if (!in.next_line(line)) return out.truncated();
    Words words(line);
    const std::string_view key = words.next();
    if (key == "end_header") return {};
    if (key == "format") {
      const std::string_view format = words.next();
      header.ascii = format == "ascii";
      header.big_endian = format == "binary_big_endian";
      if (!header.ascii && !header.big_endian && format != "binary_little_endian") return bad();
    } else if (key == "element") {
      Element element{std::string(words.next())};
      std::int64_t count = 0;
      if (!integer(words.next(), count) || count < 0) return bad();
      element.count = static_cast<std::uint64_t>(count);
      header.elements.push_back(std::move(element));
    } else if (key == "property") {
      Property property;
      std::string_view type = words.next();
      property.is_list = type == "list";
      if (property.is_list) {
        if (!type_of(words.next(), property.count_type)) return bad();
        type = words.next();
      }
      if (!type_of(type, property.type) || header.elements.empty()) return bad();
      property.name = std::string(words.next());
      header.elements.back().properties.push_back(std::move(property));
    } else if (key != "comment" && key != "obj_info") {
      return bad();
    }
  }
}

}  // namespace

Status read_ply(std::string_view bytes, Builder& out) {
  Words in(bytes);
  Header header;
  SL_TRY(read_header(in, header, out));
  const std::string_view body = bytes.substr(std::min(in.at(), bytes.size()));
  Values values(body, in.line(), header.ascii, header.big_endian);
  std::uint32_t vertices = 0;
  out.begin_part("", {});
  std::vector<std::uint32_t> corners;
  for (const Element& element : header.elements) {
    const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
    // A value has one byte at least, so the file's size bounds the loops; elements without properties have none.
    if (element.properties.empty()) continue;
    if (element.count > body.size()) return out.truncated();
    if (is_face) SL_TRY(out.check_count(element.count));
    for (std::uint64_t i = 0; i < element.count; ++i) {
      Vec3 p;
      std::array<float, 2> uv{};
      corners.clear();
      for (const Property& property : element.properties) {
        double n = 1, value = 0;
        if (property.is_list && !values.get(property.count_type, n)) return out.truncated();
        if (!(n >= 0 && n <= static_cast<double>(body.size())))
          return out.error("a list is too long", "", values.line());
        const bool is_corners = is_face && property.is_list &&
                                (property.name == "vertex_indices" || property.name == "vertex_index");
        for (std::uint64_t k = 0; k < static_cast<std::uint64_t>(n); ++k) {
          if (!values.get(property.type, value)) return out.truncated();
          if (is_corners) {
            if (!(value >= 0 && value < vertices))
              return out.error("a face names a vertex that is not there",
                               "there are " + std::to_string(vertices), values.line());
            corners.push_back(static_cast<std::uint32_t>(value));
          }
        }
        if (!is_vertex || property.is_list) continue;
        if (property.name == "x") p.x = value;
        else if (property.name == "y") p.y = value;
        else if (property.name == "z") p.z = value;
        else if (property.name == "s" || property.name == "u") uv[0] = static_cast<float>(value);
        else if (property.name == "t" || property.name == "v") uv[1] = static_cast<float>(value);
      }
      if (is_vertex) {
        if (!is_finite(p))
          return out.error("vertex " + std::to_string(i) + " is not a number", "", values.line());
        out.vertex(p, uv);
        ++vertices;
      } else if (is_face && corners.size() > 2) {
        SL_TRY(out.polygon(corners, values.line()));
      }
    }
  }
  return {};
}

}  // namespace sandlot::assets::mesh
