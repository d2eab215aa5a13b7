#pragma once
/// Reader of MCAP files: by their index where there is one, else by walking through them once.
///
///   SL_ASSIGN(mcap::Reader reader, mcap::Reader::open("r.mcap"));
///   mcap::Cursor cursor = reader.messages({.from = 2'000'000'000, .topics = {"/rover/laser/ranges"}});
///   for (;;) {
///     SL_ASSIGN(const mcap::Message* message, cursor.next());
///     if (!message) break;
///     ...
///   }
///
/// Order    by log time; messages of one time in the order of the file.
/// Units    times in nanoseconds.
/// Errors   `file: damaged at byte N: what`. Every checksum of what is read is checked. A file that lacks its end is
///          read up to there; trouble() says so.
/// Cost     holds the chunks whose times overlap: one or two in recordings of ours, Limits::max_loaded at most.
#include <optional>

#include "record/mcap/walk.h"

namespace sandlot::mcap {

struct Message {
  const Channel* channel = nullptr;
  std::uint32_t sequence = 0;
  std::uint64_t log_time = 0, publish_time = 0;
  std::span<const std::byte> data;  ///< valid until the next one
};

struct Query {
  std::uint64_t from = 0;                ///< first log time
  std::uint64_t to = UINT64_MAX;         ///< last log time
  std::vector<std::string> topics = {};  ///< empty: all
};

class Reader;

/// Goes through the messages of a Reader, which must outlive it.
class Cursor {
 public:
  /// The next message, or null at the end.
  Result<const Message*> next();

 private:
  friend class Reader;
  struct Entry {
    std::uint64_t time = 0, at = 0;
  };
  struct Loaded {
    std::uint64_t offset = 0;  ///< of the chunk in the file
    std::vector<std::byte> records;
    std::vector<Entry> entries;  ///< in the order of time
    std::size_t next = 0;
    const Entry& front() const { return entries[next]; }
  };
  Status load(std::size_t source);

  const Reader* reader_ = nullptr;
  Query query_;
  std::vector<bool> wanted_;          ///< by channel
  std::vector<std::size_t> sources_;  ///< chunks that may hold wanted messages, in the order of their begin
  std::size_t next_source_ = 0;
  std::vector<Loaded> loaded_;  ///< a heap, the earliest message on top
  std::uint64_t loaded_bytes_ = 0;
  ChunkContent content_;
  Message message_;
};

class Reader {
 public:
  static Result<Reader> open(const std::string& path, const Limits& limits = {});

  const Header& header() const { return header_; }
  /// Schemas, channels, counts, attachments, metadata; statistics are always there.
  const Summary& summary() const { return summary_; }
  /// False: the file was walked through, since it has no usable index.
  bool indexed() const { return indexed_; }
  /// Why the walk ended before the end of the data, if it did: what lies behind is not seen.
  const std::optional<Error>& trouble() const { return trouble_; }

  Cursor messages(Query query) const;
  /// The data of the first attachment of that name; an error when there is none.
  Result<std::vector<std::byte>> attachment(const std::string& name) const;
  Result<TextMap> metadata(const std::string& name) const;
  const Schema* schema_of(const Channel& channel) const;
  const Channel* find_channel(const std::string& topic) const;
  const InputFile& file() const { return file_; }

 private:
  friend class Cursor;
  struct Source {
    std::uint64_t start_time = 0, end_time = 0, offset = 0;
    std::uint64_t loose_length = 0;  ///< 0: a chunk; else records that stand in no chunk
  };
  explicit Reader(InputFile file, const Limits& limits) : file_(std::move(file)), limits_(limits) {}
  Status walk();

  InputFile file_;
  Limits limits_;
  Header header_;
  Summary summary_;
  std::vector<Source> sources_;
  bool indexed_ = false;
  std::optional<Error> trouble_;
};

/// The summary section as the file gives it; nothing when it has none, an error when it is damaged.
Result<std::optional<Summary>> read_summary(const InputFile& file, const Limits& limits);

}  // namespace sandlot::mcap
