/// Help texts stand alone: they are read in a form, a list or a schema, where their neighbours are not seen.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "assets/mesh/mesh.h"
#include "base/describe.h"
#include "builders/builder.h"
#include "console/command.h"
#include "controllers/controllers.h"
#include "devices/kind.h"
#include "formats/kind.h"
#include "formats/scenario/scenario.h"
#include "messages/registry.h"
#include "noise/chain.h"
#include "noise/depth_noise.h"
#include "noise/image_noise.h"
#include "physics/engine.h"
#include "programs/programs.h"
#include "run/repeat.h"
#include "sim/watch/expression.h"
#include "sim/world/device_keys.h"
#include "sim/world/faults.h"

namespace sandlot {
namespace {

/// Words that lean on a neighbour when a text begins with them.
constexpr std::array<std::string_view, 9> leaning{"Of",   "Or",   "Nor", "As", "Its",
                                                  "More", "That", "And", "But"};

/// What is wrong with a help text; empty when nothing is.
std::string fault_of(std::string_view help) {
  if (help.empty()) return "is empty";
  const std::size_t end = std::min(
      help.find_first_not_of("ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz"), help.size());
  if (std::find(leaning.begin(), leaning.end(), help.substr(0, end)) != leaning.end())
    return "begins with '" + std::string(help.substr(0, end)) + "'";
  if (help.find(' ') == std::string_view::npos) return "is a single word";
  if (!help.ends_with('.')) return "does not end with a full stop";
  return "";
}

struct HelpText {
  std::string owner, help;
};

void add_fields(const std::string& owner, const std::vector<FieldInfo>& fields, std::vector<HelpText>& out) {
  for (const FieldInfo& field : fields) out.push_back({owner + "/" + field.path, field.help});
}

/// All that are wrong, one per line.
std::string faults_of(const std::vector<HelpText>& texts) {
  std::string out;
  for (const HelpText& text : texts)
    if (const std::string fault = fault_of(text.help); !fault.empty())
      out += text.owner + ": " + fault + ": \"" + text.help + "\"\n";
  return out;
}

std::vector<HelpText> device_texts() {
  std::vector<HelpText> out;
  for (const Kind* const kind : device_kinds()) {
    const std::string owner = kind->name;
    out.push_back({owner, kind->help});
    for (const LevelInfo& level : kind->levels) out.push_back({owner + " level " + level.name, level.help});
    for (const DeviceService& service : kind->services)
      out.push_back({owner + " service " + service.name, service.help});
    for (const Preset& preset : kind->presets) out.push_back({owner + " preset " + preset.name, preset.help});
    add_fields(owner, kind->describe(), out);
  }
  add_fields("faults", describe_fields<FaultsSpec>(), out);
  add_fields("common", describe_fields<DeviceKeysSpec>(), out);
  return out;
}

std::vector<HelpText> stage_texts() {
  std::vector<HelpText> out;
  for (const auto& types : {stage_types(), image_stage_types(), depth_stage_types()})
    for (const StageType& type : types) {
      out.push_back({type.name, type.help});
      add_fields(type.name, type.fields, out);
    }
  return out;
}

/// Every "description" of a JSON schema.
void add_descriptions(const nlohmann::json& schema, const std::string& path, std::vector<HelpText>& out) {
  if (schema.is_object())
    if (const auto text = schema.find("description"); text != schema.end() && text->is_string())
      out.push_back({path, *text});
  if (schema.is_structured())
    for (const auto& [key, value] : schema.items()) add_descriptions(value, path + "/" + key, out);
}

struct Planted {
  double range_m = 1, quality = 90;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"range", "m", "Farthest visible distance."}, s.range_m);
    visit(Field{"quality", "1", "Of jpeg."}, s.quality);
  }
};

TEST(HelpTexts, PlantedFaultsAreFound) {
  EXPECT_EQ(fault_of("JPEG quality."), "");
  EXPECT_EQ(fault_of("Offset of the clock."), "");  // not "Of"
  EXPECT_EQ(fault_of("Ascent per second."), "");
  for (const std::string_view word : leaning)
    EXPECT_EQ(fault_of(std::string(word) + " the picture."), "begins with '" + std::string(word) + "'");
  EXPECT_EQ(fault_of("Of: pixels."), "begins with 'Of'");
  EXPECT_EQ(fault_of("Errors."), "is a single word");
  EXPECT_EQ(fault_of("Errors of the picture"), "does not end with a full stop");
  EXPECT_EQ(fault_of(""), "is empty");

  std::vector<HelpText> texts;
  add_fields("planted", describe_fields<Planted>(), texts);
  EXPECT_EQ(faults_of(texts), "planted/quality: begins with 'Of': \"Of jpeg.\"\n");
  texts.clear();
  add_descriptions({{"a", {{"description", "Nor farther ones."}}}}, "schema", texts);
  EXPECT_EQ(faults_of(texts), "schema/a: begins with 'Nor': \"Nor farther ones.\"\n");
}

