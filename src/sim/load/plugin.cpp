#include "sim/load/plugin.h"

#include <dlfcn.h>
#include <elf.h>

#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <mutex>

#include "base/text.h"
#include "control/plugin.h"
#include "files/resources.h"
#include "files/text.h"

namespace sandlot {
namespace {

namespace fs = std::filesystem;

/// The loader maps a file without asking whether it is all there, and a file that is cut short then ends the program
/// with SIGBUS: this asks first.
Status check_library(const std::string& file, std::span<const std::byte> bytes, const Place& place) {
  const Error no_library{"'" + file + "' is not a shared library for this machine", "", place};
  const Error cut_short{"'" + file + "' is damaged: it is cut short", "build it again", place};
  Elf64_Ehdr header;
  if (bytes.size() < sizeof header) return no_library;
  std::memcpy(&header, bytes.data(), sizeof header);
  constexpr Elf64_Half machine =
#if defined(__x86_64__)
      EM_X86_64;
#elif defined(__aarch64__)
      EM_AARCH64;
#else
      EM_NONE;
#endif
  if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_ident[EI_CLASS] != ELFCLASS64 ||
      header.e_type != ET_DYN || header.e_machine != machine || header.e_phentsize != sizeof(Elf64_Phdr))
    return no_library;
  const std::uint64_t table = std::uint64_t{header.e_phnum} * sizeof(Elf64_Phdr);
  if (header.e_phoff > bytes.size() || table > bytes.size() - header.e_phoff) return cut_short;
  for (std::size_t i = 0; i < header.e_phnum; ++i) {
    Elf64_Phdr part;
    std::memcpy(&part, bytes.data() + header.e_phoff + i * sizeof part, sizeof part);
    if (part.p_offset > bytes.size() || part.p_filesz > bytes.size() - part.p_offset) return cut_short;
  }
  return {};
}

Result<std::vector<std::byte>> read_library(const std::string& file, const Place& place) {
  constexpr std::uintmax_t max_bytes = std::uintmax_t{1} << 30;
  std::error_code failed;
  const std::uintmax_t size = fs::is_regular_file(file, failed) ? fs::file_size(file, failed) : 0;
  if (failed || size == 0 || size > max_bytes)
    return Error{"'" + file + "' is not a shared library", "name the .so file of a plugin", place};
  std::ifstream in(file, std::ios::binary);
  std::vector<std::byte> bytes(size);
  if (!in.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size)))
    return Error{"cannot read '" + file + "'", "", place};
  return bytes;
}

/// Checks the table of a library that has one and takes its content over.
Result<Plugin> read_table(const std::string& file, const PluginTable* table, const Place& place) {
  if (!table || table->magic != plugin_magic || !table->name || !table->build_id)
    return Error{"'" + file + "' is not a Sandlot plugin",
                 "export its controllers by SANDLOT_PLUGIN(name, ...)", place};
  Plugin plugin{file, table->name, table->build_id, 0, {}};
  const std::string rebuild = "build it again with this Sandlot's CMake package";
  if (table->api_version != static_cast<std::uint32_t>(controller_api_version))
    return Error{"plugin '" + file + "' is for version " + std::to_string(table->api_version) +
                     " of the controller border, this Sandlot has version " +
                     std::to_string(controller_api_version),
                 rebuild, place};
  if (plugin.build_id != build_id)
    return Error{
        "plugin '" + file + "' was built as [" + plugin.build_id + "], this Sandlot as [" + build_id + "]",
        rebuild, place};
  for (std::uint32_t i = 0; i < table->controller_count; ++i) {
    const ControllerKind* const kind = table->controllers[i];
    if (!kind || !kind->name || !*kind->name || !kind->help || !kind->create || !kind->describe)
      return Error{"plugin '" + file + "' has a controller without name, help or functions",
                   "make each by make_controller<C>({.name = ..., .help = ...})", place};
    plugin.controllers.push_back(kind);
  }
  return plugin;
}

