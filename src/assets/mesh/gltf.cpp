#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "assets/mesh/reader.h"
#include "base/base64.h"

namespace sandlot::assets::mesh {
namespace {

using Json = nlohmann::json;

constexpr std::size_t max_json_bytes = std::size_t{64} << 20;

/// Members that are not there, or of another type, read as nothing: each use says what it needs.
const Json* member(const Json& from, const char* key) {
  if (!from.is_object()) return nullptr;
  const auto found = from.find(key);
  return found == from.end() ? nullptr : &*found;
}
const Json* element(const Json& document, const char* list, std::uint64_t index) {
  const Json* all = member(document, list);
  return all && all->is_array() && index < all->size() ? &(*all)[index] : nullptr;
}
bool unsigned_of(const Json& from, const char* key, std::uint64_t& out) {
  const Json* value = member(from, key);
  if (!value || !value->is_number_unsigned()) return false;
  out = value->get<std::uint64_t>();
  return true;
}
std::string text_of(const Json& from, const char* key) {
  const Json* value = member(from, key);
  return value && value->is_string() ? value->get<std::string>() : "";
}
/// Fills `out` from a list of as many finite numbers; false when there is something else.
template <std::size_t n>
bool numbers_of(const Json& from, const char* key, std::array<double, n>& out) {
  const Json* value = member(from, key);
  if (!value) return true;
  if (!value->is_array() || value->size() != n) return false;
  for (std::size_t i = 0; i < n; ++i) {
    if (!(*value)[i].is_number()) return false;
    out[i] = (*value)[i].get<double>();
    if (!std::isfinite(out[i])) return false;
  }
  return true;
}

/// Where the numbers of an accessor lie; checked to be inside the buffer.
struct Accessor {
  const char* data = nullptr;
  std::uint64_t count = 0, stride = 0, components = 0;
  int type = 0;
  bool normalized = false;

  double get(std::uint64_t i, std::uint64_t component) const {
    const auto read = [&]<class T>(T, double largest) {
      T value;
      std::memcpy(&value, data + i * stride + component * sizeof(T), sizeof(T));
      const auto x = static_cast<double>(value);
      return normalized ? std::max(-1.0, x / largest) : x;
    };
    switch (type) {
      case 5120: return read(std::int8_t{}, 127);
      case 5121: return read(std::uint8_t{}, 255);
      case 5122: return read(std::int16_t{}, 32767);
      case 5123: return read(std::uint16_t{}, 65535);
      case 5125: return read(std::uint32_t{}, 4294967295.0);
      default: return read(float{}, 1);
    }
  }
};

class GltfReader {
 public:
  GltfReader(const Json& document, std::string_view binary, Builder& out, Diagnostics& diagnostics)
      : json_(document), binary_(binary), out_(out), diagnostics_(diagnostics) {}

  Status read() {
    SL_TRY(check_version());
    SL_TRY(open_buffers());
    return walk();
  }

 private:
  Status check_version() {
    const Json* asset = member(json_, "asset");
    const std::string version = asset ? text_of(*asset, "version") : "";
    if (version.substr(0, 2) != "2.")
      return out_.error(version.empty() ? "is not a glTF file: it has no asset version"
                                        : "is glTF version " + version.substr(0, 20),
                        "version 2 is read");
    static constexpr std::string_view known[] = {"KHR_mesh_quantization", "KHR_texture_transform",
                                                 "KHR_lights_punctual", "KHR_materials_"};
    if (const Json* required = member(json_, "extensionsRequired"))
      for (const Json& each : *required) {
        const std::string name = each.is_string() ? each.get<std::string>() : "";
        bool fine = false;
        for (const std::string_view k : known) fine = fine || name.substr(0, k.size()) == k;
        if (!fine)
          return out_.error("needs the extension '" + name.substr(0, 60) + "', which is not known",
                            "export it again without compression");
      }
    return {};
  }

