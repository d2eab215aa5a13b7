#pragma once
/// Walk through the records of an MCAP file from its beginning, with all checks: used by repairs and examinations, and to
/// read files without a summary.
///
/// Errors   `file: damaged at byte N: what`. One damaged piece does not hide those behind it: see resume().
/// Limits   Limits below; a file cannot make us hold more than one chunk of that size.
/// Cost     every chunk is decompressed.
#include <functional>

#include "record/mcap/file.h"
#include "record/mcap/format.h"

namespace sandlot::mcap {

/// What a file may ask for. Everything else is bounded by its size.
struct Limits {
  std::uint64_t max_chunk = std::uint64_t{512} << 20;       ///< records of one chunk, uncompressed
  std::uint64_t max_attachment = std::uint64_t{512} << 20;  ///< held in memory when it is read
  std::uint64_t max_summary = std::uint64_t{512} << 20;
  std::uint64_t max_loaded = std::uint64_t{1} << 30;  ///< chunks held at once because their times overlap
};

/// The uncompressed records of a chunk, and where the messages of each channel stand in them.
struct ChunkContent {
  ChunkHead head;
  std::vector<std::byte> records;
  std::vector<MessageIndex> indexes;  ///< in the order of channels, records in file order
  std::vector<const MessageIndex*> index_list() const;
};

/// One record within a chunk or a file.
struct RecordView {
  Op op{};
  std::uint64_t offset = 0;  ///< of the opcode
  std::span<const std::byte> content;
};
/// The next record of `records` at `offset`, which moves behind it. @return false at the end, or when the record
/// does not fit (then `offset` stays)
bool next_record(std::span<const std::byte> records, std::uint64_t& offset, RecordView& record);

/// Reads the chunk at `offset`, checks its checksum, its sizes, and that its times are those of its messages.
/// `definition` is called for the schemas and channels in it; its errors are passed on.
/// @param definition  Status(const RecordView&)
using Definition = std::function<Status(const RecordView&)>;
Status load_chunk(const InputFile& file, std::uint64_t offset, const Limits& limits,
                  const Definition& definition, ChunkContent& out);

class Walk {
 public:
  /// Checks the magic and reads the header.
  static Result<Walk> begin(const InputFile& file, const Limits& limits);

  struct Piece {
    enum class Kind { chunk, loose, attachment, metadata, other, end } kind = Kind::end;
    std::uint64_t offset = 0, length = 0;  ///< in the file; of a chunk without its message indexes
    ChunkContent content;                  ///< chunk; loose: schemas, channels and messages outside chunks
    AttachmentIndex attachment;
    MetadataIndex metadata;
    std::uint32_t data_crc = 0;  ///< end: as the file gives it
  };
  /// The next piece; `end` is the DataEnd record. After an error offset() is where the damage is.
  Status next(Piece& piece);
  std::uint64_t offset() const { return offset_; }
  /// After an error: goes on behind the damage. False when there is nothing more that could be read.
  bool resume();

  const Header& header() const { return header_; }
  /// Takes definitions from a summary: a chunk that held them may be damaged.
  void know(const Summary& summary);
  /// Of everything passed so far.
  const std::map<std::uint16_t, Schema>& schemas() const { return schemas_; }
  const std::map<std::uint16_t, Channel>& channels() const { return channels_; }

 private:
  Walk(const InputFile& file, const Limits& limits) : file_(&file), limits_(limits) {}
  struct RecordHead {
    Op op{};
    std::uint64_t length = 0;  ///< with the head
  };
  Result<RecordHead> head_at(std::uint64_t offset) const;
  Status define(const RecordView& record, std::uint64_t place);
  Status read_loose(Piece& piece);
  Status check_message_index(const RecordHead& head, const ChunkContent& chunk);
  Status read_attachment(const RecordHead& head, Piece& piece) const;
  Status read_metadata(const RecordHead& head, Piece& piece) const;

  const InputFile* file_;
  Limits limits_;
  std::uint64_t offset_ = 0;
  int failed_guesses_ = 0;
  Header header_;
  std::map<std::uint16_t, Schema> schemas_;
  std::map<std::uint16_t, Channel> channels_;
};

/// The record at `offset`, which must be of the kind `op`, read whole; at most `limit` bytes.
Result<std::vector<std::byte>> read_record(const InputFile& file, std::uint64_t offset, Op op,
                                           std::uint64_t limit);

/// The checksum of [begin, end) of a file.
Result<std::uint32_t> crc_of(const InputFile& file, std::uint64_t begin, std::uint64_t end);

}  // namespace sandlot::mcap
