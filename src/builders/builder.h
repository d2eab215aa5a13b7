#pragma once
/// Builders: models with parameters, such as creatures, playgrounds and robots to try drives with.
///
/// A builder is one folder under builders/ and one line in builders/kinds.h. It writes
///
///   struct Spec { ... };                           // named fields with a field list; a rule between them: check()
///   Result<Built> build(const Spec& spec);         // from parameters that are in range to a model
///   constinit const Builder builder = make_builder<Spec, build>({.name = "snake", .help = "..."});
///
/// Scenario files name it as `model: {builder: snake, segments: 12}`; they and the command line as
/// `builder:snake?segments=12`.
#include <span>
#include <string_view>
#include <vector>

#include "base/describe.h"
#include "base/read.h"
#include "model/rollers.h"

namespace sandlot {

/// A model, and where its frame stands above ground that passes through the origin.
struct Built {
  model::Model model;
  Pose X_WM;
};

struct Builder {
  const char* name;
  const char* help;  ///< one sentence
  // Filled by make_builder:
  std::vector<FieldInfo> (*describe)() = nullptr;
  /// @param path  of `config` in its file, for messages
  Result<Built> (*build)(const Node& config, const std::string& path) = nullptr;
};

template <class Spec, auto make>
constexpr Builder make_builder(Builder builder) {
  builder.describe = [] { return describe_fields<Spec>(); };
  builder.build = [](const Node& config, const std::string& path) -> Result<Built> {
    SL_ASSIGN(const Spec spec, read_spec<Spec>(config, path));
    SL_ASSIGN(Built built, make(spec));
    SL_TRY(model::add_rollers(built.model));
    return built;
  };
  return builder;
}

/// Error about the parameter `key`: at its place, else at that of `other_key`, else at that of the builder.
/// @param path  of `config` in its file
Error parameter_error(const Node& config, const std::string& path, const char* key, std::string what,
                      std::string fix, const char* other_key = "");

/// All builders, in the order of builders/kinds.h.
std::span<const Builder* const> builder_table();

/// Builds the model that a map describes: its key `builder` names the builder, the others are its parameters.
/// The model is called after the builder and has the map's place.
/// Errors   with the place and the key: no such builder, unknown keys, impossible parameters.
Result<Built> build_model(const Node& map, const std::string& path = "");

/// "builder:snake?segments=12&length=40 cm" as such a map; nothing when the text does not begin with
/// "builder:".
/// @param place  of the text in a file; without one, errors name the text itself
/// Errors   a part after the ? that is not key=value.
std::optional<Result<Node>> parse_builder(std::string_view text, const Place& place = {});

}  // namespace sandlot