  Status open_buffers() {
    const Json* buffers = member(json_, "buffers");
    if (!buffers || !buffers->is_array()) return {};
    std::uint64_t total = 0;
    for (const Json& buffer : *buffers) {
      const std::string uri = text_of(buffer, "uri");
      std::string bytes;
      if (uri.empty()) {
        bytes = std::string(binary_);
      } else if (uri.substr(0, 5) == "data:") {
        const std::size_t comma = uri.find(";base64,");
        if (comma != std::string::npos)
          bytes = from_base64(std::string_view(uri).substr(comma + 8)).value_or("");
      } else {
        SL_ASSIGN(bytes, out_.read_beside(percent_decoded(uri)));
      }
      std::uint64_t length = 0;
      if (!unsigned_of(buffer, "byteLength", length) || length > bytes.size())
        return out_.error("a buffer has " + std::to_string(bytes.size()) + " bytes and should have " +
                              std::to_string(length),
                          "the file is cut off or damaged");
      total += bytes.size();
      if (total > out_.options().max_bytes) return out_.error("its buffers are too large together");
      buffers_.push_back(std::move(bytes));
    }
    return {};
  }

  Result<Accessor> accessor(std::uint64_t index, std::uint64_t components) {
    const auto bad = [&](const char* why) {
      return out_.error("accessor " + std::to_string(index) + " " + why, "the file is damaged");
    };
    const Json* a = element(json_, "accessors", index);
    if (!a) return bad("is not there");
    if (member(*a, "sparse")) return out_.error("has sparse accessors", "export it again without them");
    Accessor out;
    std::uint64_t view_index = 0, type = 0, offset = 0, view_offset = 0, length = 0, buffer = 0;
    if (!unsigned_of(*a, "bufferView", view_index) || !unsigned_of(*a, "count", out.count) ||
        !unsigned_of(*a, "componentType", type))
      return bad("is incomplete");
    unsigned_of(*a, "byteOffset", offset);
    const std::string shape = text_of(*a, "type");
    out.components = shape == "SCALAR" ? 1 : shape == "VEC2" ? 2 : shape == "VEC3" ? 3 : 0;
    if (out.components != components) return bad("has the wrong type");
    const std::uint64_t size = type == 5120 || type == 5121   ? 1
                               : type == 5122 || type == 5123 ? 2
                               : type == 5125 || type == 5126 ? 4
                                                              : 0;
    if (size == 0) return bad("has the wrong component type");
    out.type = static_cast<int>(type);
    const Json* normalized = member(*a, "normalized");
    out.normalized = normalized && normalized->is_boolean() && normalized->get<bool>();
    const Json* view = element(json_, "bufferViews", view_index);
    if (!view || !unsigned_of(*view, "buffer", buffer) || !unsigned_of(*view, "byteLength", length) ||
        buffer >= buffers_.size())
      return bad("has no buffer");
    unsigned_of(*view, "byteOffset", view_offset);
    out.stride = size * components;
    if (std::uint64_t stride = 0; unsigned_of(*view, "byteStride", stride)) {
      if (stride < out.stride || stride > 255) return bad("has the wrong stride");
      out.stride = stride;
    }
    const std::uint64_t have = buffers_[buffer].size();
    if (view_offset > have || length > have - view_offset || offset > length)
      return bad("lies outside its buffer");
    const std::uint64_t room = length - offset;
    if (out.count > 0 &&
        (room < size * components || (room - size * components) / out.stride < out.count - 1))
      return bad("lies outside its buffer");
    out.data = buffers_[buffer].data() + view_offset + offset;
    return out;
  }

  Material material_of(const Json& primitive) {
    Material out{.color = {1, 1, 1, 1}};
    std::uint64_t index = 0, texture = 0, source = 0;
    if (!unsigned_of(primitive, "material", index)) return out;
    const Json* material = element(json_, "materials", index);
    const Json* pbr = material ? member(*material, "pbrMetallicRoughness") : nullptr;
    if (!pbr) return out;
    std::array<double, 4> c{1, 1, 1, 1};
    if (numbers_of(*pbr, "baseColorFactor", c))
      out.color = {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2]),
                   static_cast<float>(c[3])};
    const Json* link = member(*pbr, "baseColorTexture");
    if (!link || !unsigned_of(*link, "index", texture)) return out;
    const Json* t = element(json_, "textures", texture);
    const Json* image = t && unsigned_of(*t, "source", source) ? element(json_, "images", source) : nullptr;
    if (!image) return out;
    const std::string uri = text_of(*image, "uri");
    if (!uri.empty() && uri.substr(0, 5) != "data:") out.texture = uri;
    else if (!said_embedded_) {
      diagnostics_.warn(out_.error("textures inside the file are not used", "keep them in files beside it"));
      said_embedded_ = true;
    }
    return out;
  }

