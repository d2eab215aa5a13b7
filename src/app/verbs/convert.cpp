/// `sandlot convert IN OUT`: files of robots, worlds and scenarios into each other.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>

#include "app/commands.h"
#include "base/atomic_file.h"
#include "base/text.h"
#include "files/text.h"
#include "files/yaml.h"
#include "formats/kind.h"
#include "formats/sdf/write.h"
#include "geometry/height_grid.h"
#include "geometry/mesh.h"
#include "sim/load/load.h"

namespace sandlot::app {
namespace {

namespace fs = std::filesystem;

bool is_builder(const std::string& path) { return starts_with(path, "builder:"); }

/// The format of a file to read or to write.
Result<const formats::FormatKind*> format_of(const std::string& path) {
  if (const formats::FormatKind* const format = formats::find_format(path)) return format;
  return Error{"'" + path + "' has no known extension", "convert knows " + formats::known_extensions()};
}

/// A path written in `file_folder`, as one that means the same file when written in `new_folder`.
std::string moved(const std::string& uri, const std::string& file_folder, const std::string& new_folder,
                  const SearchPath& search) {
  const auto there = find_resource(uri, file_folder, search, {});
  if (!there) return uri;  // the reader has said that already
  const auto here = find_resource(uri, new_folder, search, {});
  if (here && canonical_path(*here) == canonical_path(*there)) return uri;
  std::error_code failed;
  const std::string target = canonical_path(*there);
  const fs::path relative = fs::relative(target, fs::absolute(new_folder.empty() ? "." : new_folder), failed);
  return failed || relative.empty() ? target : relative.string();
}

struct Mover {
  std::string new_folder;
  const SearchPath& search;

