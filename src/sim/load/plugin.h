#pragma once
/// Shared libraries with users' own controllers: found, checked, loaded once per process.
///
/// Errors   nothing there; no shared library, or a damaged one (checked before the system's loader sees it); what the
///          loader says; no `sandlot_plugin` in it; another API version or build id, both named. All with the place
///          that names the plugin.
/// Limits   a plugin runs in this process and can crash it. Loading one runs its static initialisers, whatever it is: one that throws there
///          ends the process.
#include <span>
#include <string>
#include <vector>

#include "base/result.h"
#include "control/controller.h"
#include "model/model.h"

namespace sandlot {

struct Plugin {
  std::string file;  ///< as it was opened
  std::string name;  ///< as it calls itself
  std::string build_id;
  std::uint64_t hash = 0;  ///< of the file's bytes
  std::vector<const ControllerKind*> controllers;
};

/// The file behind what a scenario or a flag wrote: `written`, `written`.so or lib`written`.so in `folder`, in `paths`
/// and SANDLOT_PATH, in lib/sandlot of the installation.
Result<std::string> find_plugin(const std::string& written, const std::string& folder,
                                std::span<const std::string> paths, const Place& place);

/// Loads a plugin, or returns the one that is loaded already. Any thread; the result lives as long as the process.
/// A declaration that knows its name (from a snapshot) is searched by the name of its file when it is not where it was;
/// another plugin in its place is an error, another build of it a warning.
Result<const Plugin*> load_plugin(const model::PluginDecl& decl, std::span<const std::string> paths,
                                  Diagnostics& diagnostics);

}  // namespace sandlot
