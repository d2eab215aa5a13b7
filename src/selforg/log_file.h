#pragma once
/// Log file of named values over time, in the text format of selforg's tools: one line of names, one line of numbers per step.
///
///   # Start date: -                         comments begin with '#'
///   #IN sox                                 name of what is logged
///   # Recording every 5th dataset
///   # epsC= 0.1                             parameters
///   #######
///   #C t x[0] x[1] y[0] A[0,0] ...          names of the columns; the first is the time in s
///   0.05 0.1 0.2 -0.3 0.5                   values
///   # epsC=0.2                              a parameter that changed
///
/// Numbers   the shortest text that reads back as the same double.
/// Heap      a line is put together in memory that is kept; the text of a number is made without heap.
#include <fstream>
#include <string>
#include <vector>

#include "base/result.h"
#include "selforg/controller.h"

namespace sandlot::selforg {

struct LogSpec {
  int interval = 5;  ///< steps per line
  /// Channels to write: patterns as of base/text.h, "A*"; a pattern that begins with '-' leaves channels out; empty: all.
  std::vector<std::string> channels;
};

class WiredController;

class LogFile {
 public:
  /// Opens the file and writes the header.
  Status open(const std::string& path, const LogSpec& spec, const Controller& controller);
  Status open(const std::string& path, const LogSpec& spec, const WiredController& agent);
  bool is_open() const { return out_.is_open(); }
  /// A line with the values, if one is due.
  void step(double time_s, const Controller& controller);
  void step(double time_s, const WiredController& agent);
  /// A comment of one line; line breaks become blanks.
  void comment(std::string_view text);
  /// Writes what is buffered; an error when the disk did not take it all.
  Status close();

 private:
  template <class Source>
  Status open_for(const std::string& path, const LogSpec& spec, const Source& source,
                  const Controller& controller);
  template <class Source>
  void write_step(double time_s, const Source& source);
  bool wanted(std::string_view name) const;
  LogSpec spec_;
  std::string path_, line_;
  std::ofstream out_;
  std::vector<bool> chosen_;
  std::uint64_t steps_ = 0;
};

struct LogTable {
  std::vector<std::string> columns;
  std::vector<std::vector<double>> rows;
  std::vector<std::string> comments;
};
/// Reads such a file of at most 1 GiB, with 100,000 columns at most. Errors name the line.
Result<LogTable> read_log(const std::string& path);
/// The same from its text. @param name  of the file, for messages
Result<LogTable> read_log_text(std::string_view text, const std::string& name);

}  // namespace sandlot::selforg
