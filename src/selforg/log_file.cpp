#include "selforg/log_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

#include "base/text.h"
#include "selforg/agent.h"

namespace sandlot::selforg {
namespace {

void append_number(std::string& line, double value) {
  char text[40];
  const auto end = std::to_chars(text, text + sizeof text, value).ptr;
  line.append(text, end);
}

}  // namespace

bool LogFile::wanted(std::string_view name) const {
  bool any = false, named = false;
  for (const std::string& pattern : spec_.channels) {
    if (starts_with(pattern, "-")) {
      if (fits_pattern(name, std::string_view(pattern).substr(1))) return false;
    } else {
      any = true;
      named = named || fits_pattern(name, pattern);
    }
  }
  return !any || named;
}

Status LogFile::open(const std::string& path, const LogSpec& spec, const Controller& controller) {
  return open_for(path, spec, controller, controller);
}

Status LogFile::open(const std::string& path, const LogSpec& spec, const WiredController& agent) {
  return open_for(path, spec, agent, agent.controller());
}

template <class Source>
Status LogFile::open_for(const std::string& path, const LogSpec& spec, const Source& source,
                         const Controller& controller) {
  if (spec.interval < 1) return Error{"the interval of a log is at least 1 step", ""};
  spec_ = spec;
  path_ = path;
  steps_ = 0;
  chosen_.clear();
  out_.close();
  out_.clear();
  out_.open(path, std::ios::trunc);
  if (!out_) return Error{fmt::format("cannot write '{}'", path), "check folder and rights"};
  // The date would make two logs of the same run differ.
  std::string head = "# Start date: -\n";
  head += fmt::format("#IN {}\n# Recording every {}th dataset\n", controller.kind(), spec_.interval);
  controller.list_values(ValuePart::parameter, [&](const ValueEntry& entry) {
    if (!entry.list && entry.is == ValueFound::Is::value)
      head += fmt::format("# {}= {}\n", entry.path, number_text(entry.value));
  });
  head += "#I D t time (s)\n#######\n#C t";
  source.channels([&](const Channel& channel) {
    for (std::size_t i = 0; i < channel.values.size(); ++i) {
      const std::string name = channel_name(channel, i);
      chosen_.push_back(wanted(name));
      if (chosen_.back()) head += " " + name;
    }
  });
  line_.reserve(32 * (chosen_.size() + 1));
  out_ << head << '\n';
  return {};
}

void LogFile::step(double time_s, const Controller& controller) { write_step(time_s, controller); }
void LogFile::step(double time_s, const WiredController& agent) { write_step(time_s, agent); }

template <class Source>
void LogFile::write_step(double time_s, const Source& source) {
  if (steps_++ % static_cast<std::uint64_t>(spec_.interval) != 0) return;
  line_.clear();
  append_number(line_, time_s);
  std::size_t at = 0;
  source.channels([&](const Channel& channel) {
    for (const double value : channel.values) {
      if (at >= chosen_.size() || !chosen_[at++]) continue;
      line_ += ' ';
      append_number(line_, value);
    }
  });
  line_ += '\n';
  out_.write(line_.data(), static_cast<std::streamsize>(line_.size()));
}

void LogFile::comment(std::string_view text) {
  std::string line(text);
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == '\n' || c == '\r'; }, ' ');
  out_ << "# " << line << '\n';
}

Status LogFile::close() {
  if (!out_.is_open()) return {};
  out_.flush();
  const bool whole = out_.good();
  out_.close();
  if (!whole) return Error{fmt::format("'{}' was not written as a whole", path_), "is the disk full?"};
  return {};
}

Result<LogTable> read_log(const std::string& path) {
  constexpr std::size_t most_bytes = std::size_t{1} << 30;
  std::ifstream in(path, std::ios::binary);
  if (!in) return Error{fmt::format("cannot read '{}'", path), "check the path"};
  std::string text;
  std::vector<char> block(1 << 16);
  while (in.read(block.data(), static_cast<std::streamsize>(block.size())) || in.gcount() > 0) {
    text.append(block.data(), static_cast<std::size_t>(in.gcount()));
    if (text.size() > most_bytes) return Error{fmt::format("'{}' has more than 1 GiB", path)};
  }
  return read_log_text(text, path);
}

Result<LogTable> read_log_text(std::string_view text, const std::string& name) {
  constexpr std::size_t most_columns = 100'000;
  LogTable table;
  int number = 0;
  const auto at_line = [&](std::string what, std::string fix) {
    return Error{std::move(what), std::move(fix), {std::make_shared<const std::string>(name), number, 0}};
  };
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = trim(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
    ++number;
    if (starts_with(line, "#C ")) {
      if (!table.columns.empty()) return at_line("a second line of column names", "a log has one");
      for (const auto column : split(line.substr(3), ' ')) {
        if (trim(column).empty()) continue;
        if (table.columns.size() == most_columns) return at_line("more than 100,000 columns", "choose some");
        table.columns.emplace_back(trim(column));
      }
      if (table.columns.empty()) return at_line("no column has a name", "#C t ...");
      continue;
    }
    if (starts_with(line, "#")) {
      table.comments.emplace_back(line);
      continue;
    }
    if (line.empty()) continue;
    if (table.columns.empty())
      return at_line("values before the names of the columns", "a line '#C t ...' precedes them");
    std::vector<double> row;
    row.reserve(table.columns.size());
    for (const auto cell : split(line, ' ')) {
      if (trim(cell).empty()) continue;
      double value = 0;
      if (!parse_number(cell, value))
        return at_line(fmt::format("'{}' is not a number", cell.substr(0, 60)), "");
      row.push_back(value);
      if (row.size() > table.columns.size()) break;
    }
    if (row.size() != table.columns.size())
      return at_line(
          fmt::format("{}{} values for {} columns", row.size() > table.columns.size() ? "at least " : "",
                      row.size(), table.columns.size()),
          "");
    table.rows.push_back(std::move(row));
  }
  return table;
}

}  // namespace sandlot::selforg
