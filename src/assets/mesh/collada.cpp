#include <algorithm>
#include <map>
#include <unordered_map>

#include "assets/mesh/reader.h"
#include "base/math.h"
#include "files/xml.h"

namespace sandlot::assets::mesh {
namespace {

/// The tree and its numbers take several times the space of the text.
constexpr std::size_t max_xml_bytes = std::size_t{128} << 20;

/// "#id" as it stands in url and source attributes; links into other files are not followed.
std::string target(const Xml& from, std::string_view attribute) {
  const std::string* value = from.attribute(attribute);
  return value && !value->empty() && value->front() == '#' ? value->substr(1) : "";
}
std::string value_of(const Xml& from, std::string_view attribute) {
  const std::string* value = from.attribute(attribute);
  return value ? *value : "";
}
/// The element at the end of a path of names, or null.
const Xml* down(const Xml* from, std::initializer_list<std::string_view> names) {
  for (const std::string_view name : names) from = from ? from->child(name) : nullptr;
  return from;
}

/// The numbers of a source and how a reader steps through them.
struct Source {
  std::vector<double> values;
  std::size_t offset = 0, stride = 1, count = 0;
};

struct Inputs {
  const Source* points = nullptr;
  const Source* uv = nullptr;
  std::size_t point_offset = 0, uv_offset = 0, stride = 1;
};

class Reader {
 public:
  Reader(const Xml& root, Builder& out, Diagnostics& diagnostics)
      : root_(root), out_(out), diagnostics_(diagnostics) {
    index(root);
  }

  Status read() {
    if (root_.name != "COLLADA")
      return root_.error("the root element is <" + root_.name.substr(0, 40) + ">, not <COLLADA>");
    SL_ASSIGN(const Affine X, asset());
    const Xml* scene = nullptr;
    if (const Xml* instance = down(&root_, {"scene", "instance_visual_scene"}))
      scene = find(*instance, "url", "visual_scene");
    if (!scene) scene = down(&root_, {"library_visual_scenes", "visual_scene"});
    if (scene) {
      for (const Xml& node : scene->children)
        if (node.name == "node") SL_TRY(read_node(node, X, 0));
      return {};
    }
    // Without a scene: every geometry as it is.
    if (const Xml* library = root_.child("library_geometries"))
      for (const Xml& geometry : library->children)
        if (geometry.name == "geometry")
          SL_TRY(read_geometry(geometry, geometry, value_of(geometry, "name"), X));
    return {};
  }

 private:
  void index(const Xml& element) {
    if (const std::string* id = element.attribute("id")) ids_.try_emplace(*id, &element);
    for (const Xml& child : element.children) index(child);
  }
  const Xml* find(const Xml& from, std::string_view attribute, std::string_view name) const {
    const auto found = ids_.find(target(from, attribute));
    return found != ids_.end() && found->second->name == name ? found->second : nullptr;
  }

  Result<Affine> asset() {
    Affine X;
    if (const Xml* unit = down(&root_, {"asset", "unit"})) {
      double meter = 1;
      const std::string* text = unit->attribute("meter");
      if (text && (!number(*text, meter) || !(meter > 0)))
        return unit->error("meter='" + text->substr(0, 40) + "' is not a length",
                           "give a positive number of metres");
      X = scaling({meter, meter, meter});
    }
    const Xml* up = down(&root_, {"asset", "up_axis"});
    const std::string axis = up ? up->text : "Y_UP";
    if (out_.options().up == UpAxis::declared) {
      if (axis == "Y_UP") X = Affine{{1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0}} * X;
      if (axis == "X_UP") X = Affine{{0, -1, 0, 0, 0, 0, -1, 0, 1, 0, 0, 0}} * X;
    } else if (up && axis != "Z_UP") {
      diagnostics_.warn(
          up->error("<up_axis> " + axis.substr(0, 20) + " is not applied, as Gazebo does not either",
                    "turn the visual or collision by its <pose> if it lies on its side"));
    }
    return X;
  }

  Status numbers_in(const Xml& element, std::vector<double>& out) {
    Words words(element.text);
    double value = 0;
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      if (!number(word, value))
        return element.error("<" + element.name + ">: '" + std::string(word.substr(0, 40)) +
                             "' is not a finite number");
      out.push_back(value);
    }
    return {};
  }
  Status indices_in(const Xml& element, std::vector<std::uint32_t>& out) {
    out.clear();
    Words words(element.text);
    std::int64_t value = 0;
    for (std::string_view word = words.next(); !word.empty(); word = words.next()) {
      if (!integer(word, value) || value < 0 || value > 0x7FFFFFFF)
        return element.error("<" + element.name + ">: '" + std::string(word.substr(0, 40)) +
                             "' is not an index");
      out.push_back(static_cast<std::uint32_t>(value));
    }
    work_ += out.size();
    return out_.check_count(work_ / 32, element.place.line);
  }

