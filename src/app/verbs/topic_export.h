#pragma once
/// Export of numbers from a recording to a CSV file.
///
/// A row per time at which one of the topics has a message: `time` [s] first, then per column the value of
/// the latest message so far; nothing before the first one and where a list is too short. A topic by itself
/// stands for all numbers that its first message holds.
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"

namespace sandlot::app {

struct ExportOptions {
  std::string recording, out;
  std::vector<std::string> values;  ///< "/rover/laser/ranges.ranges[3]" or "/rover/laser/ranges"
  std::optional<double> from_s, to_s;
};
int topic_export(const ExportOptions& options);

/// Request for numbers of one topic.
struct WantedTopic {
  std::string topic;
  std::vector<std::string> paths;  ///< empty: all numbers
};
/// Splits "/topic.path" behind the longest known topic. Errors name the nearest topic.
Result<std::vector<WantedTopic>> wanted_topics(std::span<const std::string> values,
                                               std::span<const std::string> topics);

/// Rows of a CSV file from values in order of time; each column holds its latest value.
class HeldColumns {
 public:
  /// @return the number of the column
  std::size_t add(std::string name);
  std::size_t size() const { return names_.size(); }
  std::string header() const;
  /// A message at `time_ns` begins: the row of an earlier time goes to `out`, and the columns begin..end lose
  /// their value.
  void message(std::uint64_t time_ns, std::size_t begin, std::size_t end, std::string& out);
  void set(std::size_t column, double value) { cells_[column] = value; }
  /// The last row.
  void finish(std::string& out);

 private:
  void row(std::string& out);
  std::vector<std::string> names_;
  std::vector<std::optional<double>> cells_;
  std::optional<std::uint64_t> time_ns_;
};

}  // namespace sandlot::app
