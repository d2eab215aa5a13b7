#include "sim/watch/csv_log.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/text.h"

namespace sandlot {
namespace {

constexpr std::size_t hold_bytes = 64 << 10;

void append_number(std::string& out, double x) {
  if (std::isnan(x)) {
    out += "nan";  // never "-nan"
    return;
  }
  char buffer[32];
  out.append(buffer, std::to_chars(buffer, buffer + sizeof buffer, x).ptr);
}

}  // namespace

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\n\r") == std::string_view::npos) return std::string(text);
  std::string out = "\"";
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  return out + "\"";
}

CsvLog::CsvLog(const Simulation& simulation, std::string path, double rate_hz)
    : simulation_(simulation), path_(std::move(path)), rate_hz_(rate_hz) {}

CsvLog::~CsvLog() {
  if (file_ < 0) return;
  if (begun_) flush();
  ::close(file_);
  if (created_ && !begun_) ::unlink(path_.c_str());
}

Status CsvLog::check(const Simulation& simulation, const model::LogDecl& decl) {
  if (decl.file.empty()) return Error{"the log has no file", "name one, such as run.csv", decl.place};
  if (decl.values.empty()) return Error{"the log has no values", "list addresses or expressions", decl.place};
  const double tick_hz = 1e9 / static_cast<double>(simulation.setup().step.ns);
  const bool fixed = simulation.setup().clock.mode == model::Clock::Mode::fixed;
  if (fixed && decl.rate_hz > tick_hz * (1 + 1e-9))
    return Error{"the log's rate of " + number_text(decl.rate_hz) + " Hz is above the tick rate of " +
                     number_text(tick_hz) + " Hz",
                 "lower the rate or make time.step smaller", decl.place};
  for (const model::LogDecl::Column& column : decl.values)
    SL_TRY(ValueExpression::compile(simulation, column.expression, column.place));
  return {};
}

Result<std::unique_ptr<CsvLog>> CsvLog::open(const Simulation& simulation, const model::LogDecl& decl) {
  SL_TRY(check(simulation, decl));
  auto log = std::unique_ptr<CsvLog>(new CsvLog(simulation, decl.file, decl.rate_hz));
  for (const model::LogDecl::Column& column : decl.values) {
    SL_ASSIGN(ValueExpression expression,
              ValueExpression::compile(simulation, column.expression, column.place));
    log->columns_.push_back(std::move(expression));
  }
  const auto unwritable = [&] {
    return Error{"cannot write the log '" + decl.file + "': " + std::strerror(errno), "", decl.place};
  };
  log->created_ = ::access(decl.file.c_str(), F_OK) != 0;
  log->file_ = ::open(decl.file.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0666);
  if (log->file_ < 0) return unwritable();
  return log;
}

Status CsvLog::begin() {
  begun_ = true;
  // Devices such as /dev/stdout cannot be cut and need not be.
  if (::ftruncate(file_, 0) != 0 && errno != EINVAL)
    return status_ = Error{"cannot write the log '" + path_ + "': " + std::strerror(errno)};
  held_ = "time";
  for (const ValueExpression& column : columns_) {
    const std::string unit = column.unit();
    held_ += "," + csv_field(column.text() + (unit.empty() || unit == "1" ? "" : " [" + unit + "]"));
  }
  held_ += '\n';
  start_ = simulation_.now();
  taken_ = 0;
  sample();
  flush();
  return status_;
}

void CsvLog::on_frame(const std::shared_ptr<const Frame>&) {
  if (rate_hz_ > 0 && simulation_.now() < due_time(start_, taken_, rate_hz_)) return;
  sample();
}

void CsvLog::sample() {
  if (!status_) return;
  ++taken_;
  append_number(held_, simulation_.now().s());
  for (ValueExpression& column : columns_) {
    held_ += ',';
    if (const auto result = column.evaluate()) append_number(held_, result->value);
  }
  held_ += '\n';
  if (held_.size() > hold_bytes) flush();
}

void CsvLog::flush() {
  std::size_t done = 0;
  while (status_ && done < held_.size()) {
    const ssize_t n = ::write(file_, held_.data() + done, held_.size() - done);
    if (n > 0) done += static_cast<std::size_t>(n);
    else if (errno != EINTR) status_ = Error{"cannot write the log '" + path_ + "': " + std::strerror(errno)};
  }
  held_.clear();
}

Status CsvLog::finish() {
  if (file_ < 0) return status_;
  flush();
  // Some file systems tell only here that the disk was full.
  if (::close(std::exchange(file_, -1)) != 0 && status_ && errno != EINTR)
    status_ = Error{"cannot write the log '" + path_ + "': " + std::strerror(errno)};
  return status_;
}

}  // namespace sandlot
