#include "app/commands.h"
#include "base/atomic_file.h"
#include "base/text.h"
#include "files/text.h"
#include "selforg/log_file.h"

namespace sandlot::app {
namespace {

/// Whether a text is a log of an agent: comments, then a line of names that begins with #C.
bool is_agent_log(std::string_view text) {
  return !text.empty() && text.front() == '#' &&
         (starts_with(text, "#C ") || text.find("\n#C ") != std::string_view::npos);
}

/// Its first column, t, is the time.
Result<draw::Table> read_agent_log(std::string_view text, const std::string& file) {
  SL_ASSIGN(const selforg::LogTable log, selforg::read_log_text(text, file));
  draw::Table table{file, log.columns, std::vector<std::string>(log.columns.size()), {}};
  if (table.names.front() == "t") table.names.front() = "time", table.units.front() = "s";
  table.columns.resize(log.columns.size());
  for (std::size_t i = 0; i < table.columns.size(); ++i) {
    table.columns[i].reserve(log.rows.size());
    for (const std::vector<double>& row : log.rows) table.columns[i].push_back(row[i]);
  }
  return table;
}

}  // namespace

int plot(const PlotFilesOptions& options) {
  constexpr std::uint64_t most_bytes = std::uint64_t{1} << 30;
  std::vector<draw::Table> tables;
  for (const std::string& file : options.files) {
    const auto text = read_text_file(file, most_bytes);
    if (!text) return complain(text.error());
    auto table = is_agent_log(*text) ? read_agent_log(*text, file) : draw::read_csv(*text, file);
    if (!table) return complain(table.error());
    tables.push_back(std::move(*table));
  }
  const auto figure = draw::draw_plot(tables, options.figure);
  if (!figure) return complain(figure.error());
  if (Status written = write_file(options.out, *figure); !written) return complain(written.error());
  return exit_ok;
}

}  // namespace sandlot::app