  /// Every node once, parents first; a node that two others claim is an error, so there is no cycle.
  Status walk() {
    const Json* nodes = member(json_, "nodes");
    const std::uint64_t count = nodes && nodes->is_array() ? nodes->size() : 0;
    std::vector<bool> is_child(count), seen(count);
    const auto children = [&](std::uint64_t node, auto&& each) -> Status {
      const Json* list = member((*nodes)[node], "children");
      if (!list) return {};
      for (const Json& child : *list) {
        if (!child.is_number_unsigned() || child.get<std::uint64_t>() >= count)
          return out_.error("node " + std::to_string(node) + " has a child that is not there");
        each(child.get<std::uint64_t>());
      }
      return {};
    };
    for (std::uint64_t n = 0; n < count; ++n)
      SL_TRY(children(n, [&](std::uint64_t c) { is_child[c] = true; }));
    struct Visit {
      std::uint64_t node;
      Affine X;
    };
    std::vector<Visit> stack;
    const Affine up = out_.options().up == UpAxis::as_written ? Affine{}
                                                              : Affine{{1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0}};
    std::uint64_t scene_index = 0;
    unsigned_of(json_, "scene", scene_index);
    const Json* scene = element(json_, "scenes", scene_index);
    const Json* roots = scene ? member(*scene, "nodes") : nullptr;
    if (roots && roots->is_array()) {
      for (const Json& root : *roots) {
        if (!root.is_number_unsigned() || root.get<std::uint64_t>() >= count)
          return out_.error("the scene names a node that is not there");
        stack.push_back({root.get<std::uint64_t>(), up});
      }
    } else {
      for (std::uint64_t n = 0; n < count; ++n)
        if (!is_child[n]) stack.push_back({n, up});
    }
    std::reverse(stack.begin(), stack.end());
    while (!stack.empty()) {
      const Visit visit = stack.back();
      stack.pop_back();
      if (seen[visit.node]) return out_.error("node " + std::to_string(visit.node) + " has two parents");
      seen[visit.node] = true;
      const Json& node = (*nodes)[visit.node];
      Affine X;
      if (!transform_of(node, X))
        return out_.error("node " + std::to_string(visit.node) + " has no proper transform");
      X = visit.X * X;
      SL_TRY(read_node(node, X));
      const std::size_t before = stack.size();
      SL_TRY(children(visit.node, [&](std::uint64_t c) { stack.push_back({c, X}); }));
      std::reverse(stack.begin() + static_cast<std::ptrdiff_t>(before), stack.end());
    }
    return {};
  }

  static bool transform_of(const Json& node, Affine& X) {
    if (member(node, "matrix")) {
      std::array<double, 16> m{};  // column by column
      if (!numbers_of(node, "matrix", m)) return false;
      for (std::size_t row = 0; row < 3; ++row)
        for (std::size_t column = 0; column < 4; ++column) X.m[4 * row + column] = m[4 * column + row];
      return true;
    }
    std::array<double, 3> t{}, s{1, 1, 1};
    std::array<double, 4> q{0, 0, 0, 1};
    if (!numbers_of(node, "translation", t) || !numbers_of(node, "scale", s) ||
        !numbers_of(node, "rotation", q))
      return false;
    X = translation({t[0], t[1], t[2]}) * rotation(normalised(Quat{q[3], q[0], q[1], q[2]})) *
        scaling({s[0], s[1], s[2]});
    return true;
  }

  Status read_node(const Json& node, const Affine& X) {
    std::uint64_t index = 0;
    if (!unsigned_of(node, "mesh", index)) return {};
    const Json* mesh = element(json_, "meshes", index);
    if (!mesh) return out_.error("a node names a mesh that is not there");
    std::string name = text_of(node, "name");
    if (name.empty()) name = text_of(*mesh, "name");
    out_.note_name(name);
    const Json* primitives = member(*mesh, "primitives");
    if (!out_.wanted(name) || !primitives || !primitives->is_array()) return {};
    for (const Json& primitive : *primitives) SL_TRY(read_primitive(primitive, name, X));
    return {};
  }

