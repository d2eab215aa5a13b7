#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "base/atomic_file.h"
#include "base/json_text.h"
#include "base/text.h"
#include "draw/plot.h"
#include "validation/validation.h"

namespace sandlot::app {
namespace {

using validation::Figure;
using validation::Row;
using validation::Section;

std::string number(double x) {
  // Rounding noise around zero.
  return std::abs(x) < 1e-9 ? "0" : fmt::format("{:.4g}", x);
}

std::string deviation_text(const Row& row, double value) {
  return row.relative ? fmt::format("{:.2g} %", 100 * value) : fmt::format("{:.2g} {}", value, row.unit);
}

std::string markdown(const std::vector<Section>& sections, const std::string& figures) {
  std::size_t rows = 0, good = 0;
  for (const Section& section : sections)
    for (const Row& row : section.rows) ++rows, good += row.ok() ? 1 : 0;
  std::string page = fmt::format(
      "# Validation\n\nMade by `sandlot validate --out docs`: {} of {} results lie within their bounds. Each "
      "experiment runs "
      "in the engines with the settings that a scenario has by default.\n",
      good, rows);
  for (const Section& section : sections) {
    page += fmt::format("\n## {}\n\n{}\n\n", section.title, section.text);
    page +=
        "| experiment | engine | measured | theory | deviation | bound | |\n|---|---|---|---|---|---|---|\n";
    for (const Row& row : section.rows)
      page += fmt::format("| {} | {} | {} {} | {} | {} | {} | {} |\n", row.what, row.engine,
                          number(row.measured), row.unit == "1" ? "" : row.unit, number(row.expected),
                          deviation_text(row, row.deviation()), deviation_text(row, row.bound),
                          row.ok() ? "ok" : "**OFF**");
    for (const validation::Table& table : section.tables) {
      page += fmt::format("\n{}:\n\n| {} |\n|", table.title, fmt::join(table.names, " | "));
      for (std::size_t i = 0; i < table.names.size(); ++i) page += "---|";
      for (const auto& row : table.rows) page += fmt::format("\n| {} |", fmt::join(row, " | "));
      page += '\n';
    }
    for (const Figure& figure : section.figures)
      page += fmt::format("\n![{}]({}/{}.svg)\n", figure.title, figures, figure.name);
  }
  return page;
}

Status write_figure(const Figure& figure, const std::string& folder) {
  draw::PlotOptions options;
  options.x = figure.names[0];
  options.title = figure.title;
  SL_ASSIGN(const std::string drawn,
            draw::draw_plot({{figure.name, figure.names, figure.units, figure.columns}}, options));
  return write_file(folder + "/" + figure.name + ".svg", drawn);
}

}  // namespace

int validate(const ValidateOptions& options) {
  std::vector<std::string> names;
  for (const auto& each : validation::validations()) names.emplace_back(each.name);
  if (!options.name.empty() && std::find(names.begin(), names.end(), options.name) == names.end())
    return complain(
        {"validate: there is no experiment '" + options.name + "'", suggestion(options.name, names)});
  if (!options.name.empty() && !options.out.empty())
    return complain({"validate: the page has all experiments", "leave the name out, or --out"});
  std::vector<Section> sections;
  auto json = nlohmann::ordered_json::array();
  bool all_ok = true;
  for (const auto& each : validation::validations()) {
    if (!options.name.empty() && options.name != each.name) continue;
    sections.push_back(each.run());
    for (const Row& row : sections.back().rows) {
      all_ok = all_ok && row.ok();
      json.push_back({{"experiment", each.name},
                      {"what", row.what},
                      {"engine", row.engine},
                      {"unit", row.unit},
                      {"measured", row.measured},
                      {"expected", row.expected},
                      {"deviation", row.deviation()},
                      {"relative", row.relative},
                      {"bound", row.bound},
                      {"ok", row.ok()}});
      if (!options.json)
        fmt::print("{:<4} {:<72} {:<14} {:>10} {:<7} theory {:>10}  off by {} (bound {})\n",
                   row.ok() ? "ok" : "OFF", row.what, row.engine, number(row.measured), row.unit,
                   number(row.expected), deviation_text(row, row.deviation()),
                   deviation_text(row, row.bound));
    }
  }
  if (options.json) fmt::print("{}\n", json_text(json));
  if (!options.out.empty()) {
    const std::string figures = "images/validation";
    std::error_code ignored;
    std::filesystem::create_directories(options.out + "/" + figures, ignored);
    for (const Section& section : sections)
      for (const Figure& figure : section.figures)
        if (Status written = write_figure(figure, options.out + "/" + figures); !written)
          return complain(written.error());
    if (Status written = write_file(options.out + "/validation.md", markdown(sections, figures)); !written)
      return complain(written.error());
  }
  return all_ok ? exit_ok : exit_failed;
}

}  // namespace sandlot::app
