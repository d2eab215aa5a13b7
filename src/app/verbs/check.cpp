#include <fmt/format.h>

#include <cstdio>
#include <map>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "app/lint_file.h"
#include "base/json_text.h"
#include "formats/kind.h"
#include "sim/lint/lint.h"
#include "sim/watch/csv_log.h"

namespace sandlot::app {
namespace {

nlohmann::ordered_json to_json(const Error& e, const char* severity, const std::string& rule) {
  return {{"severity", severity},
          {"rule", rule},
          {"file", e.place.file ? *e.place.file : ""},
          {"line", e.place.line},
          {"column", e.place.column},
          {"path", e.path},
          {"what", e.what},
          {"fix", e.fix}};
}

std::string counted(std::size_t n, const char* what) {
  return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
}

/// What works at which level, of the kinds that have several: "camera image (12), laser_scanner pose".
std::string levels_text(const Simulation& simulation) {
  std::map<std::string, std::size_t> counts;
  for (const auto& entity : simulation.entities())
    for (const auto& device : entity->devices) {
      const auto kind = find_device_kind(device->decl.kind);
      if (!kind || (*kind)->levels.size() < 2) continue;
      std::string text = (*kind)->name;
      for (std::size_t level = 0; level < (*kind)->levels.size(); ++level)
        if (device->levels >> level & 1) text += std::string(" ") + (*kind)->levels[level].name;
      ++counts[text];
    }
  std::string all;
  for (const auto& [text, count] : counts)
    all += (all.empty() ? "" : ", ") + text + (count > 1 ? fmt::format(" ({})", count) : "");
  return all;
}

}  // namespace

std::vector<sandlot::Finding> lint_file(const std::string& file,
                                        const std::vector<formats::Override>& overrides,
                                        const std::vector<std::string>& paths, const Simulation& simulation) {
  std::vector<sandlot::Finding> findings = lint(simulation);
  if (const formats::FormatKind* const format = formats::find_format(file); format && format->scenario) {
    Diagnostics repeated;
    if (const auto scenario = formats::read_scenario_file(file, {search_path(paths)}, overrides, repeated))
      for (sandlot::Finding& finding : lint(*scenario)) findings.push_back(std::move(finding));
  }
  for (sandlot::Finding& finding : findings)
    if (!finding.text.place.file) finding.text.place.file = std::make_shared<const std::string>(file);
  return findings;
}

std::string text_of(const sandlot::Finding& finding) {
  return finding.text.text() + (finding.rule.empty() ? "" : " [" + finding.rule + "]");
}

int check(const FileOptions& options) {
  nlohmann::ordered_json report = nlohmann::ordered_json::array();
  int result = exit_ok;
  for (const std::string& file : options.files) {
    Diagnostics diagnostics;
    auto built = build(file, options, diagnostics);
    if (built && (*built)->setup().log)
      if (Status status = CsvLog::check(**built, *(*built)->setup().log); !status)
        built = std::move(status.error());
    std::vector<sandlot::Finding> findings;
    for (const Error& warning : diagnostics.warnings) findings.push_back({"", warning});
    if (built)
      for (sandlot::Finding& finding : lint_file(file, options.overrides, options.paths, **built))
        findings.push_back(std::move(finding));
    if (!built || (options.strict && !findings.empty())) result = exit_bad_input;
    if (options.json) {
      for (const sandlot::Finding& finding : findings)
        report.push_back(to_json(finding.text, "warning", finding.rule));
      if (!built) report.push_back(to_json(built.error(), "error", ""));
      continue;
    }
    for (const sandlot::Finding& finding : findings)
      std::fprintf(stderr, "warning: %s%s\n", finding.text.text().c_str(),
                   finding.rule.empty() ? "" : (" [" + finding.rule + "]").c_str());
    if (!built) {
      complain(built.error());
      continue;
    }
    fmt::print("{}: {}, {}, {}\n", file, options.strict && !findings.empty() ? "refused" : "ok",
               counted((*built)->instances().size(), "thing"), counted(findings.size(), "warning"));
    if (const std::string levels = levels_text(**built); !levels.empty())
      fmt::print("  levels: {}\n", levels);
  }
  if (options.json) fmt::print("{}\n", json_text(report));
  return result;
}

}  // namespace sandlot::app
