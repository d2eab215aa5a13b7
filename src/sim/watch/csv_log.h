#pragma once
/// CSV log: named values and expressions of a run, written to a file while it runs.
///
/// File    one line of names, then a line per sample: simulated time [s] first, then a number per column, as short as
///         reads back exactly; `inf` and `nan` as they are, nothing where there is no value. A column that is a single
///         address has its unit behind it: `rover.pose.x [m]`. Commas and quotes as in RFC 4180.
/// Time    samples are taken at the first tick not before k / rate, at the end of the tick; the first one at the start.
/// Errors  open() checks path and expressions and leaves an existing file alone; begin() replaces it. A write that
///         fails (a full disk) stays in status(); what was written before is kept.
#include <memory>
#include <string>
#include <vector>

#include "sim/watch/values.h"

namespace sandlot {

class CsvLog final : public Observer {
 public:
  /// Checks everything but the file.
  static Status check(const Simulation& simulation, const model::LogDecl& decl);
  static Result<std::unique_ptr<CsvLog>> open(const Simulation& simulation, const model::LogDecl& decl);
  ~CsvLog() override;
  CsvLog(const CsvLog&) = delete;
  CsvLog& operator=(const CsvLog&) = delete;

  /// Empties the file, writes the names and the first line.
  Status begin();
  void on_frame(const std::shared_ptr<const Frame>& frame) override;
  /// The error of the first write that failed.
  const Status& status() const { return status_; }
  /// Writes what is still held back.
  Status finish();

 private:
  CsvLog(const Simulation& simulation, std::string path, double rate_hz);
  void sample();
  void flush();

  const Simulation& simulation_;
  std::string path_;
  double rate_hz_;
  int file_ = -1;
  bool created_ = false, begun_ = false;
  std::vector<ValueExpression> columns_;
  Time start_;
  std::int64_t taken_ = 0;
  std::string held_;
  Status status_;
};

/// A field of a CSV line, quoted where it must be.
std::string csv_field(std::string_view text);

}  // namespace sandlot
