#pragma once
/// What `sandlot list` lists: the tables of the program as sections of items, whatever table they come from.
#include <span>
#include <string>
#include <vector>

#include "base/describe.h"
#include "controllers/controllers.h"
#include "devices/kind.h"
#include "noise/chain.h"

namespace sandlot::app {

/// One thing that can be listed, whatever table it comes from.
struct Item {
  std::string name, help;
  std::vector<FieldInfo> fields;
  std::span<const LevelInfo> levels;
  std::vector<std::string> sdf_names;
  std::span<const Preset> presets = {};
  std::span<const DeviceService> services = {};
  // Of file formats:
  std::string contents = {};  ///< "worlds and models"
  std::vector<std::string> extensions = {};
  bool written = false;  ///< by `sandlot convert`
};
struct Section {
  std::string key, title, intro;
  std::vector<Item> items;
};

/// What lists of stages of errors may hold.
struct StageFamily {
  const char *key, *title, *intro;
  std::vector<StageType> types;
};
std::vector<StageFamily> stage_families();

/// Elements of the world, by the key of the scenario that declares them.
struct ElementFamily {
  const char *key, *title, *intro;
  struct Kind {
    std::string name, help;
    std::vector<FieldInfo> fields;
  };
  std::vector<Kind> kinds;
};
std::vector<ElementFamily> element_families();

std::vector<Section> sections(std::span<const ControllerKind* const> controller_table);

}  // namespace sandlot::app
