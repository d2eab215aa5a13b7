#include "app/verbs/list/sections.h"

#include "app/papers/papers.h"
#include "assets/mesh/mesh.h"
#include "builders/builder.h"
#include "formats/kind.h"
#include "formats/scenario/scenario.h"
#include "markers/marker.h"
#include "media/medium.h"
#include "noise/depth_noise.h"
#include "noise/image_noise.h"
#include "physics/engine.h"
#include "programs/programs.h"
#include "rules/rule.h"
#include "sim/world/device_keys.h"
#include "sim/world/faults.h"

namespace sandlot::app {

std::vector<StageFamily> stage_families() {
  return {{"noise", "Noise",
           "Stages of errors: `noise: [{gaussian: {std: 1 cm}}, ...]`; U is the unit of the values.",
           stage_types()},
          {"image_noise", "Noise of pictures",
           "Stages of errors of pictures: `noise: [{salt_and_pepper: {salt: 1 %, pepper: 1 %}}, ...]` of a "
           "camera; 1 is "
           "full scale.",
           image_stage_types()},
          {"depth_noise", "Noise of depth pictures",
           "Stages of errors of depth pictures: `[{quadratic: {std: 1.4 mm}}, ...]`.", depth_stage_types()}};
}

std::vector<ElementFamily> element_families() {
  const auto of = [](const char* key, const char* title, const char* intro, const auto& table) {
    ElementFamily out{key, title, intro, {}};
    for (const auto* const kind : table) out.kinds.push_back({kind->name, kind->help, kind->describe()});
    return out;
  };
  return {of("media", "Media", "What spreads between robots or pushes them: `media:` of a scenario.",
             medium_kinds()),
          of("rules", "Rules", "What judges the run, and acts: `rules:` of a scenario.", rule_kinds()),
          of("markers", "Markers", "Areas on the ground: `markers:` of a scenario.", marker_kinds())};
}

namespace {

Section format_section() {
  Section out{
      "formats",
      "File formats",
      "What `sandlot run`, `check`, `info` and `convert` read, by the extension of the file, and the meshes "
      "that such files name.",
      {}};
  for (const formats::FormatKind* const kind : formats::format_kinds()) {
    Item item{kind->name, kind->help, {}, {}, {}};
    item.contents = kind->contents;
    item.extensions.assign(kind->extensions.begin(), kind->extensions.end());
    item.written = kind->scenario || kind->write_world || kind->write_model;
    out.items.push_back(std::move(item));
  }
  for (const assets::MeshFormat& format : assets::mesh_formats()) {
    Item item{format.name, format.help, {}, {}, {}};
    item.contents = "meshes";
    item.extensions.assign(format.extensions.begin(), format.extensions.end());
    out.items.push_back(std::move(item));
  }
  return out;
}

}  // namespace

std::vector<Section> sections(std::span<const ControllerKind* const> controller_table) {
  Section devices{"devices", "Devices", "Sensors and actuators: `devices:` of a robot in a scenario.", {}};
  for (const Kind* kind : device_kinds()) {
    Item item{kind->name, kind->help, kind->describe(), kind->levels, {}, kind->presets, kind->services};
    for (const char* name : kind->sdf_types) item.sdf_names.emplace_back(name);
    devices.items.push_back(std::move(item));
  }
  Section controllers{
      "controllers", "Controllers", "Programs that decide: `controller:` of a robot in a scenario.", {}};
  for (const ControllerKind* kind : controller_table)
    controllers.items.push_back({kind->name, kind->help, kind->describe(), {}, {}, {}});
  Section programs{
      "programs",
      "Programs",
      "Programs outside this process that decide, in the place of a controller: `controller:` of a "
      "robot or a team in a scenario.",
      {}};
  for (const ProgramKind* kind : program_kinds())
    programs.items.push_back({kind->name, kind->help, kind->describe(), {}, {}, {}});
  Section engines{"engines", "Physics engines", "`physics:` of a scenario.", {}};
  for (const EngineKind* kind : engine_kinds())
    engines.items.push_back({kind->name, kind->help, kind->describe(), {}, {}, {}});
  Section common{"common",
                 "Common keys",
                 "Keys of every device in addition to its kind's and to those of [faults](#faults): `mass: "
                 "160 g`, `delay: 50 ms`, "
                 "`command_errors: {linear: [{gaussian: {std: 1 cm/s}}]}`.",
                 {}};
  common.items.push_back(
      {"device",
       "Mass, limit of activations, delay, errors of commands and drains. A kind with a key "
       "`errors` of its own has that one.",
       describe_fields<DeviceKeysSpec>(),
       {},
       {},
       {}});
  Section faults{
      "faults",
      "Faults",
      "Keys of every device in addition to its kind's: `failures: [{kind: stuck, from: 3 s, until: 5 s}]`, "
      "`clock: {drift: 20e-6}`.",
      {}};
  faults.items.push_back({"failures",
                          "Times in which the device is stuck, dead or noisy, one per entry of the list.",
                          describe_fields<FailureSpec>(),
                          {},
                          {},
                          {}});
  faults.items.push_back(
      {"clock", "Errors of the times in its messages.", describe_fields<ClockSpec>(), {}, {}, {}});
  std::vector<Section> out{devices, controllers, programs};
  for (ElementFamily& family : element_families()) {
    out.push_back({family.key, family.title, family.intro, {}});
    for (auto& [name, help, fields] : family.kinds) out.back().items.push_back({name, help, fields, {}, {}});
  }
  out.push_back(std::move(engines));
  for (const StageFamily& family : stage_families()) {
    out.push_back({family.key, family.title, family.intro, {}});
    for (const StageType& type : family.types)
      out.back().items.push_back({type.name, type.help, type.fields, {}, {}, {}});
  }
  out.push_back(std::move(common));
  out.push_back(std::move(faults));
  Section distributions{"distributions",
                        "Distributions",
                        "Places of several robots or things: `distribution: {grid: {spacing: 2 m}}` of an "
                        "entry of `robots:` or `things:` in a scenario with `count`.",
                        {}};
  for (auto& [name, help, fields] : formats::distribution_kinds())
    distributions.items.push_back({name, help, fields, {}, {}});
  out.push_back(std::move(distributions));
  Section builders{
      "builders",
      "Builders",
      "Models with parameters: `model: {builder: snake, segments: 12}` of a robot or a thing in a scenario, "
      "`builder:snake?segments=12` on the command line.",
      {}};
  for (const Builder* const builder : builder_table())
    builders.items.push_back({builder->name, builder->help, builder->describe(), {}, {}, {}});
  out.push_back(std::move(builders));
  out.push_back(format_section());
  Section reproduced{"papers",
                     "Papers",
                     "Publications whose experiments `sandlot reproduce NAME` makes again as a page.",
                     {}};
  for (const Paper& paper : papers())
    reproduced.items.push_back({paper.name, std::string(paper.title) + ".", {}, {}, {}});
  out.push_back(std::move(reproduced));
  return out;
}

}  // namespace sandlot::app
