#include "files/yaml.h"
#include "formats/kind.h"

namespace sandlot::formats {

constexpr std::string_view scenario_extensions[] = {".yaml", ".yml"};

extern const FormatKind scenario_format;
constinit const FormatKind scenario_format{
    .name = "scenario",
    .help = "Scenarios (YAML): a world, robots, controllers, clock.",
    .contents = "scenarios",
    .extensions = scenario_extensions,
    .max_bytes = TextLimits{}.max_bytes,
    .scenario = [](std::string_view text, const std::string& file, const ReadOptions&,
                   std::span<const Override> overrides,
                   Diagnostics& diagnostics) { return parse_scenario(text, file, overrides, diagnostics); },
};

}  // namespace sandlot::formats
