#pragma once
#include <CLI/CLI.hpp>

namespace sandlot::app {

/// `sandlot render`, with its options.
void add_render_verb(CLI::App& app, int& result);

}  // namespace sandlot::app