  Status read_primitive(const Json& primitive, const std::string& name, const Affine& X) {
    std::uint64_t mode = 4, position = 0, index = 0;
    unsigned_of(primitive, "mode", mode);
    if (mode < 4 || mode > 6) return {};  // points and lines
    const Json* attributes = member(primitive, "attributes");
    if (!attributes || !unsigned_of(*attributes, "POSITION", position)) return {};
    SL_ASSIGN(const Accessor points, accessor(position, 3));
    Accessor uv, indices;
    bool has_uv = false;
    if (std::uint64_t at = 0; unsigned_of(*attributes, "TEXCOORD_0", at)) {
      SL_ASSIGN(uv, accessor(at, 2));
      has_uv = uv.count == points.count;
    }
    const bool has_indices = unsigned_of(primitive, "indices", index);
    if (has_indices) { SL_ASSIGN(indices, accessor(index, 1)); }
    const std::uint64_t n = has_indices ? indices.count : points.count;
    // Nodes may repeat a mesh: what they cost together is bounded like the triangles they make.
    work_ += points.count + n;
    SL_TRY(out_.check_count(work_ / 8));
    out_.begin_part(name, material_of(primitive));
    constexpr std::uint32_t none = ~std::uint32_t{0};
    std::vector<std::uint32_t> made(points.count, none);
    const auto corner = [&](std::uint64_t i, std::uint32_t& vertex) -> Status {
      const std::uint64_t k = has_indices ? static_cast<std::uint64_t>(std::max(0.0, indices.get(i, 0))) : i;
      if (k >= points.count)
        return out_.error("a triangle names vertex " + std::to_string(k) + " of " +
                          std::to_string(points.count));
      if (made[k] == none) {
        const Vec3 p{points.get(k, 0), points.get(k, 1), points.get(k, 2)};
        if (!is_finite(p)) return out_.error("vertex " + std::to_string(k) + " is not a number");
        std::array<float, 2> at{};  // v runs downwards in the file
        if (has_uv) at = {static_cast<float>(uv.get(k, 0)), static_cast<float>(1 - uv.get(k, 1))};
        made[k] = out_.vertex(X * p, at);
      }
      vertex = made[k];
      return {};
    };
    const bool turn = X.mirrors();
    for (std::uint64_t t = 0; n >= 3 && t < (mode == 4 ? n / 3 : n - 2); ++t) {
      const bool odd = mode == 5 && t % 2 == 1;
      const std::array<std::uint64_t, 3> at = mode == 4   ? std::array{3 * t, 3 * t + 1, 3 * t + 2}
                                              : mode == 6 ? std::array{std::uint64_t{0}, t + 1, t + 2}
                                              : odd       ? std::array{t + 1, t, t + 2}
                                                          : std::array{t, t + 1, t + 2};
      std::array<std::uint32_t, 3> c{};
      for (std::size_t i = 0; i < 3; ++i) SL_TRY(corner(at[i], c[i]));
      if (turn) std::swap(c[1], c[2]);
      SL_TRY(out_.triangle(c[0], c[1], c[2]));
    }
    return {};
  }

  const Json& json_;
  std::string_view binary_;
  Builder& out_;
  Diagnostics& diagnostics_;
  std::vector<std::string> buffers_;
  std::uint64_t work_ = 0;
  bool said_embedded_ = false;
};

}  // namespace

Status read_gltf(std::string_view bytes, Builder& out, Diagnostics& diagnostics) {
  std::string_view text = bytes, binary;
  if (bytes.substr(0, 4) == "glTF") {
    Bytes in(bytes);
    if (!in.has(12)) return out.truncated();
    in.skip(4);
    const auto version = in.get<std::uint32_t>(), length = in.get<std::uint32_t>();
    if (version != 2) return out.error("is GLB version " + std::to_string(version), "version 2 is read");
    if (length > bytes.size()) return out.truncated();
    text = {};
    while (in.has(8)) {
      const auto size = in.get<std::uint32_t>(), type = in.get<std::uint32_t>();
      if (!in.has(size)) return out.truncated();
      const std::string_view chunk = bytes.substr(in.at(), size);
      in.skip(size);
      if (type == 0x4E4F534A && text.empty()) text = chunk;      // "JSON"
      if (type == 0x004E4942 && binary.empty()) binary = chunk;  // "BIN"
    }
  }
  if (text.size() > max_json_bytes)
    return out.error("its JSON part is too large", "keep buffers in a .bin file");
  const Json document = Json::parse(text, nullptr, false);
  if (document.is_discarded() || !document.is_object())
    return out.error("is not a glTF file: its JSON part is broken", "the file is cut off or damaged");
  return GltfReader(document, binary, out, diagnostics).read();
}

}  // namespace sandlot::assets::mesh
