#include "app/options/shared.h"

#include <CLI/CLI.hpp>

#include "base/text.h"

namespace sandlot::app {

Status read_half(const DurationOption& duration, std::optional<double>& half_s) {
  constexpr double shortest_s = 2, longest_s = 2e5;  // as rule `referee` has it
  std::optional<double> played_s;
  SL_TRY(duration.read("--duration", played_s));
  if (!played_s) return {};
  if (!(*played_s >= shortest_s && *played_s <= longest_s))
    return Error{"--duration: a match takes " + number_text(shortest_s) + " s at least and " +
                     number_text(longest_s) + " s at most, here " + number_text(*played_s) + " s",
                 "write --duration '4 min'"};
  half_s = *played_s / 2;
  return {};
}

void add_paths(CLI::App& verb, std::vector<std::string>& paths) {
  verb.add_option("--path", paths, "Folder to search for models and other files; may be given several times")
      ->allow_extra_args(false);
}

void add_sets(CLI::App& verb, std::vector<std::string>& sets) {
  verb.add_option("--set", sets, "Change the scenario before it is loaded: path=value")
      ->allow_extra_args(false);
}

void add_skip_missing(CLI::App& verb, bool& skip) {
  verb.add_flag("--skip-missing", skip,
                "Leave out, with a warning, files that a world names and that are not found: models, meshes, "
                "heightmaps");
}

void add_json(CLI::App& verb, bool& json) { verb.add_flag("--json", json, "Print as JSON"); }

void ServeFlags::add_to(CLI::App& verb) {
  verb.add_option("--port", port, "Serve the page, and Foxglove clients, on this port; 0: any that is free")
      ->check(CLI::Range(0, 65535));
  verb.add_option("--address", options.address,
                  "Address to listen at; elsewhere than on this machine a token is needed to steer")
      ->capture_default_str();
  verb.add_option("--token", options.token, "Token that allows to steer; one is made where none is given");
  verb.add_option("--tokens", options.tokens_file,
                  "File with tokens of administrators, spectators, robots and teams; docs/clients.md");
  verb.add_option("--most-clients", options.most_clients, "Clients and viewers that may be connected at once")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  verb.add_option("--most-per-address", options.most_per_address,
                  "Connections that another machine may have at once")
      ->check(CLI::Range(1, 10'000))
      ->capture_default_str();
  verb.add_option("--allow-origin", options.origins,
                  "Another site whose pages may connect: https://app.example.org; may be given several times")
      ->allow_extra_args(false);
  verb.add_flag("--udp", options.udp, "Take clients by UDP, too, at the same port; docs/clients.md");
}

Status ServeFlags::finish(std::optional<ServeOptions>& out) {
  if (port) {
    options.port = *port;
    out = options;
    return {};
  }
  if (!options.token.empty() || !options.tokens_file.empty() || !options.origins.empty() || options.udp ||
      options.address != ServeOptions().address)
    return Error{
        "--address, --token, --tokens, --allow-origin and --udp say who may look at the page, but there is "
        "none",
        "add --port 8765"};
  return {};
}

Status read_rate(const std::string& text, std::optional<double>& out) {
  out.reset();
  if (text.empty() || text == "max") return {};
  double factor = 0;
  if (!parse_number(text, factor) || !(factor > 0 && factor <= 1e6))
    return Error{"--rate: '" + text + "' is neither 'max' nor a positive number"};
  out = factor;
  return {};
}

}  // namespace sandlot::app
