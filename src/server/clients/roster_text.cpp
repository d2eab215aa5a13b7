/// The roster as text: JSON for viewers, a table for people.
#include <fmt/format.h>

#include <algorithm>

#include "base/json_writer.h"
#include "server/clients/roster.h"

namespace sandlot::server {
namespace {

void write_figures(JsonWriter& w, const DurationMeter::Figures& figures) {
  if (figures.count == 0) return w.null();
  w.object([&] {
    w.key("last").real(figures.last_s);
    w.key("mean").real(figures.mean_s);
    w.key("p99").real(figures.p99_s);
    w.key("max").real(figures.max_s);
  });
}

/// Without the empty bins at its ends.
void write_histogram(JsonWriter& w, const std::array<std::uint64_t, DurationMeter::bins>& bins) {
  const auto filled = [](std::uint64_t count) { return count > 0; };
  const auto first = std::find_if(bins.begin(), bins.end(), filled);
  const auto last = std::find_if(bins.rbegin(), bins.rend(), filled).base();
  w.object([&] {
    const auto index = first == bins.end() ? 0 : static_cast<int>(first - bins.begin());
    w.key("first_s").real(DurationMeter::lower_edge_s(index));
    w.key("per_decade").integer(DurationMeter::bins_per_decade);
    w.key("counts").list([&] {
      for (auto each = first; each < last; ++each) w.integer(*each);
    });
  });
}

void write_program(JsonWriter& w, const Roster::ProgramRow& program) {
  w.object([&] {
    w.key("path").text(program.path);
    w.key("control_period_s").real(program.control_period_s);
    w.key("deadline_s").real(program.deadline_s);
    w.key("steps").integer(program.steps);
    w.key("misses").integer(program.misses);
    if (program.waiting_s) w.key("waiting_s").real(*program.waiting_s);
    else w.key("waiting_s").null();
    w.key("latency_s");
    write_figures(w, program.latency);
    w.key("step_s");
    write_figures(w, program.step);
    w.key("latencies");
    write_histogram(w, program.histogram);
  });
}

void write_row(JsonWriter& w, const Roster::Row& row) {
  w.object([&] {
    w.key("id").integer(row.id);
    w.key("protocol").text(name_of(row.protocol));
    w.key("address").text(row.connection.address);
    w.key("name").text(row.connection.name);
    w.key("role").text(name_of(row.access.role));
    w.key("drives").text(row.drives);
    w.key("robots").list([&] {
      for (const std::string& each : row.access.robots) w.text(each);
    });
    w.key("mode").text(name_of(row.mode));
    w.key("connected_s").real(row.connected_s);
    w.key("bytes_in").integer(row.connection.bytes_in);
    w.key("bytes_out").integer(row.connection.bytes_out);
    w.key("messages").integer(row.messages);
    w.key("messages_per_s").real(row.messages_per_s);
    w.key("commands").integer(row.commands);
    w.key("commands_per_s").real(row.commands_per_s);
    w.key("dropped").integer(row.connection.dropped);
    w.key("refused").integer(row.refused);
    w.key("stops").integer(row.stops);
    w.key("programs").list([&] {
      for (const Roster::ProgramRow& each : row.programs) write_program(w, each);
    });
  });
}

std::string who(const Roster::Row& row) {
  std::string out = name_of(row.access.role);
  if (!row.drives.empty()) out += " " + row.drives;
  return out;
}

/// "1.23", in milliseconds.
std::string ms(double duration_s) { return fmt::format("{:.3g}", 1e3 * duration_s); }

}  // namespace

std::string clients_json(const std::vector<Roster::Row>& rows, const std::vector<OutsideProgram>& programs) {
  std::string out;
  JsonWriter w(out);
  w.object([&] {
    w.key("clients").list([&] {
      for (const Roster::Row& each : rows) write_row(w, each);
    });
    w.key("programs").list([&] {
      for (const OutsideProgram& each : programs)
        w.object([&] {
          w.key("path").text(each.path);
          w.key("kind").text(each.kind);
          w.key("is_client").flag(each.is_client);
          w.key("connected").flag(each.connected);
          w.key("started").flag(each.started);
          w.key("answers").integer(each.answers);
          w.key("misses").integer(each.misses);
        });
    });
  });
  return out;
}

std::string clients_text(const std::vector<Roster::Row>& rows) {
  std::vector<std::array<std::string, 9>> cells = {
      {"id", "name", "protocol", "address", "role", "mode", "msg/s", "latency ms", "missed"}};
  for (const Roster::Row& row : rows) {
    std::string latency = "-", missed = "-";
    for (const Roster::ProgramRow& each : row.programs) {
      const bool first = latency == "-";
      latency = (first ? "" : latency + ", ") + ms(each.latency.mean_s) +
                " (99 %: " + ms(each.latency.p99_s) + ")";
      missed = (first ? "" : missed + ", ") + fmt::format("{} of {}", each.misses, each.steps);
    }
    if (row.stops > 0) missed = fmt::format("stopped {} times", row.stops);
    cells.push_back({std::to_string(row.id), row.connection.name.empty() ? "-" : row.connection.name,
                     name_of(row.protocol), row.connection.address, who(row), name_of(row.mode),
                     fmt::format("{:.1f}", row.messages_per_s), latency, missed});
  }
  std::array<std::size_t, 9> widths{};
  for (const auto& line : cells)
    for (std::size_t i = 0; i < widths.size(); ++i) widths[i] = std::max(widths[i], line[i].size());
  std::string out;
  for (const auto& line : cells) {
    std::string text;
    for (std::size_t i = 0; i < widths.size(); ++i) text += fmt::format("{:<{}}  ", line[i], widths[i]);
    out += text.substr(0, text.find_last_not_of(' ') + 1) + "\n";
  }
  out.pop_back();
  return out;
}

}  // namespace sandlot::server
