#pragma once
/// Options that several verbs have, and what they are when they are read.
#include <optional>
#include <string>
#include <vector>

#include "app/commands.h"
#include "app/flags.h"
#include "base/result.h"

namespace CLI {
class App;
}

namespace sandlot::app {

void add_paths(CLI::App& verb, std::vector<std::string>& paths);
void add_sets(CLI::App& verb, std::vector<std::string>& sets);
void add_skip_missing(CLI::App& verb, bool& skip);
void add_json(CLI::App& verb, bool& json);

/// Options of a server: --port, --address, --token, --tokens, --allow-origin, --udp.
struct ServeFlags {
  std::optional<int> port;
  ServeOptions options;

  void add_to(CLI::App& verb);
  /// @param out  unset without --port
  Status finish(std::optional<ServeOptions>& out);
};

/// Length of a match, both halves together, as the length of a half.
Status read_half(const DurationOption& duration, std::optional<double>& half_s);

/// "max", "" or a factor of real time.
Status read_rate(const std::string& text, std::optional<double>& out);

}  // namespace sandlot::app
