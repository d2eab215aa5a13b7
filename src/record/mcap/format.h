#pragma once
/// The records of an MCAP file (version 0) as plain structs, each with one list of its members from which reading
/// and writing follow.
///
///   magic Header { Chunk MessageIndex* | Attachment | Metadata | Schema | Channel | Message }* DataEnd
///   Schema* Channel* Statistics ChunkIndex* AttachmentIndex* MetadataIndex* SummaryOffset* Footer magic
///
/// Each record is an opcode, the length of its content as u64, and the content; numbers are little-endian.
///
/// Units    times in nanoseconds, offsets and lengths in bytes.
/// Errors   get() leaves the reader failed when the content is shorter than its members.
/// Source   https://mcap.dev/spec
#include <array>
#include <cstdint>
#include <map>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/bytes.h"

namespace sandlot::mcap {

inline constexpr std::array<std::uint8_t, 8> magic{0x89, 'M', 'C', 'A', 'P', '0', '\r', '\n'};
inline constexpr std::uint64_t record_head = 9;  ///< opcode and length

enum class Op : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  attachment = 0x09,
  attachment_index = 0x0a,
  statistics = 0x0b,
  metadata = 0x0c,
  metadata_index = 0x0d,
  summary_offset = 0x0e,
  data_end = 0x0f,
};

using TextMap = std::map<std::string, std::string>;

struct Header {
  std::string profile, library;
  static void members(auto& s, auto&& v) { v(s.profile), v(s.library); }
};

struct Footer {
  std::uint64_t summary_start = 0;  ///< 0: there is no summary
  std::uint64_t summary_offset_start = 0;
  std::uint32_t summary_crc = 0;  ///< from summary_start through the two members above; 0: not given
  static void members(auto& s, auto&& v) { v(s.summary_start), v(s.summary_offset_start), v(s.summary_crc); }
};

struct Schema {
  std::uint16_t id = 0;  ///< never 0
  std::string name, encoding;
  std::vector<std::byte> data;
  static void members(auto& s, auto&& v) { v(s.id), v(s.name), v(s.encoding), v(s.data); }
  bool operator==(const Schema&) const = default;
};

struct Channel {
  std::uint16_t id = 0;
  std::uint16_t schema = 0;  ///< 0: none
  std::string topic, message_encoding;
  TextMap metadata;
  static void members(auto& s, auto&& v) {
    v(s.id), v(s.schema), v(s.topic), v(s.message_encoding), v(s.metadata);
  }
  bool operator==(const Channel&) const = default;
};

/// What stands before the data of a message, which takes the rest of the record.
struct MessageHead {
  static constexpr std::uint64_t size = 22;
  std::uint16_t channel = 0;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0, publish_time = 0;
  static void members(auto& s, auto&& v) { v(s.channel), v(s.sequence), v(s.log_time), v(s.publish_time); }
};

/// What stands before the stored records of a chunk.
struct ChunkHead {
  std::uint64_t start_time = 0, end_time = 0;  ///< of its messages; 0 when it has none
  std::uint64_t uncompressed_size = 0;
  std::uint32_t crc = 0;  ///< of the uncompressed records; 0: not given
  std::string compression;
  std::uint64_t stored_size = 0;
  static void members(auto& s, auto&& v) {
    v(s.start_time), v(s.end_time), v(s.uncompressed_size), v(s.crc), v(s.compression), v(s.stored_size);
  }
};

struct MessageIndex {
  std::uint16_t channel = 0;
  std::vector<std::pair<std::uint64_t, std::uint64_t>> records;  ///< log time, offset in the chunk's records
  static void members(auto& s, auto&& v) { v(s.channel), v(s.records); }
};

struct ChunkIndex {
  std::uint64_t start_time = 0, end_time = 0;
  std::uint64_t offset = 0, length = 0;                          ///< of the whole record
  std::map<std::uint16_t, std::uint64_t> message_index_offsets;  ///< channel -> offset in the file
  std::uint64_t message_index_length = 0;                        ///< of all message indexes of the chunk
  std::string compression;
  std::uint64_t compressed_size = 0, uncompressed_size = 0;
  static void members(auto& s, auto&& v) {
    v(s.start_time), v(s.end_time), v(s.offset), v(s.length), v(s.message_index_offsets);
    v(s.message_index_length), v(s.compression), v(s.compressed_size), v(s.uncompressed_size);
  }
  bool operator==(const ChunkIndex&) const = default;
};

/// What stands before the data of an attachment; after the data comes the CRC of everything before it.
struct AttachmentHead {
  std::uint64_t log_time = 0, create_time = 0;
  std::string name, media_type;
  std::uint64_t data_size = 0;
  static void members(auto& s, auto&& v) {
    v(s.log_time), v(s.create_time), v(s.name), v(s.media_type), v(s.data_size);
  }
};

