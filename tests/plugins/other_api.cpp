/// Was made for another version of the border.
#include "control/plugin.h"

extern "C" __attribute__((visibility("default"))) const sandlot::PluginTable* sandlot_plugin() {
  static const sandlot::PluginTable table{sandlot::plugin_magic, 99,      sandlot::build_id,
                                          "test_other_api",      nullptr, 0};
  return &table;
}
