#include "record/mcap/reader.h"

#include <algorithm>

#include "record/mcap/codec.h"

namespace sandlot::mcap {
namespace {

constexpr std::uint64_t footer_bytes = record_head + 20;

/// A summary need not repeat schemas and channels, nor index anything: only a complete one replaces the walk.
bool usable(const Summary& summary) {
  const Statistics& s = summary.statistics;
  if (s.chunk_count != summary.chunks.size() || s.attachment_count != summary.attachments.size() ||
      s.metadata_count != summary.metadata.size() || s.channel_count != summary.channels.size())
    return false;
  if (s.message_count > 0 && summary.chunks.empty()) return false;
  std::uint64_t counted = 0;
  for (const auto& [channel, count] : s.channel_message_counts) {
    if (!summary.channels.contains(channel)) return false;
    counted += count;
  }
  return counted == s.message_count;
}

}  // namespace

Result<std::optional<Summary>> read_summary(const InputFile& file, const Limits& limits) {
  const std::uint64_t least = magic.size() + record_head + footer_bytes + magic.size();
  if (file.size() < least) return std::optional<Summary>();
  std::array<std::byte, footer_bytes + magic.size()> tail;
  const std::uint64_t footer_at = file.size() - tail.size();
  SL_TRY(file.read(footer_at, tail));
  std::uint64_t at = 0;
  RecordView record;
  if (!next_record(std::span(tail).first(footer_bytes), at, record) || record.op != Op::footer ||
      std::memcmp(tail.data() + footer_bytes, magic.data(), magic.size()) != 0)
    return std::optional<Summary>();
  Footer footer;
  ByteReader r(record.content);
  get(r, footer);
  if (footer.summary_start == 0) return std::optional<Summary>();
  if (footer.summary_start > footer_at)
    return file.damaged(footer_at, "the summary is not where the footer says");
  if (footer_at - footer.summary_start > limits.max_summary)
    return file.damaged(footer_at, "the summary is too large");
  std::vector<std::byte> bytes(static_cast<std::size_t>(footer_at - footer.summary_start) + footer_bytes - 4);
  SL_TRY(file.read(footer.summary_start, bytes));
  if (footer.summary_crc != 0 && crc32(bytes) != footer.summary_crc)
    return file.damaged(footer.summary_start, "the checksum of the summary does not fit");
  Summary summary;
  at = 0;
  const auto records = std::span(bytes).first(bytes.size() - (footer_bytes - 4));
  while (next_record(records, at, record)) {
    ByteReader content(record.content);
    const auto take = [&](auto found, auto&& keep) {
      get(content, found);
      keep(std::move(found));
    };
    switch (record.op) {
      case Op::schema: take(Schema{}, [&](Schema s) { summary.schemas.emplace(s.id, std::move(s)); }); break;
      case Op::channel:
        take(Channel{}, [&](Channel c) { summary.channels.emplace(c.id, std::move(c)); });
        break;
      case Op::statistics: get(content, summary.statistics); break;
      case Op::chunk_index:
        take(ChunkIndex{}, [&](ChunkIndex c) { summary.chunks.push_back(std::move(c)); });
        break;
      case Op::attachment_index:
        take(AttachmentIndex{}, [&](AttachmentIndex a) { summary.attachments.push_back(std::move(a)); });
        break;
      case Op::metadata_index:
        take(MetadataIndex{}, [&](MetadataIndex m) { summary.metadata.push_back(std::move(m)); });
        break;
      default: break;
    }
    if (!content.ok())
      return file.damaged(footer.summary_start + record.offset, "a record of the summary is too short");
  }
  if (at != records.size())
    return file.damaged(footer.summary_start + at, "the last record of the summary is cut short");
  return std::optional(std::move(summary));
}

Result<Reader> Reader::open(const std::string& path, const Limits& limits) {
  SL_ASSIGN(InputFile file, InputFile::open(path));
  Reader reader(std::move(file), limits);
  SL_ASSIGN(const Walk front, Walk::begin(reader.file_, limits));
  reader.header_ = front.header();
  SL_ASSIGN(std::optional<Summary> summary, read_summary(reader.file_, limits));
  if (summary && usable(*summary)) {
    reader.summary_ = std::move(*summary);
    reader.indexed_ = true;
    for (const ChunkIndex& chunk : reader.summary_.chunks)
      reader.sources_.push_back({chunk.start_time, chunk.end_time, chunk.offset});
  } else {
    SL_TRY(reader.walk());
  }
  std::stable_sort(reader.sources_.begin(), reader.sources_.end(), [](const Source& a, const Source& b) {
    return std::pair(a.start_time, a.offset) < std::pair(b.start_time, b.offset);
  });
  return reader;
}

Status Reader::walk() {
  SL_ASSIGN(Walk walk, Walk::begin(file_, limits_));
  Walk::Piece piece;
  for (;;) {
    if (Status status = walk.next(piece); !status) {
      trouble_ = status.error();
      break;
    }
    if (piece.kind == Walk::Piece::Kind::end) break;
    if (piece.kind == Walk::Piece::Kind::attachment) summary_.attachments.push_back(piece.attachment);
    if (piece.kind == Walk::Piece::Kind::metadata) summary_.metadata.push_back(piece.metadata);
    const bool loose = piece.kind == Walk::Piece::Kind::loose;
    if (!loose && piece.kind != Walk::Piece::Kind::chunk) continue;
    const ChunkHead& head = piece.content.head;
    sources_.push_back({head.start_time, head.end_time, piece.offset, loose ? piece.length : 0});
    ChunkIndex chunk{head.start_time,  head.end_time,    piece.offset,          piece.length, {}, 0,
                     head.compression, head.stored_size, head.uncompressed_size};
    for (const MessageIndex& index : piece.content.indexes)
      chunk.message_index_offsets.emplace(index.channel, 0);
    summary_.add_chunk(std::move(chunk), piece.content.index_list());
    if (loose) summary_.chunks.pop_back();
  }
  summary_.schemas = walk.schemas();
  summary_.channels = walk.channels();
  Statistics& s = summary_.statistics;
  s.schema_count = static_cast<std::uint16_t>(summary_.schemas.size());
  s.channel_count = static_cast<std::uint32_t>(summary_.channels.size());
  s.chunk_count = static_cast<std::uint32_t>(summary_.chunks.size());
  s.attachment_count = static_cast<std::uint32_t>(summary_.attachments.size());
  s.metadata_count = static_cast<std::uint32_t>(summary_.metadata.size());
  return {};
}

const Schema* Reader::schema_of(const Channel& channel) const {
  const auto found = summary_.schemas.find(channel.schema);
  return found == summary_.schemas.end() ? nullptr : &found->second;
}

const Channel* Reader::find_channel(const std::string& topic) const {
  for (const auto& [id, channel] : summary_.channels)
    if (channel.topic == topic) return &channel;
  return nullptr;
}

Result<std::vector<std::byte>> Reader::attachment(const std::string& name) const {
  for (const AttachmentIndex& entry : summary_.attachments) {
    if (entry.name != name) continue;
    SL_ASSIGN(std::vector<std::byte> content,
              read_record(file_, entry.offset, Op::attachment, limits_.max_attachment));
    AttachmentHead head;
    ByteReader r(content);
    get(r, head);
    const std::size_t before = content.size() - r.remaining();
    const auto data = r.take(static_cast<std::size_t>(head.data_size));
    std::uint32_t crc = 0;
    get(r, crc);
    if (!r.ok() || r.remaining() != 0)
      return file_.damaged(entry.offset, "the attachment's own sizes do not fit");
    if (crc != 0 && crc != crc32(std::span(content).first(content.size() - 4)))
      return file_.damaged(entry.offset, "the attachment's checksum does not fit");
    return std::vector<std::byte>(content.begin() + static_cast<std::ptrdiff_t>(before),
                                  content.begin() + static_cast<std::ptrdiff_t>(before + data.size()));
  }
  return Error{"the recording has no attachment '" + name + "'", "", file_.damaged(0, "").place};
}

Result<TextMap> Reader::metadata(const std::string& name) const {
  for (const MetadataIndex& entry : summary_.metadata) {
    if (entry.name != name) continue;
    SL_ASSIGN(const std::vector<std::byte> content,
              read_record(file_, entry.offset, Op::metadata, limits_.max_attachment));
    Metadata metadata;
    ByteReader r(content);
    get(r, metadata);
    if (!r.ok()) return file_.damaged(entry.offset, "the metadata are too short");
    return std::move(metadata.values);
  }
  return Error{"the recording has no metadata '" + name + "'", "", file_.damaged(0, "").place};
}

Cursor Reader::messages(Query query) const {
  Cursor cursor;
  cursor.reader_ = this;
  cursor.wanted_.resize(0x10000);
  for (const auto& [id, channel] : summary_.channels)
    cursor.wanted_[id] = query.topics.empty() || std::find(query.topics.begin(), query.topics.end(),
                                                           channel.topic) != query.topics.end();
  std::map<std::uint64_t, const ChunkIndex*> by_offset;
  for (const ChunkIndex& chunk : summary_.chunks) by_offset.emplace(chunk.offset, &chunk);
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    if (sources_[i].end_time < query.from || sources_[i].start_time > query.to) continue;
    const auto chunk = by_offset.find(sources_[i].offset);
    bool has_wanted = chunk == by_offset.end() || chunk->second->message_index_offsets.empty();
    if (!has_wanted)
      for (const auto& [id, offset] : chunk->second->message_index_offsets) has_wanted |= cursor.wanted_[id];
    if (has_wanted) cursor.sources_.push_back(i);
  }
  cursor.query_ = std::move(query);
  return cursor;
}