struct AttachmentIndex {
  std::uint64_t offset = 0, length = 0;  ///< of the whole record
  std::uint64_t log_time = 0, create_time = 0, data_size = 0;
  std::string name, media_type;
  static void members(auto& s, auto&& v) {
    v(s.offset), v(s.length), v(s.log_time), v(s.create_time), v(s.data_size), v(s.name), v(s.media_type);
  }
  bool operator==(const AttachmentIndex&) const = default;
};

struct Metadata {
  std::string name;
  TextMap values;
  static void members(auto& s, auto&& v) { v(s.name), v(s.values); }
};

struct MetadataIndex {
  std::uint64_t offset = 0, length = 0;  ///< of the whole record
  std::string name;
  static void members(auto& s, auto&& v) { v(s.offset), v(s.length), v(s.name); }
  bool operator==(const MetadataIndex&) const = default;
};

struct Statistics {
  std::uint64_t message_count = 0;
  std::uint16_t schema_count = 0;
  std::uint32_t channel_count = 0, attachment_count = 0, metadata_count = 0, chunk_count = 0;
  std::uint64_t start_time = 0, end_time = 0;  ///< of all messages; 0 when there are none
  std::map<std::uint16_t, std::uint64_t> channel_message_counts;
  static void members(auto& s, auto&& v) {
    v(s.message_count), v(s.schema_count), v(s.channel_count), v(s.attachment_count), v(s.metadata_count);
    v(s.chunk_count), v(s.start_time), v(s.end_time), v(s.channel_message_counts);
  }
  bool operator==(const Statistics&) const = default;
};

struct SummaryOffset {
  std::uint8_t group = 0;  ///< opcode
  std::uint64_t start = 0, length = 0;
  static void members(auto& s, auto&& v) { v(s.group), v(s.start), v(s.length); }
};

template <class T>
concept Record = requires(T& t) {
  T::members(t, [](auto&) {});
};

template <class T>
void put(ByteWriter& w, const T& value) {
  if constexpr (Record<T>) {
    T::members(value, [&](const auto& member) { put(w, member); });
  } else if constexpr (requires { typename T::value_type::second_type; }) {  // a map or a list of pairs
    const std::size_t at = w.size();
    put(w, std::uint32_t{0});
    for (const auto& [key, second] : value) put(w, key), put(w, second);
    const auto size = static_cast<std::uint32_t>(w.size() - at - 4);
    w.patch(at, size);
  } else {
    write(w, value);  // numbers; text and bytes after their length as u32
  }
}

template <class T>
void get(ByteReader& r, T& value) {
  if constexpr (Record<T>) {
    T::members(value, [&](auto& member) { get(r, member); });
  } else if constexpr (requires { typename T::value_type::second_type; }) {
    std::uint32_t size = 0;
    read(r, size);
    ByteReader part(r.take(size));
    while (r.ok() && part.ok() && part.remaining() > 0) {
      std::remove_const_t<typename T::value_type::first_type> key{};
      typename T::value_type::second_type second{};
      get(part, key), get(part, second);
      if constexpr (requires { typename T::mapped_type; })
        value.insert_or_assign(std::move(key), std::move(second));
      else value.emplace_back(std::move(key), std::move(second));
    }
    if (!part.ok()) r.fail();
  } else {
    read(r, value);
  }
}

/// Appends a record: opcode, length, and what `fill` writes.
template <class Fill>
void put_record_of(ByteWriter& w, Op op, Fill&& fill) {
  put(w, static_cast<std::uint8_t>(op));
  const std::size_t at = w.size();
  put(w, std::uint64_t{0});
  fill();
  const std::uint64_t size = w.size() - at - 8;
  w.patch(at, size);
}
template <class T>
void put_record(ByteWriter& w, Op op, const T& content) {
  put_record_of(w, op, [&] { put(w, content); });
}

/// What the summary at a file's end says, or what a walk through the file found out.
struct Summary {
  std::map<std::uint16_t, Schema> schemas;
  std::map<std::uint16_t, Channel> channels;
  std::vector<ChunkIndex> chunks;
  std::vector<AttachmentIndex> attachments;
  std::vector<MetadataIndex> metadata;
  Statistics statistics;

  /// Enters a chunk and counts its messages.
  void add_chunk(ChunkIndex chunk, std::span<const MessageIndex* const> indexes);
};

/// Appends the message indexes of a chunk and completes the chunk's entry for the summary.
/// @param indexes  in the order of channels
/// @param offset   where in the file the first byte goes
void put_message_indexes(ByteWriter& w, std::span<const MessageIndex* const> indexes, std::uint64_t offset,
                         ChunkIndex& chunk);

/// Appends everything after the last record of data: DataEnd, the summary, Footer and magic.
/// @param offset    where in the file the first byte of `w` goes
/// @param data_crc  of the file up to there
void put_end(ByteWriter& w, Summary& summary, std::uint64_t offset, std::uint32_t data_crc);

}  // namespace sandlot::mcap