  Result<Affine> transform_of(const Xml& node) {
    Affine X;
    for (const Xml& step : node.children) {
      const std::size_t wanted = step.name == "matrix"                              ? 16
                                 : step.name == "rotate"                            ? 4
                                 : step.name == "translate" || step.name == "scale" ? 3
                                                                                    : 0;
      if ((step.name == "lookat" || step.name == "skew") && !std::exchange(said_step_, true))
        diagnostics_.warn(step.error("<" + step.name + "> is not used", "apply transforms before exporting"));
      if (wanted == 0) continue;
      std::vector<double> v;
      SL_TRY(numbers_in(step, v));
      if (v.size() != wanted)
        return step.error("<" + step.name + "> has " + std::to_string(v.size()) + " numbers",
                          std::to_string(wanted) + " are needed");
      if (wanted == 16) {
        Affine m;
        std::copy_n(v.begin(), 12, m.m.begin());
        X = X * m;
      } else if (wanted == 4) {
        X = X * rotation(quat_from_axis_angle(normalised(Vec3{v[0], v[1], v[2]}), v[3] * math::pi / 180));
      } else {
        X = X * (step.name == "scale" ? scaling({v[0], v[1], v[2]}) : translation({v[0], v[1], v[2]}));
      }
    }
    return X;
  }

  Status read_node(const Xml& node, const Affine& X_parent, int depth) {
    if (depth > 200)
      return node.error("nodes are nested too deeply", "do they instance each other in a circle?");
    if (++visits_ > 1'000'000) return node.error("nodes instance each other too often");
    SL_ASSIGN(const Affine own, transform_of(node));
    const Affine X = X_parent * own;
    std::string name = value_of(node, "name");
    if (name.empty()) name = value_of(node, "id");
    for (const Xml& child : node.children) {
      if (child.name == "node") {
        SL_TRY(read_node(child, X, depth + 1));
      } else if (child.name == "instance_node") {
        const Xml* other = find(child, "url", "node");
        if (!other) return child.error("names a node that is not there");
        SL_TRY(read_node(*other, X, depth + 1));
      } else if (child.name == "instance_geometry" || child.name == "instance_controller") {
        const Xml* geometry = find(child, "url", "geometry");
        if (const Xml* controller = find(child, "url", "controller"))
          if (const Xml* skin = controller->child("skin")) geometry = find(*skin, "source", "geometry");
        if (!geometry) return child.error("names a geometry that is not there");
        SL_TRY(read_geometry(*geometry, child, name.empty() ? value_of(*geometry, "name") : name, X));
      }
    }
    return {};
  }

  Material material_of(const std::string& symbol, const Xml& instance) {
    Material out;
    const Xml* material = nullptr;
    if (const Xml* bind = down(&instance, {"bind_material", "technique_common"}))
      for (const Xml& each : bind->children)
        if (each.name == "instance_material" && value_of(each, "symbol") == symbol)
          material = find(each, "target", "material");
    if (!material)
      if (const auto found = ids_.find(symbol); found != ids_.end() && found->second->name == "material")
        material = found->second;
    const Xml* link = material ? material->child("instance_effect") : nullptr;
    const Xml* effect = link ? find(*link, "url", "effect") : nullptr;
    const Xml* profile = effect ? effect->child("profile_COMMON") : nullptr;
    const Xml* technique = profile ? profile->child("technique") : nullptr;
    if (!technique) return out;
    const Xml* diffuse = nullptr;
    for (const std::string_view shading : {"phong", "lambert", "blinn", "constant"})
      if (!diffuse)
        if (const Xml* s = technique->child(shading)) diffuse = s->child("diffuse");
    if (!diffuse) return out;
    out.color = {1, 1, 1, 1};
    if (const Xml* color = diffuse->child("color")) {
      std::vector<double> c;
      if (numbers_in(*color, c) && c.size() >= 3)
        out.color = {static_cast<float>(c[0]), static_cast<float>(c[1]), static_cast<float>(c[2]),
                     c.size() > 3 ? static_cast<float>(c[3]) : 1.0f};
    }
    if (const Xml* texture = diffuse->child("texture"))
      if (const Xml* file = image_of(*profile, value_of(*texture, "texture")))
        out.texture = file->text, out.place = file->place;
    return out;
  }

