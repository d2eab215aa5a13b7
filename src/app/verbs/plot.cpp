#include "app/commands.h"
#include "base/atomic_file.h"
#include "files/text.h"

namespace sandlot::app {

int plot(const PlotFilesOptions& options) {
  constexpr std::uint64_t most_bytes = std::uint64_t{1} << 30;
  std::vector<draw::Table> tables;
  for (const std::string& file : options.files) {
    const auto text = read_text_file(file, most_bytes);
    if (!text) return complain(text.error());
    auto table = draw::read_csv(*text, file);
    if (!table) return complain(table.error());
    tables.push_back(std::move(*table));
  }
  const auto figure = draw::draw_plot(tables, options.figure);
  if (!figure) return complain(figure.error());
  if (Status written = write_file(options.out, *figure); !written) return complain(written.error());
  return exit_ok;
}

}  // namespace sandlot::app
