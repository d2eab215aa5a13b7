#include "sim/load/instance.h"

#include "base/text.h"
#include "builders/builder.h"
#include "formats/kind.h"
#include "sim/load/declared_devices.h"
#include "sim/load/load.h"

namespace sandlot {

Result<model::Instance> built_instance(const Node& map, const std::string& name, const std::string& path) {
  SL_ASSIGN(Built built, build_model(map, path));
  model::Instance instance;
  instance.name = sanitised(name);
  instance.original_name = name;
  instance.X_WM = built.X_WM;
  instance.devices = built.model.devices;
  instance.is_robot = !instance.devices.empty();
  instance.place = map.place();
  instance.model = std::make_shared<const model::Model>(std::move(built.model));
  return instance;
}

namespace {

/// The only model of a file's content, as an instance at its own pose.
Result<model::Instance> only_model(formats::WorldContent content, const std::string& file,
                                   const std::string& name, const SearchPath& path,
                                   Diagnostics& diagnostics) {
  if (content.instances.size() != 1 || content.is_world())
    return Error{"'" + file + "' is a world, not a model", "name a file with one <model>"};
  model::Instance instance = std::move(content.instances.front());
  SL_TRY(translate_devices(instance, path, diagnostics));
  instance.name = sanitised(name);
  instance.original_name = name;
  instance.is_robot = !instance.devices.empty();
  return instance;
}

}  // namespace

Result<model::Instance> load_instance(const std::string& model_file, const std::string& name,
                                      const Pose& X_WM, Diagnostics& diagnostics,
                                      std::span<const std::string> paths, bool skip_missing) {
  if (const auto words = parse_builder(model_file)) {
    SL_ASSIGN(const Node map, *words);
    SL_ASSIGN(model::Instance built, built_instance(map, name, ""));
    built.X_WM = X_WM * built.X_WM;
    return built;
  }
  const formats::ReadOptions options{search_path(paths), skip_missing};
  SL_ASSIGN(formats::WorldContent content, formats::read_world(model_file, options, diagnostics));
  SL_ASSIGN(model::Instance instance,
            only_model(std::move(content), model_file, name, options.path, diagnostics));
  instance.X_WM = X_WM * instance.X_WM;
  return instance;
}

std::string format_of_text(std::string_view text) {
  // What may stand before the root element: blanks, declarations, comments.
  while (true) {
    const std::size_t begin = text.find('<');
    if (begin == std::string_view::npos) return "";
    text.remove_prefix(begin);
    const bool comment = starts_with(text, "<!--");
    if (!comment && !starts_with(text, "<?") && !starts_with(text, "<!")) break;
    const std::size_t end = text.find(comment ? "-->" : ">");
    if (end == std::string_view::npos) return "";
    text.remove_prefix(end + 1);
  }
  const auto is = [&](std::string_view element) {
    return starts_with(text.substr(1), element) && text.size() > element.size() + 1 &&
           std::string_view(" \t\r\n>").find(text[element.size() + 1]) != std::string_view::npos;
  };
  return is("sdf") ? "sdf" : is("robot") ? "urdf" : "";
}

Result<model::Instance> load_instance_text(std::string_view text, const std::string& folder,
                                           const std::string& name, Diagnostics& diagnostics,
                                           std::span<const std::string> paths, bool skip_missing) {
  const std::string file = (folder.empty() ? "." : folder) + "/resource_string." + format_of_text(text);
  const formats::FormatKind* const format = formats::find_format(file);
  if (!format) return Error{"the text is neither SDF nor URDF"};
  if (text.size() > format->max_bytes) return Error{"the text is too long"};
  const formats::ReadOptions options{search_path(paths), skip_missing};
  SL_ASSIGN(formats::WorldContent content, format->world(text, file, options, diagnostics));
  return only_model(std::move(content), file, name, options.path, diagnostics);
}

std::vector<std::pair<std::string, std::string>> built_models() {
  std::vector<std::pair<std::string, std::string>> out;
  for (const Builder* const each : builder_table())
    out.emplace_back("builder:" + std::string(each->name), each->help);
  return out;
}

}  // namespace sandlot