TEST(HelpTexts, OfDevicesStandAlone) {
  const std::vector<HelpText> texts = device_texts();
  EXPECT_GT(texts.size(), 500u);
  EXPECT_EQ(faults_of(texts), "");
}

TEST(HelpTexts, OfControllersStandAlone) {
  std::vector<HelpText> texts;
  for (const ControllerKind* const kind : controller_kinds()) {
    texts.push_back({kind->name, kind->help});
    add_fields(kind->name, kind->describe(), texts);
  }
  for (const ProgramKind* const kind : program_kinds()) {
    texts.push_back({kind->name, kind->help});
    add_fields(kind->name, kind->describe(), texts);
  }
  EXPECT_GT(texts.size(), 40u);
  EXPECT_EQ(faults_of(texts), "");
}

TEST(HelpTexts, OfFileFormatsStandAlone) {
  std::vector<HelpText> texts;
  for (const formats::FormatKind* const kind : formats::format_kinds())
    texts.push_back({kind->name, kind->help});
  for (const assets::MeshFormat& format : assets::mesh_formats()) texts.push_back({format.name, format.help});
  EXPECT_GT(texts.size(), 8u);
  EXPECT_EQ(faults_of(texts), "");
}

TEST(HelpTexts, OfBuildersStandAlone) {
  std::vector<HelpText> texts;
  for (const Builder* const builder : builder_table()) {
    texts.push_back({builder->name, builder->help});
    add_fields(builder->name, builder->describe(), texts);
  }
  EXPECT_GT(texts.size(), 100u);
  EXPECT_EQ(faults_of(texts), "");
}

TEST(HelpTexts, OfEnginesStandAlone) {
  std::vector<HelpText> texts;
  for (const EngineKind* const kind : engine_kinds()) {
    texts.push_back({kind->name, kind->help});
    add_fields(kind->name, kind->describe(), texts);
  }
  EXPECT_GT(texts.size(), 15u);
  EXPECT_EQ(faults_of(texts), "");
}

TEST(HelpTexts, OfNoiseStandAlone) {
  const std::vector<HelpText> texts = stage_texts();
  EXPECT_GT(texts.size(), 50u);
  EXPECT_EQ(faults_of(texts), "");
}

TEST(HelpTexts, OfMessagesStandAlone) {
  std::vector<HelpText> texts;
  for (const MessageInfo* const type : all_messages())
    for (const MessageField& field : type->fields)
      texts.push_back({type->name + "/" + field.name, field.help});
  EXPECT_GT(texts.size(), 300u);
  EXPECT_EQ(faults_of(texts), "");
}

TEST(HelpTexts, OfScenarioKeysStandAlone) {
  std::vector<HelpText> texts;
  add_descriptions(nlohmann::json::parse(formats::scenario_schema()), "scenario", texts);
  EXPECT_GT(texts.size(), 70u);
  EXPECT_EQ(faults_of(texts), "");
}

TEST(HelpTexts, OfSummariesAndExpressionsStandAlone) {
  std::vector<HelpText> texts;
  add_fields("summary", describe_fields<Summary>(), texts);
  add_fields("repeated", describe_fields<RepeatSummary>(), texts);
  add_fields("run", describe_fields<RepeatedRun>(), texts);
  add_fields("judged", describe_fields<JudgedRuns>(), texts);
  for (const Expression::Function& function : Expression::functions())
    texts.push_back({function.call, function.help});
  EXPECT_GT(texts.size(), 50u);
  EXPECT_EQ(faults_of(texts), "");
}

TEST(HelpTexts, OfConsoleCommandsStandAlone) {
  std::vector<HelpText> texts;
  for (const console::BuiltinCommand& command : console::commands())
    texts.push_back({command.name, command.help});
  EXPECT_GT(texts.size(), 20u);
  EXPECT_EQ(faults_of(texts), "");
}

}  // namespace
}  // namespace sandlot
