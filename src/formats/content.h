#pragma once
/// Contents of a file that declares a world or a model, in whatever format.
#include <optional>
#include <string>
#include <vector>

#include "files/resources.h"
#include "model/model.h"

namespace sandlot::formats {

struct WorldContent : model::Environment {
  std::string world_name;  ///< "" for a model file
  std::vector<model::Instance>
      instances;                     ///< of a model file: exactly one, at the pose that the file gives it
  std::optional<double> max_step_s;  ///< longest physics step that the file asks for
  std::vector<model::ElementDecl> media;
  double endpoint_power_dBm = 20;  ///< with which the radios of these media send
  Node physics;                    ///< keys of `physics:` of the engine rigid; null when the file has none

  bool is_world() const { return !world_name.empty(); }
};

struct ReadOptions {
  SearchPath path = search_path();
  bool skip_missing = false;  ///< missing files are left out with a warning, not an error
};

}  // namespace sandlot::formats