  /// texture -> sampler -> surface -> image, or the image at once: the element that names its file, or null.
  const Xml* image_of(const Xml& profile, std::string name) {
    const auto parameter = [&](const std::string& sid) -> const Xml* {
      for (const Xml& each : profile.children)
        if (each.name == "newparam" && value_of(each, "sid") == sid) return &each;
      return nullptr;
    };
    if (const Xml* sampler = parameter(name))
      if (const Xml* source = down(sampler, {"sampler2D", "source"})) name = source->text;
    if (const Xml* surface = parameter(name))
      if (const Xml* init = down(surface, {"surface", "init_from"})) name = init->text;
    const auto image = ids_.find(name);
    if (image == ids_.end() || image->second->name != "image") return nullptr;
    const Xml* file = image->second->child("init_from");
    if (file && file->child("ref")) file = file->child("ref");
    return file;
  }

  /// Null with the reason as an error.
  Result<const Source*> source(const Xml& input) {
    const Xml* element = find(input, "source", "source");
    if (!element) return input.error("names a source that is not there");
    const auto [at, is_new] = sources_.try_emplace(element);
    Source& s = at->second;
    if (!is_new) return static_cast<const Source*>(&s);
    const Xml* array = element->child("float_array");
    const Xml* accessor = down(element, {"technique_common", "accessor"});
    if (!array || !accessor) return element->error("the source has no <float_array> or no <accessor>");
    SL_TRY(numbers_in(*array, s.values));
    const auto read = [&](const char* key, std::size_t otherwise, std::size_t& out) {
      std::int64_t value = static_cast<std::int64_t>(otherwise);
      const std::string* text = accessor->attribute(key);
      if (text && (!integer(*text, value) || value < 0 || value > 0x7FFFFFFF)) return false;
      return out = static_cast<std::size_t>(value), true;
    };
    std::size_t count = 0;
    if (!read("count", 0, count) || !read("offset", 0, s.offset) || !read("stride", 1, s.stride) ||
        s.stride == 0)
      return accessor->error("<accessor> has a count, offset or stride that is not a number");
    s.count = s.values.size() > s.offset ? (s.values.size() - s.offset) / s.stride : 0;
    if (count > s.count)
      return accessor->error("<accessor> wants " + std::to_string(count) + " x " + std::to_string(s.stride) +
                                 " numbers, there are " + std::to_string(s.values.size()),
                             "the file is damaged");
    return static_cast<const Source*>(&s);
  }

  Result<Inputs> inputs_of(const Xml& primitive) {
    Inputs out;
    const auto use_uv = [&](const Xml& input, std::size_t offset) -> Status {
      if (out.uv || value_of(input, "semantic") != "TEXCOORD") return {};
      SL_ASSIGN(out.uv, source(input));
      out.uv_offset = offset;
      if (out.uv->stride < 2) out.uv = nullptr;
      return {};
    };
    for (const Xml& input : primitive.children) {
      if (input.name != "input") continue;
      std::int64_t offset = 0;
      const std::string text = value_of(input, "offset");
      if (!text.empty() && (!integer(text, offset) || offset < 0 || offset > 64))
        return input.error("offset='" + text.substr(0, 40) + "' is not a small number");
      const auto at = static_cast<std::size_t>(offset);
      out.stride = std::max(out.stride, at + 1);
      SL_TRY(use_uv(input, at));
      if (value_of(input, "semantic") != "VERTEX") continue;
      const Xml* vertices = find(input, "source", "vertices");
      if (!vertices) return input.error("names vertices that are not there");
      out.point_offset = at;
      for (const Xml& each : vertices->children) {
        if (value_of(each, "semantic") == "POSITION") {
          SL_ASSIGN(out.points, source(each));
          if (out.points->stride < 3) return each.error("positions have three numbers");
        }
        SL_TRY(use_uv(each, at));
      }
    }
    if (!out.points) return primitive.error("<" + primitive.name + "> has no positions");
    return out;
  }

