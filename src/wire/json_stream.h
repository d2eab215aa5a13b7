#pragma once
/// JSON objects one behind the other in a stream of bytes, as rosbridge clients over TCP send them. Nothing else is judged: what an
/// object says is for its reader.
///
/// Errors   anything but blanks between two objects; an object longer than `limit`.
/// Cost     each byte is looked at once.
#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "base/result.h"

namespace sandlot::wire {

class JsonStream {
 public:
  explicit JsonStream(std::size_t limit) : limit_(limit) {}

  void append(std::string_view bytes) { buffer_.append(bytes); }
  /// The next whole object, valid until the next call. Nothing: it is not complete yet.
  Result<std::optional<std::string_view>> next() {
    buffer_.erase(0, taken_);
    at_ -= taken_;
    taken_ = 0;
    while (at_ < buffer_.size()) {
      const char c = buffer_[at_];
      if (depth_ == 0) {
        const bool blank = c == ' ' || c == '\n' || c == '\r' || c == '\t';
        if (!blank && c != '{') return Error{"expected a JSON object"};
        if (blank) {
          buffer_.erase(0, 1);
          continue;
        }
      }
      ++at_;
      if (quoted_) {
        if (escaped_) escaped_ = false;
        else if (c == '\\') escaped_ = true;
        else if (c == '"') quoted_ = false;
      } else if (c == '"') {
        quoted_ = true;
      } else if (c == '{') {
        ++depth_;
      } else if (c == '}' && --depth_ == 0) {
        taken_ = at_;
        return std::optional(std::string_view(buffer_).substr(0, at_));
      }
      if (at_ > limit_) return Error{"an object of more than " + std::to_string(limit_) + " bytes"};
    }
    return std::optional<std::string_view>();
  }
  std::size_t waiting() const { return buffer_.size(); }

 private:
  std::size_t limit_;
  std::string buffer_;
  std::size_t at_ = 0, taken_ = 0;
  std::size_t depth_ = 0;
  bool quoted_ = false, escaped_ = false;
};

}  // namespace sandlot::wire
