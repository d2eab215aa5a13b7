#pragma once
/// SDFormat worlds and models (libsdformat 12 behind tinyxml2's well-formedness check).
///
/// Sensors and plugins become DeviceDecls whose `config` is the XML element as Nodes (attributes as keys with a
/// leading '@', repeated children as a sequence), for the kinds to interpret. What is not used is named in one
/// warning each, with its line.
#include <string>
#include <string_view>
#include <vector>

#include "model/model.h"

namespace sandlot::formats {

struct SdfContent {
  std::string world_name;                    ///< "" for a model file
  Vec3 gravity_mps2{0, 0, -9.81};
  std::optional<double> max_step_s;          ///< <physics><max_step_size>
  std::vector<model::Instance> instances;    ///< of a world: its models; of a model file: exactly one at the origin
  std::vector<model::Light> lights;
};

struct SdfLimits {
  std::size_t max_bytes = 64u << 20;
  std::size_t max_depth = 64;
  std::size_t max_elements = 2'000'000;
};

Result<SdfContent> read_sdf(const std::string& path, Diagnostics& diagnostics, const SdfLimits& limits = {});
/// As above from text; `file` names it in messages.
Result<SdfContent> parse_sdf(std::string_view text, const std::string& file, Diagnostics& diagnostics,
                             const SdfLimits& limits = {});

}  // namespace sandlot::formats