Status Cursor::load(std::size_t number) {
  const Reader::Source& source = reader_->sources_[number];
  const auto& channels = reader_->summary_.channels;
  const InputFile& file = reader_->file_;
  if (source.loose_length > 0) {
    content_.records.resize(static_cast<std::size_t>(source.loose_length));
    SL_TRY(file.read(source.offset, content_.records));
  } else {
    const auto known = [](const RecordView&) { return Status(); };
    SL_TRY(load_chunk(file, source.offset, reader_->limits_, known, content_));
    if (content_.head.start_time != source.start_time || content_.head.end_time != source.end_time)
      return file.damaged(source.offset, "the chunk has other times than its index entry");
  }
  Loaded loaded;
  loaded.offset = source.offset;
  std::uint64_t at = 0;
  RecordView record;
  while (next_record(content_.records, at, record)) {
    if (record.op != Op::message) continue;
    MessageHead head;
    ByteReader r(record.content);
    get(r, head);
    if (!r.ok() || !channels.contains(head.channel))
      return file.damaged(source.offset, "a message has a channel that is not defined");
    if (wanted_[head.channel] && head.log_time >= query_.from && head.log_time <= query_.to)
      loaded.entries.push_back({head.log_time, record.offset});
  }
  if (loaded.entries.empty()) return {};
  std::stable_sort(loaded.entries.begin(), loaded.entries.end(),
                   [](const Entry& a, const Entry& b) { return a.time < b.time; });
  loaded.records = std::move(content_.records);
  loaded_bytes_ += loaded.records.size();
  if (loaded_bytes_ > reader_->limits_.max_loaded)
    return Error{"too many chunks overlap in time to sort their messages", "", file.damaged(0, "").place};
  loaded_.push_back(std::move(loaded));
  return {};
}