/// Plugins are never unloaded: a controller's code may be on any stack until the process ends.
struct Loaded {
  std::mutex mutex;
  std::map<void*, std::unique_ptr<const Plugin>> by_handle;
};
Loaded& loaded() {
  static Loaded instance;
  return instance;
}

Result<const Plugin*> open_plugin(const std::string& file, const Place& place) {
  SL_ASSIGN(const std::vector<std::byte> bytes, read_library(file, place));
  SL_TRY(check_library(file, bytes, place));
  Loaded& all = loaded();
  const std::lock_guard lock(all.mutex);
  // A bare name would be looked up in the system's folders.
  const std::string path = fs::absolute(file).string();
  void* const handle = dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    const char* const why = dlerror();
    return Error{"cannot load plugin '" + file + "': " + (why ? why : "the loader does not say why"),
                 "link it to sandlot::control", place};
  }
  if (const auto known = all.by_handle.find(handle); known != all.by_handle.end()) return known->second.get();
  PluginEntry* const entry = reinterpret_cast<PluginEntry*>(dlsym(handle, plugin_symbol));
  auto plugin = read_table(file, entry ? entry() : nullptr, place);
  if (!plugin) {
    dlclose(handle);
    return std::move(plugin.error());
  }
  plugin->hash = hash64(bytes);
  return all.by_handle.emplace(handle, std::make_unique<const Plugin>(std::move(*plugin)))
      .first->second.get();
}

}  // namespace

Result<std::string> find_plugin(const std::string& written, const std::string& folder,
                                std::span<const std::string> paths, const Place& place) {
  std::vector<std::string> folders{folder};
  if (!fs::path(written).is_absolute()) {
    folders.insert(folders.end(), paths.begin(), paths.end());
    const char* const variable = std::getenv("SANDLOT_PATH");
    for (const std::string_view each : split(variable ? variable : "", ':'))
      if (!each.empty()) folders.emplace_back(each);
    if (std::string own = own_folder("lib/sandlot"); !own.empty()) folders.push_back(std::move(own));
  }
  const fs::path path(written);
  const fs::path parent = path.parent_path(), stem = path.filename();
  std::error_code ignored;
  std::string tried;
  for (const std::string& each : folders) {
    for (const fs::path& name :
         {path, parent / (stem.string() + ".so"), parent / ("lib" + stem.string() + ".so")}) {
      std::string file = beside(each, name.string());
      if (fs::is_regular_file(file, ignored)) return file;
    }
    tried += (tried.empty() ? "" : ", ") + (each.empty() ? std::string(".") : each);
  }
  return Error{
      "plugin '" + written + "' is not there",
      "looked for it" +
          (stem.extension() == ".so" ? "" : ", " + stem.string() + ".so and lib" + stem.string() + ".so") +
          " in " + tried + "; --path FOLDER or SANDLOT_PATH name more folders",
      place, "/plugins"};
}

Result<const Plugin*> load_plugin(const model::PluginDecl& decl, std::span<const std::string> paths,
                                  Diagnostics& diagnostics) {
  std::string file = decl.file;
  const bool from_snapshot = !decl.name.empty();
  std::error_code ignored;
  if (from_snapshot && !fs::is_regular_file(file, ignored)) {
    auto found = find_plugin(fs::path(file).filename().string(), folder_of(file), paths, decl.place);
    if (!found) {
      found.error().what = "the snapshot needs plugin '" + decl.name + "' (" + decl.file +
                           "), which is not there";
      return std::move(found.error());
    }
    file = std::move(*found);
  }
  SL_ASSIGN(const Plugin* const plugin, open_plugin(file, decl.place));
  if (from_snapshot && plugin->name != decl.name)
    return Error{
        "the snapshot needs plugin '" + decl.name + "', and '" + file + "' is plugin '" + plugin->name + "'",
        "--path FOLDER or SANDLOT_PATH name more folders", decl.place};
  if (from_snapshot && plugin->hash != decl.hash)
    diagnostics.warn({"plugin '" + file + "' is not the build that the snapshot was taken with",
                      "the run may go on in another way", decl.place});
  return plugin;
}

}  // namespace sandlot
