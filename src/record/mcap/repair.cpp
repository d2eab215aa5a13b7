#include "record/mcap/repair.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "record/mcap/codec.h"

namespace sandlot::mcap {
namespace {

using PieceKind = Walk::Piece::Kind;

/// Walks through a file from beginning to end, over damages. `visit(piece)` gets what is whole.
/// @return where the data end when a DataEnd record said so
template <class Visit>
Result<std::optional<Walk::Piece>> for_each_piece(Walk& walk, const InputFile& file,
                                                  std::vector<Damage>& damages, Visit&& visit) {
  Walk::Piece piece;
  for (;;) {
    if (Status status = walk.next(piece); !status) {
      const std::uint64_t at = walk.offset();
      // A file that just stops is not damaged there: it lacks its end.
      if (at == file.size()) return std::optional<Walk::Piece>();
      const bool more = walk.resume();
      damages.push_back({at, (more ? walk.offset() : file.size()) - at, status.error().what, !more});
      if (!more) return std::optional<Walk::Piece>();
      continue;
    }
    if (piece.kind == PieceKind::end) return std::optional(std::move(piece));
    SL_TRY(visit(piece));
  }
}

/// The entry of a chunk as it stands in the file, its message indexes left out.
ChunkIndex entry_of(const Walk::Piece& piece) {
  const ChunkHead& head = piece.content.head;
  return {head.start_time,  head.end_time,    piece.offset,          piece.length, {}, 0,
          head.compression, head.stored_size, head.uncompressed_size};
}

/// What the file says at its end against what is in it. Parts that a foreign writer left out are not an error.
Status compare(const InputFile& file, std::uint64_t at, const Summary& declared, const Summary& found) {
  const auto same_part = [](const auto& declared_part, const auto& found_part) {
    return std::all_of(declared_part.begin(), declared_part.end(), [&](const auto& one) {
      const auto same = found_part.find(one.first);
      return same != found_part.end() && same->second == one.second;
    });
  };
  const auto bare = [](std::vector<ChunkIndex> chunks) {
    for (ChunkIndex& chunk : chunks) chunk.message_index_offsets.clear(), chunk.message_index_length = 0;
    return chunks;
  };
  const auto wrong = [&](const char* what) {
    return file.damaged(at, std::string("the summary has other ") + what + " than the data");
  };
  if (!same_part(declared.schemas, found.schemas)) return wrong("schemas");
  if (!same_part(declared.channels, found.channels)) return wrong("channels");
  if (!declared.chunks.empty() && bare(declared.chunks) != bare(found.chunks)) return wrong("chunks");
  if (!declared.attachments.empty() && declared.attachments != found.attachments) return wrong("attachments");
  if (!declared.metadata.empty() && declared.metadata != found.metadata) return wrong("metadata");
  const Statistics& t = declared.statistics;
  const Statistics& f = found.statistics;
  if (t.message_count != f.message_count || t.chunk_count != f.chunk_count || t.start_time != f.start_time ||
      t.end_time != f.end_time || t.attachment_count != f.attachment_count ||
      t.metadata_count != f.metadata_count)
    return wrong("counts");
  return {};
}

Status check_end(const InputFile& file, const Walk::Piece& end, const Limits& limits, const Summary& found) {
  if (end.data_crc != 0) {
    SL_ASSIGN(const std::uint32_t crc, crc_of(file, 0, end.offset));
    if (crc != end.data_crc) return file.damaged(end.offset, "the checksum of all data does not fit");
  }
  SL_ASSIGN(const std::optional<Summary> declared, read_summary(file, limits));
  if (!declared) return file.damaged(end.offset + end.length, "there is no summary");
  return compare(file, end.offset + end.length, *declared, found);
}

}  // namespace

Result<Examination> examine(const std::string& path, const Limits& limits) {
  SL_ASSIGN(const InputFile file, InputFile::open(path));
  if (!file.at_rest()) return Error{"'" + path + "' is being written", "wait for the run to end"};
  SL_ASSIGN(Walk walk, Walk::begin(file, limits));
  Examination result;
  result.header = walk.header();
  result.file_bytes = file.size();
  if (const auto declared = read_summary(file, limits); declared && *declared) walk.know(**declared);
  Summary& found = result.found;
  std::uint64_t chunks = 0;
  SL_ASSIGN(const auto end,
            for_each_piece(walk, file, result.damages, [&](const Walk::Piece& piece) -> Status {
              if (piece.kind == PieceKind::attachment) found.attachments.push_back(piece.attachment);
              if (piece.kind == PieceKind::metadata) found.metadata.push_back(piece.metadata);
              if (piece.kind != PieceKind::chunk && piece.kind != PieceKind::loose) return {};
              found.add_chunk(entry_of(piece), piece.content.index_list());
              if (piece.kind == PieceKind::loose) {
                found.chunks.pop_back();
                for (const MessageIndex& index : piece.content.indexes)
                  result.loose_messages += index.records.size();
              } else {
                ++chunks;
              }
              return {};
            }));
  found.schemas = walk.schemas();
  found.channels = walk.channels();
  Statistics& s = found.statistics;
  s.schema_count = static_cast<std::uint16_t>(found.schemas.size());
  s.channel_count = static_cast<std::uint32_t>(found.channels.size());
  s.chunk_count = static_cast<std::uint32_t>(chunks);
  s.attachment_count = static_cast<std::uint32_t>(found.attachments.size());
  s.metadata_count = static_cast<std::uint32_t>(found.metadata.size());
  if (!end) {
    if (result.damages.empty() || !result.damages.back().at_end)
      result.summary_trouble = file.damaged(file.size(), "the recording has no end");
  } else if (Status status = check_end(file, *end, limits, found); !status && result.damages.empty()) {
    result.summary_trouble = status.error();
  }
  return result;
}

Result<Repaired> repair(const std::string& path, Examination before, const Limits& limits) {
  SL_ASSIGN(const InputFile file, InputFile::open(path));
  SL_ASSIGN(Walk walk, Walk::begin(file, limits));
  if (const auto declared = read_summary(file, limits); declared && *declared) walk.know(**declared);
  const std::string part = path + ".repaired";
  SL_ASSIGN(OutputFile out, OutputFile::create(part));
  struct Remove {
    const std::string& file;
    bool armed = true;
    ~Remove() {
      if (armed) std::remove(file.c_str());
    }
  } remove_part{part};

  std::uint64_t offset = 0;
  std::uint32_t crc = 0;
  const auto hand_over = [&](std::span<const std::byte> bytes) -> Status {
    SL_TRY(out.write(bytes));
    offset += bytes.size();
    crc = crc32(bytes, crc);
    return {};
  };
  const auto copy = [&](std::uint64_t begin, std::uint64_t length) -> Status {
    std::vector<std::byte> piece;
    for (std::uint64_t at = begin; at < begin + length; at += piece.size()) {
      piece.resize(static_cast<std::size_t>(std::min(std::uint64_t{1} << 20, begin + length - at)));
      SL_TRY(file.read(at, piece));
      SL_TRY(hand_over(piece));
    }
    return {};
  };

  Summary summary;
  ByteWriter w;
  // A chunk that defined a channel may be among the damaged ones: what later chunks need is written before them.
  const auto define = [&](const ChunkContent& content) {
    std::map<std::uint16_t, bool> own_schemas, own_channels;
    std::uint64_t at = 0;
    RecordView record;
    while (next_record(content.records, at, record)) {
      std::uint16_t id = 0;
      ByteReader r(record.content);
      if (record.op == Op::schema || record.op == Op::channel) get(r, id);
      if (record.op == Op::schema) own_schemas[id] = true;
      if (record.op == Op::channel) own_channels[id] = true;
    }
    const auto define_schema = [&](std::uint16_t id) {
      const auto schema = walk.schemas().find(id);
      if (schema == walk.schemas().end() || !summary.schemas.emplace(*schema).second ||
          own_schemas.contains(id))
        return;
      put_record(w, Op::schema, schema->second);
    };
    for (const MessageIndex& index : content.indexes) {
      const Channel& channel = walk.channels().at(index.channel);
      if (!summary.channels.emplace(index.channel, channel).second) continue;
      define_schema(channel.schema);
      if (!own_channels.contains(index.channel)) put_record(w, Op::channel, channel);
    }
  };

  SL_TRY(copy(0, walk.offset()));
  std::vector<Damage> damages;
  SL_ASSIGN(const auto end, for_each_piece(walk, file, damages, [&](Walk::Piece& piece) -> Status {
              switch (piece.kind) {
                case PieceKind::chunk:
                case PieceKind::loose: {
                  w.clear();
                  if (piece.content.indexes.empty() && piece.kind == PieceKind::loose) return {};
                  define(piece.content);
                  SL_TRY(hand_over(w.bytes()));
                  w.clear();
                  ChunkIndex entry = entry_of(piece);
                  entry.offset = offset;
                  if (piece.kind == PieceKind::loose) {
                    piece.content.head.crc = crc32(piece.content.records);
                    put_record_of(w, Op::chunk, [&] {
                      put(w, piece.content.head);
                      w.raw(piece.content.records.data(), piece.content.records.size());
                    });
                    entry.length = w.size();
                  } else {
                    SL_TRY(copy(piece.offset, piece.length));
                  }
                  const auto indexes = piece.content.index_list();
                  put_message_indexes(w, indexes, offset + w.size(), entry);
                  SL_TRY(hand_over(w.bytes()));
                  summary.add_chunk(std::move(entry), indexes);
                  return {};
                }
                case PieceKind::attachment:
                  piece.attachment.offset = offset;
                  summary.attachments.push_back(piece.attachment);
                  break;
                case PieceKind::metadata:
                  piece.metadata.offset = offset;
                  summary.metadata.push_back(piece.metadata);
                  break;
                case PieceKind::other:
                case PieceKind::end: break;
              }
              return copy(piece.offset, piece.length);
            }));
  // Channels without a message, too: that nothing came is worth knowing.
  summary.schemas.insert(walk.schemas().begin(), walk.schemas().end());
  summary.channels.insert(walk.channels().begin(), walk.channels().end());
  w.clear();
  put_end(w, summary, offset, crc);
  SL_TRY(out.write(w.bytes()));
  SL_TRY(out.sync());
  SL_TRY(out.close());

  Repaired result{std::move(before), summary.statistics.message_count, 0, offset + w.size(), ""};
  for (const Damage& damage : damages) result.lost_bytes += damage.bytes;
  const bool inside = std::any_of(damages.begin(), damages.end(), [](const Damage& d) { return !d.at_end; });
  if (inside) {
    result.kept_original = path + ".damaged";
    if (std::rename(path.c_str(), result.kept_original.c_str()) != 0)
      return Error{"cannot keep '" + path + "' as '" + result.kept_original + "': " + std::strerror(errno)};
  }
  if (std::rename(part.c_str(), path.c_str()) != 0)
    return Error{"cannot replace '" + path + "': " + std::strerror(errno)};
  remove_part.armed = false;
  return result;
}

}  // namespace sandlot::mcap
