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
  if (content.instances.size() != 1 || content.is_world())
    return Error{"'" + model_file + "' is a world, not a model", "name a file with one <model>"};
  model::Instance instance = std::move(content.instances.front());
  SL_TRY(translate_devices(instance, options.path, diagnostics));
  instance.name = sanitised(name);
  instance.original_name = name;
  instance.X_WM = X_WM * instance.X_WM;
  instance.is_robot = !instance.devices.empty();
  return instance;
}

}  // namespace sandlot
