#pragma once
#include <CLI/CLI.hpp>
#include <string>
#include <vector>

namespace sandlot::app {

struct ConsoleOptions {
  std::string url;  ///< as people write it; "": this machine's
  std::string token;
  std::vector<std::string> lines;  ///< to say; empty: read them
  std::string script_file;
  bool json = false;
};
int console(const ConsoleOptions& options);

/// `sandlot console`, with its options.
void add_console_verb(CLI::App& app, int& result);

}  // namespace sandlot::app