Result<const Message*> Cursor::next() {
  const auto later = [](const Loaded& a, const Loaded& b) {
    return std::tuple(a.front().time, a.offset) > std::tuple(b.front().time, b.offset);
  };
  while (next_source_ < sources_.size() &&
         (loaded_.empty() ||
          reader_->sources_[sources_[next_source_]].start_time <= loaded_.front().front().time)) {
    const std::size_t before = loaded_.size();
    SL_TRY(load(sources_[next_source_++]));
    if (loaded_.size() > before) std::push_heap(loaded_.begin(), loaded_.end(), later);
  }
  if (loaded_.empty()) return nullptr;
  std::pop_heap(loaded_.begin(), loaded_.end(), later);
  Loaded& first = loaded_.back();
  std::uint64_t at = first.front().at;
  RecordView record;
  SL_CHECK(next_record(first.records, at, record));
  MessageHead head;
  ByteReader r(record.content);
  get(r, head);
  message_ = {&reader_->summary_.channels.at(head.channel), head.sequence, head.log_time, head.publish_time,
              r.take(r.remaining())};
  if (++first.next < first.entries.size()) {
    std::push_heap(loaded_.begin(), loaded_.end(), later);
  } else {
    loaded_bytes_ -= first.records.size();
    content_.records.swap(first.records);  // the message stays valid until the next load
    loaded_.pop_back();
  }
  return &message_;
}

}  // namespace sandlot::mcap