  /// Where an element without a file of its own was written from: the working folder.
  void operator()(Xml& element, const std::string& parent = "") const {
    const std::string from = element.place.file ? folder_of(*element.place.file) : "";
    const bool is_map = element.name.size() > 4 && element.name.substr(element.name.size() - 4) == "_map";
    const bool names_file = (element.name == "uri" && (parent == "mesh" || parent == "heightmap")) ||
                            (is_map && (parent == "metal" || parent == "specular")) ||
                            ((element.name == "diffuse" || element.name == "normal") &&
                             parent == "texture") ||
                            (element.name == "parameters" && parent == "plugin");
    if (names_file && !element.text.empty()) element.text = moved(element.text, from, new_folder, search);
    if (element.name == "mesh" || element.name == "texture")
      if (const std::string* const file = element.attribute("filename"))
        element.set_attribute("filename", moved(*file, from, new_folder, search));
    for (Xml& child : element.children) (*this)(child, element.name);
  }
};

/// A file that the written one names.
struct Beside {
  std::string path, text;
};

std::string obj_text(const TriangleMesh& mesh, const std::string& comment) {
  std::string out = "# " + comment + "\n";
  for (const Vec3& v : mesh.vertices)
    out += "v " + number_text(v.x) + " " + number_text(v.y) + " " + number_text(v.z) + "\n";
  for (const auto& t : mesh.triangles) out += fmt::format("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1);
  return out;
}

struct Job {
  const ConvertOptions& options;
  const formats::FormatKind* from;  ///< null for a builder
  const formats::FormatKind& to;
  SearchPath search;
  Diagnostics& diagnostics;
  std::vector<Beside>& beside;

  std::string comment() const {
    return "Made by sandlot convert from " + fs::path(options.in).filename().string() + ".";
  }

  /// Terrain that a builder made has no file that could be named: it becomes a mesh with the same triangles.
  void give_terrain_a_file(model::Instance& instance) const {
    const std::size_t known = beside.size();
    const auto changed = std::make_shared<model::Model>(*instance.model);
    for (model::Link& link : changed->links) {
      const HeightGrid* grid =
          nullptr;  // of the link's shapes so far: what is seen is mostly what is touched
      std::shared_ptr<const TriangleMesh> mesh;
      const auto give = [&](Shape& shape) {
        const auto* const ground = std::get_if<Heightfield>(&shape);
        if (!ground || !ground->grid->source.empty()) return;
        if (grid != ground->grid.get()) {
          grid = ground->grid.get();
          TriangleMesh made = tessellate(shape);
          const fs::path out = options.out;
          made.source = out.stem().string() + "_" + std::to_string(beside.size() + 1) + ".obj";
          beside.push_back({(out.parent_path() / made.source).string(), obj_text(made, comment())});
          mesh = std::make_shared<const TriangleMesh>(std::move(made));
        }
        shape = Mesh{mesh};
      };
      for (model::Collision& collision : link.collisions) give(collision.shape);
      for (model::Visual& visual : link.visuals) give(visual.shape);
    }
    if (beside.size() > known) instance.model = changed;
  }

  /// The document itself, with includes resolved and URDF translated: nothing of it is lost.
  Result<std::string> tree_to_sdf() const {
    const formats::ReadOptions reading{.path = search};
    SL_ASSIGN(const std::string text, read_text_file(options.in, from->max_bytes));
    SL_ASSIGN([[maybe_unused]] const formats::WorldContent content,
              from->world(text, options.in, reading, diagnostics));
    Diagnostics repeated;
    SL_ASSIGN(Xml root, from->sdf_tree(text, options.in, reading, repeated));
    // Older versions have been rewritten as 1.9.
    double minor = 0;
    const std::string* const version = root.attribute("version");
    if (!version || !starts_with(*version, "1.") || !parse_number(version->substr(2), minor) || minor < 9)
      root.set_attribute("version", "1.9");
    return moved_text(root);
  }

  Result<std::string> setup_to_file() const {
    SL_ASSIGN(model::Setup setup, load(options.in, {.paths = options.paths}, diagnostics));
    for (model::Instance& instance : setup.instances) give_terrain_a_file(instance);
    SL_ASSIGN(Xml root, to.write_world(setup, diagnostics));
    return moved_text(root);
  }

  Result<std::string> setup_to_plain_file() const {
    SL_ASSIGN(const model::Setup setup, load(options.in, {.paths = options.paths}, diagnostics));
    SL_ASSIGN(const std::string text, to.write_plain_world(setup, diagnostics));
    return "# " + comment() + "\n" + text;
  }

  Result<std::string> model_to_plain_file() const {
    SL_ASSIGN(const formats::WorldContent content,
              formats::read_world(options.in, {.path = search}, diagnostics));
    if (content.is_world())
      return Error{"'" + options.in + "' is a world, and a " + format_name() + " file holds one robot",
                   "name a file with one robot"};
    SL_ASSIGN(const std::string text, to.write_plain_model(content.instances.front(), diagnostics));
    return "# " + comment() + "\n" + text;
  }

  /// A scenario of one format in another.
  Result<std::string> scenario_to_scenario() const {
    if (from == &to || (!to.write_scenario && !from->scenario_tree))
      return Error{"'" + options.in + "' is a scenario already",
                   "convert makes scenarios of worlds and robots"};
    SL_ASSIGN(const std::string text, read_text_file(options.in, from->max_bytes));
    const std::string old_folder = folder_of(options.in), new_folder = folder_of(options.out);
    const auto move = [&](std::string& file) {
      if (!file.empty() && !is_builder(file)) file = moved(file, old_folder, new_folder, search);
    };
    if (to.write_scenario) {
      SL_ASSIGN(formats::Scenario scenario,
                from->scenario(text, options.in, {.path = search}, {}, diagnostics));
      move(scenario.world);
      for (auto* const groups : {&scenario.robots, &scenario.things})
        for (formats::RobotGroup& group : *groups) move(group.model);
      SL_ASSIGN(const std::string out, to.write_scenario(scenario, diagnostics));
      return "# " + comment() + "\n" + out;
    }
    SL_ASSIGN(Node root, from->scenario_tree(text, options.in, {.path = search}, diagnostics));
    const auto move_key = [&](Node* map, const char* key) {
      Node* const value = map ? map->find(key) : nullptr;
      if (!value || !value->is_scalar()) return;
      std::string file = value->text();
      move(file);
      *value = Node::scalar(file, value->place());
    };
    move_key(&root, "world");
    for (const char* const list : {"robots", "things"})
      if (Node* const groups = root.find(list))
        for (Node& group : groups->items()) {
          move_key(&group, "model");
          move_key(group.find("controller"), "program");
        }
    return "# " + comment() + "\n" + yaml_text(root);
  }

  /// A model with parameters as the one model of a file.
  Result<std::string> built_to_file() const {
    SL_ASSIGN(const model::Instance instance,
              load_instance(options.in, "model", {}, diagnostics, options.paths));
    model::Instance named = instance;
    named.original_name = named.name = instance.model->name;
    give_terrain_a_file(named);
    SL_ASSIGN(const Xml root, to.write_model(named, diagnostics));
    return formats::xml_text(root, comment());
  }

  Result<std::string> model_to_file() const {
    SL_ASSIGN(const formats::WorldContent content,
              formats::read_world(options.in, {.path = search}, diagnostics));
    if (content.is_world())
      return Error{"'" + options.in + "' is a world, and a " + format_name() + " file holds one robot",
                   "name a file with one <model>"};
    SL_ASSIGN(Xml root, to.write_model(content.instances.front(), diagnostics));
    return moved_text(root);
  }

  /// A scenario that runs the file: ticks of 10 ms or as fine as the sensors need, physics at the file's own step.
  Result<std::string> file_to_scenario() const {
    SL_ASSIGN(const model::Setup setup, load(options.in, {.paths = options.paths}, diagnostics));
    Diagnostics repeated;
    SL_ASSIGN(const formats::WorldContent content,
              formats::read_world(options.in, {.path = search}, repeated));
    double fastest_hz = 0;
    for (const model::Instance& instance : setup.instances)
      for (const model::DeviceDecl& device : instance.devices)
        if (double hz = 0; const Node* const rate = device.config.find("rate"))
          if (parse_number(rate->text(), hz)) fastest_hz = std::max(fastest_hz, hz);
    const double step_s = content.max_step_s.value_or(0.001);
    const double longest_s = fastest_hz > 0 ? std::min(0.01, 1 / fastest_hz) : 0.01;
    const int substeps = std::clamp(static_cast<int>(std::floor(longest_s / step_s + 1e-9)), 1, 1000);
    const std::string stem = fs::path(options.out).stem().string();
    std::error_code failed;
    const fs::path folder = fs::absolute(folder_of(options.out).empty() ? "." : folder_of(options.out));
    const fs::path relative = fs::relative(fs::absolute(options.in), folder, failed);
    const std::string named = failed || relative.empty() ? fs::absolute(options.in).string()
                                                         : relative.string();
    std::string out = "# " + comment() + "\nversion: 1\nname: " + quoted(stem) + "\n";
    if (content.is_world()) out += "world: " + quoted(named) + "\n";
    out += fmt::format("physics: rigid\ntime: {{step: {} s, substeps: {}, stop: 60 s}}\nseed: 1\n",
                       number_text(rounded(step_s * substeps)), substeps);
    if (!content.is_world()) {
      const model::Instance& robot = content.instances.front();
      out += "robots:\n  - name: " + quoted(robot.original_name) + "\n    model: " + quoted(named) +
             "\n    pose: [0, 0, 0]\n";
    }
    return out;
  }

  /// "URDF"
  std::string format_name() const {
    std::string out = to.name;
    for (char& c : out) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
    return out;
  }

 private:
  /// The document with file names as seen from where it is written.
  std::string moved_text(Xml& root) const {
    Mover{folder_of(options.out), search}(root);
    return formats::xml_text(root, comment());
  }

  /// Products of decimal steps have tails of binary dust.
  static double rounded(double s) { return std::floor(s * 1e9 + 0.5) / 1e9; }

  static std::string quoted(const std::string& text) {
    std::string out = "\"";
    for (const char c : text) {
      if (c == '"' || c == '\\') out += '\\';
      out += c;
    }
    return out + "\"";
  }
};

Result<std::string> converted(const Job& job) {
  if (!job.from) {
    if (job.to.write_model) return job.built_to_file();
    return Error{"scenarios name builders themselves: model: {builder: ...}", "convert it to .sdf"};
  }
  if (job.to.scenario) {
    if (job.from->scenario) return job.scenario_to_scenario();
    if (job.to.write_scenario)
      return Error{"'" + job.options.in + "' is not a scenario",
                   "convert makes .yaml scenarios of worlds and robots"};
    return job.file_to_scenario();
  }
  if (job.to.sdf_tree && job.from->sdf_tree && job.to.write_world) return job.tree_to_sdf();
  if (job.to.write_world) return job.setup_to_file();
  if (job.to.write_plain_world) return job.setup_to_plain_file();
  if (!job.to.write_model && !job.to.write_plain_model)
    return Error{"convert writes no " + job.format_name() + " files",
                 "it writes .sdf, .urdf, .yaml, .wld, .maz, .robi and .sim"};
  if (job.from->scenario)
    return Error{
        "'" + job.options.in + "' is a scenario, and a " + job.format_name() + " file holds one robot",
        "convert it to .sdf"};
  if (job.to.write_plain_model) return job.model_to_plain_file();
  return job.model_to_file();
}

/// What cannot be read back is not written.
Status check_result(const Job& job, const std::string& text) {
  Diagnostics unheard;
  Error error;
  if (job.to.scenario) {
    const auto back = job.to.scenario(text, job.options.out, {.path = job.search}, {}, unheard);
    if (back) return {};
    error = back.error();
  } else {
    const auto back = job.to.world(text, job.options.out, {.path = job.search}, unheard);
    if (back) return {};
    error = back.error();
  }
  return Error{"'" + job.options.in + "' cannot be written in the other format: " + error.what, error.fix};
}

Status run_job(const ConvertOptions& options, Diagnostics& diagnostics) {
  const formats::FormatKind* from = nullptr;
  if (!is_builder(options.in)) { SL_ASSIGN(from, format_of(options.in)); }
  if (is_builder(options.out))
    return Error{"'" + options.out + "' is not a file", "name a file to write: .sdf or .urdf"};
  SL_ASSIGN(const formats::FormatKind* const to, format_of(options.out));
  std::error_code ignored;
  if (fs::exists(options.out, ignored) && !options.force)
    return Error{"'" + options.out + "' exists already", "add --force to replace it"};
  std::vector<Beside> beside;
  const Job job{options, from, *to, search_path(options.paths), diagnostics, beside};
  SL_ASSIGN(const std::string text, converted(job));
  for (const Beside& file : beside)
    if (fs::exists(file.path, ignored) && !options.force)
      return Error{"'" + file.path + "' exists already", "add --force to replace it"};
  for (const Beside& file : beside) SL_TRY(write_file(file.path, file.text));
  if (Status status = check_result(job, text); !status) {
    for (const Beside& file : beside) fs::remove(file.path, ignored);
    return status;
  }
  return write_file(options.out, text);
}

}  // namespace

int convert(const ConvertOptions& options) {
  Diagnostics diagnostics;
  const Status status = run_job(options, diagnostics);
  print_warnings(diagnostics);
  return status ? exit_ok : complain(status.error());
}

}  // namespace sandlot::app