  Status read_geometry(const Xml& geometry, const Xml& instance, const std::string& name, const Affine& X) {
    out_.note_name(name);
    const Xml* mesh = geometry.child("mesh");
    if (!mesh || !out_.wanted(name)) return {};
    for (const Xml& each : mesh->children) {
      const bool known = each.name == "triangles" || each.name == "polylist" || each.name == "polygons" ||
                         each.name == "tristrips" || each.name == "trifans";
      if (!known) continue;
      SL_ASSIGN(const Inputs inputs, inputs_of(each));
      out_.begin_part(name, material_of(value_of(each, "material"), instance));
      SL_TRY(read_primitive(each, inputs, X));
    }
    return {};
  }

  Status read_primitive(const Xml& primitive, const Inputs& inputs, const Affine& X) {
    std::unordered_map<std::uint64_t, std::uint32_t> made;  // only looked up
    std::vector<std::uint32_t> p, vcount, corners;
    const bool turn = X.mirrors();
    const int line = primitive.place.line;
    const auto corner = [&](std::size_t i) -> Status {
      const std::uint32_t point = p[i * inputs.stride + inputs.point_offset];
      const std::uint32_t uv = inputs.uv ? p[i * inputs.stride + inputs.uv_offset] : 0;
      if (point >= inputs.points->count || (inputs.uv && uv >= inputs.uv->count))
        return primitive.error("<" + primitive.name + "> names vertex " + std::to_string(point) + " of " +
                               std::to_string(inputs.points->count));
      const auto [at, is_new] = made.try_emplace(std::uint64_t{point} << 32 | uv, 0);
      if (is_new) {
        const double* v = inputs.points->values.data() + inputs.points->offset +
                          point * inputs.points->stride;
        std::array<float, 2> t{};
        if (inputs.uv) {
          const double* u = inputs.uv->values.data() + inputs.uv->offset + uv * inputs.uv->stride;
          t = {static_cast<float>(u[0]), static_cast<float>(u[1])};
        }
        at->second = out_.vertex(X * Vec3{v[0], v[1], v[2]}, t);
      }
      corners.push_back(at->second);
      return {};
    };
    const auto face = [&](std::initializer_list<std::size_t> which) -> Status {
      corners.clear();
      for (const std::size_t i : which) SL_TRY(corner(i));
      if (turn) std::swap(corners[1], corners[2]);
      return out_.triangle(corners[0], corners[1], corners[2], line);
    };
    const auto polygon = [&](std::size_t first, std::size_t count) -> Status {
      if (count < 3) return {};
      corners.clear();
      for (std::size_t i = 0; i < count; ++i) SL_TRY(corner(first + i));
      if (turn) std::reverse(corners.begin() + 1, corners.end());  // the same diagonals
      return out_.polygon(corners, line);
    };
    if (const Xml* counts = primitive.child("vcount")) SL_TRY(indices_in(*counts, vcount));
    for (const Xml& child : primitive.children) {
      const Xml* list = child.name == "p" ? &child : child.name == "ph" ? child.child("p") : nullptr;
      if (!list) continue;
      SL_TRY(indices_in(*list, p));
      const std::size_t n = p.size() / inputs.stride;
      if (primitive.name == "triangles") {
        for (std::size_t t = 0; t + 2 < n; t += 3) SL_TRY(face({t, t + 1, t + 2}));
      } else if (primitive.name == "polygons") {
        SL_TRY(polygon(0, n));
      } else if (primitive.name == "polylist") {
        std::size_t first = 0;
        for (const std::uint32_t count : vcount) {
          if (count > n - first) return list->error("<p> ends before the polygons that <vcount> announces");
          SL_TRY(polygon(first, count));
          first += count;
        }
      } else {
        for (std::size_t t = 0; t + 2 < n; ++t)
          SL_TRY(primitive.name == "trifans" ? face({0, t + 1, t + 2})
                 : t % 2 == 1                ? face({t + 1, t, t + 2})
                                             : face({t, t + 1, t + 2}));
      }
    }
    return {};
  }

  const Xml& root_;
  Builder& out_;
  Diagnostics& diagnostics_;
  std::map<std::string, const Xml*, std::less<>> ids_;
  std::map<const Xml*, Source> sources_;  // found by address, never walked through
  std::uint64_t work_ = 0, visits_ = 0;
  bool said_step_ = false;
};

}  // namespace

Status read_collada(std::string_view bytes, Builder& out, Diagnostics& diagnostics) {
  SL_ASSIGN(const Xml root,
            parse_xml(bytes, out.path(),
                      {.max_bytes = std::min(out.options().max_bytes, max_xml_bytes), .max_depth = 256}));
  return Reader(root, out, diagnostics).read();
}

}  // namespace sandlot::assets::mesh
