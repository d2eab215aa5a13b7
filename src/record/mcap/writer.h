#pragma once
/// Writer of an MCAP file, version 0: chunks with message indexes, attachments, metadata, and at the end the summary.
///
///   SL_ASSIGN(mcap::Writer writer, mcap::Writer::create("out.mcap", {}));
///   const auto schema = writer.add_schema("std_msgs/msg/Float64", "ros2msg", text);
///   const auto channel = writer.add_channel(schema, "/speed", "cdr");
///   SL_TRY(writer.write(channel, time_ns, bytes));
///   SL_TRY(writer.finish());
///
/// A chunk is closed when it holds `chunk_bytes` of records or spans `chunk_span_ns` of log time, and handed to the
/// kernel with one write(): a process that is killed loses the open chunk, nothing else. Schemas and channels stand
/// in the chunk where they are first used, and again in the summary.
///
/// Units    times in nanoseconds.
/// Errors   name the file and the reason. After the first one nothing more is written but an attempt at the end, so
///          that what is there can be read; all later calls give the same error.
/// Limits   65,535 schemas and as many channels; a message smaller than 1 GiB.
/// Cost     one copy of each message, its compression and two checksums; index entries of 16 bytes per message of
///          the open chunk, about 100 bytes per closed one.
#include "record/mcap/codec.h"
#include "record/mcap/file.h"
#include "record/mcap/format.h"

namespace sandlot::mcap {

struct WriterOptions {
  Compression compression = Compression::lz4;
  std::uint64_t chunk_bytes = std::uint64_t{1} << 20;
  std::uint64_t chunk_span_ns = 1'000'000'000;
  Header header{"ros2", "sandlot"};
};

class Writer {
 public:
  static Result<Writer> create(const std::string& path, const WriterOptions& options);

  /// @return the schema's id
  std::uint16_t add_schema(std::string name, std::string encoding, std::string_view text);
  /// Ids have 16 bits. @return whether there is one for a further channel
  bool has_room() const { return summary_.channels.size() + 1 < 0xffff; }
  /// @param schema  0: none
  /// @pre has_room()
  /// @return the channel's id
  std::uint16_t add_channel(std::uint16_t schema, std::string topic, std::string message_encoding,
                            TextMap metadata = {});
  /// Log and publish time are the same, the sequence numbers of a channel count from 0.
  Status write(std::uint16_t channel, std::uint64_t time_ns, std::span<const std::byte> data);
  Status attach(const std::string& name, const std::string& media_type, std::uint64_t time_ns,
                std::span<const std::byte> data);
  Status add_metadata(const std::string& name, const TextMap& values);
  /// Closes the open chunk.
  Status flush();
  /// Writes the end and closes the file.
  Status finish();

  const Summary& summary() const { return summary_; }
  std::uint64_t bytes_written() const { return offset_; }
  /// What the open chunk holds.
  std::uint64_t bytes_pending() const { return chunk_.size(); }
  OutputFile& file() { return file_; }

 private:
  struct PerChannel {
    std::uint32_t sequence = 0;
    bool written = false;  ///< its record stands in some chunk
    MessageIndex index;    ///< of the open chunk
  };
  Writer(OutputFile file, const WriterOptions& options);
  Status hand_over(std::span<const std::byte> bytes);

  OutputFile file_;
  WriterOptions options_;
  Compressor compressor_;
  Summary summary_;
  std::vector<PerChannel> channels_;    ///< by id
  std::vector<bool> schema_written_;    ///< by id
  std::vector<std::uint16_t> touched_;  ///< channels with messages in the open chunk
  ByteWriter chunk_;
  ChunkHead chunk_head_;
  ByteWriter out_;
  std::uint64_t offset_ = 0;
  std::uint32_t data_crc_ = 0;
  Status status_;
  bool finished_ = false;
};

}  // namespace sandlot::mcap
