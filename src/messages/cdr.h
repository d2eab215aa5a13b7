#pragma once
/// Messages as CDR, the bytes of ROS 2 on the network and in recordings.
///
/// Format   plain XCDR1: 4 bytes that tell the encapsulation (00 01 00 00: little-endian), then the fields in order,
///          each number aligned to its size, counted from after those 4 bytes. A string is a 32-bit length that counts
///          a closing NUL, and its letters; a sequence a 32-bit count and its elements; a message without fields
///          one byte. Written little-endian, read in both orders.
/// Errors   bytes that end too soon, a length that more bytes would be needed for, a string without NUL, another
///          encapsulation: named with the field. Bytes after the message are left alone (senders pad to 4).
/// Limits   no parameter lists, no XCDR2, no wide strings. A Time beyond +-68 years is written as the nearest that fits.
/// Cost     writing into a buffer that has the room allocates nothing.
/// Source   OMG DDS-XTYPES 1.3, section 7.4.1 (XCDR version 1).
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "messages/info.h"

namespace sandlot {

/// Replaces what `out` holds by the CDR of `message`.
void write_cdr(const MessageInfo& info, const void* message, std::vector<std::byte>& out);

/// Fills `message`. When it fails, `message` is left half filled: read into a fresh one.
Status read_cdr(const MessageInfo& info, std::span<const std::byte> bytes, void* message);

/// The steps of a walk through the CDR of a message. Numbers are little-endian whatever they were in the bytes.
class CdrVisitor {
 public:
  virtual ~CdrVisitor() = default;
  virtual void open(const MessageInfo& info) = 0;     ///< a message begins
  virtual void close() = 0;                           ///< it ends
  virtual void field(const MessageField& field) = 0;  ///< what comes next is its value
  virtual void open_list(std::size_t size) = 0;       ///< elements that are strings or messages
  virtual void close_list() = 0;
  virtual void text(std::string_view text) = 0;
  virtual void number(Wire type, const std::byte* value) = 0;
  /// A list of numbers at once: `bytes.size() / size_of(type)` of them.
  virtual void numbers(Wire type, std::span<const std::byte> bytes) = 0;
};

/// Walks through the CDR of a message whose type need not be known at compile time. What was visited before an error
/// has been visited.
Status walk_cdr(const MessageInfo& info, std::span<const std::byte> bytes, CdrVisitor& visitor);

/// The number that `value` points at.
double number_at(Wire type, const std::byte* value);

}  // namespace sandlot
