#pragma once
/// Sections of a list as text, as the reference page and as JSON.
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string_view>
#include <vector>

#include "app/verbs/list/sections.h"

namespace sandlot::app {

void print_text(const Section& section, bool verbose);
/// The levels of all devices.
void print_levels();
void print_markdown(const std::vector<Section>& all);
nlohmann::ordered_json to_json(const Section& section);

/// Width of a column that holds these names.
template <class List, class Name>
std::size_t width_of(const List& list, Name name) {
  std::size_t out = 0;
  for (const auto& each : list) out = std::max(out, std::string_view(name(each)).size());
  return out;
}

/// A text as the cell of a table in Markdown.
std::string cell(std::string text);

}  // namespace sandlot::app
