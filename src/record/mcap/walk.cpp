#include "record/mcap/walk.h"

#include <algorithm>

#include "record/mcap/codec.h"

namespace sandlot::mcap {
namespace {

constexpr std::uint64_t piece_bytes = std::uint64_t{1} << 20;

/// Everything before the stored records; longer ones would need a name of the compression that nobody has.
constexpr std::uint64_t chunk_head_bytes = 8 + 8 + 8 + 4 + 4 + 8;

bool known(std::byte op) { return op >= std::byte{0x01} && op <= std::byte{0x0f}; }

/// Sorts the messages of `out.records` into `out.indexes` and checks them.
Status index_records(const InputFile& file, std::uint64_t place, const Definition& definition,
                     ChunkContent& out) {
  std::map<std::uint16_t, MessageIndex> by_channel;
  std::uint64_t at = 0, first = UINT64_MAX, last = 0;
  RecordView record;
  while (next_record(out.records, at, record)) {
    if (record.op == Op::schema || record.op == Op::channel) {
      SL_TRY(definition(record));
    } else if (record.op == Op::message) {
      MessageHead head;
      ByteReader r(record.content);
      get(r, head);
      if (!r.ok()) return file.damaged(place, "a message is shorter than its head");
      first = std::min(first, head.log_time);
      last = std::max(last, head.log_time);
      MessageIndex& index = by_channel[head.channel];
      index.channel = head.channel;
      index.records.emplace_back(head.log_time, record.offset);
    }
  }
  if (at != out.records.size()) return file.damaged(place, "the last record of the chunk is cut short");
  if (!by_channel.empty() && (first < out.head.start_time || last > out.head.end_time))
    return file.damaged(place, "a message lies outside the time that its chunk gives");
  out.indexes.clear();
  for (auto& [channel, index] : by_channel) out.indexes.push_back(std::move(index));
  return {};
}

}  // namespace

std::vector<const MessageIndex*> ChunkContent::index_list() const {
  std::vector<const MessageIndex*> list;
  for (const MessageIndex& index : indexes) list.push_back(&index);
  return list;
}

bool next_record(std::span<const std::byte> records, std::uint64_t& offset, RecordView& record) {
  if (records.size() < record_head || offset > records.size() - record_head) return false;
  std::uint64_t length = 0;
  std::memcpy(&length, records.data() + offset + 1, 8);
  if (length > records.size() - record_head - offset) return false;
  record = {static_cast<Op>(records[offset]), offset, records.subspan(offset + record_head, length)};
  offset += record_head + length;
  return true;
}

Result<std::vector<std::byte>> read_record(const InputFile& file, std::uint64_t offset, Op op,
                                           std::uint64_t limit) {
  std::array<std::byte, record_head> bytes;
  SL_TRY(file.read(offset, bytes));
  std::uint64_t length = 0;
  std::memcpy(&length, bytes.data() + 1, 8);
  if (static_cast<Op>(bytes[0]) != op) return file.damaged(offset, "another record was promised here");
  if (length > file.size() - offset - record_head) return file.damaged(offset, "the record is cut short");
  if (length > limit)
    return file.damaged(offset, "a record of " + std::to_string(length) + " bytes is too large");
  std::vector<std::byte> content(static_cast<std::size_t>(length));
  SL_TRY(file.read(offset + record_head, content));
  return content;
}

Result<std::uint32_t> crc_of(const InputFile& file, std::uint64_t begin, std::uint64_t end) {
  std::vector<std::byte> piece;
  std::uint32_t crc = 0;
  for (std::uint64_t at = begin; at < end; at += piece.size()) {
    piece.resize(static_cast<std::size_t>(std::min(piece_bytes, end - at)));
    SL_TRY(file.read(at, piece));
    crc = crc32(piece, crc);
  }
  return crc;
}

Status load_chunk(const InputFile& file, std::uint64_t offset, const Limits& limits,
                  const Definition& definition, ChunkContent& out) {
  // The worst that compressors promise for what does not compress is under 1 %.
  const std::uint64_t most = limits.max_chunk + limits.max_chunk / 64 + 4096;
  SL_ASSIGN(const std::vector<std::byte> content, read_record(file, offset, Op::chunk, most));
  out.head = {};
  ByteReader r(content);
  get(r, out.head);
  if (!r.ok() || out.head.stored_size != r.remaining())
    return file.damaged(offset, "the chunk's own sizes do not fit");
  if (out.head.uncompressed_size > limits.max_chunk)
    return file.damaged(offset,
                        "a chunk of " + std::to_string(out.head.uncompressed_size) + " bytes is too large");
  if (Status status = decompress(out.head.compression, r.take(r.remaining()), out.head.uncompressed_size,
                                 out.records);
      !status)
    return file.damaged(offset, status.error().text());
  if (out.head.crc != 0 && crc32(out.records) != out.head.crc)
    return file.damaged(offset, "the chunk's checksum does not fit");
  return index_records(file, offset, definition, out);
}

Result<Walk> Walk::begin(const InputFile& file, const Limits& limits) {
  Walk walk(file, limits);
  std::array<std::uint8_t, magic.size()> found{};
  const std::size_t there = static_cast<std::size_t>(std::min<std::uint64_t>(file.size(), found.size()));
  SL_TRY(file.read(0, std::as_writable_bytes(std::span(found).first(there))));
  const Place place{file.damaged(0, "").place};
  if (there < found.size() || !std::equal(found.begin(), found.begin() + 5, magic.begin()))
    return Error{"this is not an MCAP recording", "", place};
  if (found != magic)
    return Error{std::string("this is an MCAP recording of version '") + static_cast<char>(found[5]) + "'",
                 "this Sandlot reads version '0'", place};
  SL_ASSIGN(const std::vector<std::byte> content, read_record(file, found.size(), Op::header, piece_bytes));
  ByteReader r(content);
  get(r, walk.header_);
  if (!r.ok()) return file.damaged(found.size(), "the header is too short");
  walk.offset_ = found.size() + record_head + content.size();
  return walk;
}

Result<Walk::RecordHead> Walk::head_at(std::uint64_t offset) const {
  if (offset == file_->size()) return file_->damaged(offset, "the recording has no end");
  if (file_->size() - offset < record_head) return file_->damaged(offset, "the last record is cut short");
  std::array<std::byte, record_head> bytes;
  SL_TRY(file_->read(offset, bytes));
  RecordHead head{static_cast<Op>(bytes[0]), 0};
  std::memcpy(&head.length, bytes.data() + 1, 8);
  if (bytes[0] == std::byte{0}) return file_->damaged(offset, "here should be a record");
  if (head.length > file_->size() - offset - record_head)
    return file_->damaged(offset, "the record is cut short");
  head.length += record_head;
  return head;
}

Status Walk::define(const RecordView& record, std::uint64_t place) {
  ByteReader r(record.content);
  const auto enter = [&](auto found, auto& known_ones, const char* what) -> Status {
    get(r, found);
    if (!r.ok()) return file_->damaged(place, std::string("a ") + what + " is too short");
    const auto [at, is_new] = known_ones.try_emplace(found.id, found);
    if (!is_new && !(at->second == found))
      return file_->damaged(place, std::string("the ") + what + " " + std::to_string(found.id) +
                                       " is defined twice, differently");
    return {};
  };
  if (record.op == Op::schema) {
    SL_TRY(enter(Schema{}, schemas_, "schema"));
    if (schemas_.contains(0)) return schemas_.erase(0), file_->damaged(place, "a schema has the number 0");
    return {};
  }
  return enter(Channel{}, channels_, "channel");
}

void Walk::know(const Summary& summary) {
  schemas_.insert(summary.schemas.begin(), summary.schemas.end());
  channels_.insert(summary.channels.begin(), summary.channels.end());
}

Status Walk::next(Piece& piece) {
  ChunkContent last = std::move(piece.content);
  const bool behind_chunk = piece.kind == Piece::Kind::chunk;
  piece.kind = Piece::Kind::other;
  for (;;) {
    SL_ASSIGN(const RecordHead head, head_at(offset_));
    if (head.op != Op::message_index) break;
    if (behind_chunk) SL_TRY(check_message_index(head, last));
    offset_ += head.length;
  }
  SL_ASSIGN(const RecordHead head, head_at(offset_));
  piece.offset = offset_;
  piece.length = head.length;
  switch (head.op) {
    case Op::schema:
    case Op::channel:
    case Op::message: SL_TRY(read_loose(piece)); break;
    case Op::chunk: {
      piece.kind = Piece::Kind::chunk;
      piece.content = std::move(last);
      const auto definition = [&](const RecordView& record) { return define(record, offset_); };
      SL_TRY(load_chunk(*file_, offset_, limits_, definition, piece.content));
      break;
    }
    case Op::attachment: SL_TRY(read_attachment(head, piece)); break;
    case Op::metadata: SL_TRY(read_metadata(head, piece)); break;
    case Op::data_end: {
      // Exactly its checksum, lest a damaged opcode of another record ends the data early.
      if (head.length != record_head + 4)
        return file_->damaged(offset_, "the end of the data has another length");
      piece.kind = Piece::Kind::end;
      SL_ASSIGN(const std::vector<std::byte> content,
                read_record(*file_, offset_, Op::data_end, piece_bytes));
      ByteReader r(content);
      get(r, piece.data_crc);
      if (!r.ok()) return file_->damaged(offset_, "the end of the data is too short");
      break;
    }
    case Op::header:
    case Op::footer:
    case Op::message_index:
    case Op::chunk_index:
    case Op::attachment_index:
    case Op::statistics:
    case Op::metadata_index:
    case Op::summary_offset: return file_->damaged(offset_, "this record has no place among the data");
    default: piece.kind = Piece::Kind::other;  // of a later version, or somebody's own
  }
  for (const MessageIndex& index : piece.content.indexes)
    if ((piece.kind == Piece::Kind::chunk || piece.kind == Piece::Kind::loose) &&
        !channels_.contains(index.channel))
      return file_->damaged(
          offset_, "a message has the channel " + std::to_string(index.channel) + ", which is not defined");
  offset_ += piece.length;
  return {};
}

Status Walk::read_loose(Piece& piece) {
  piece.kind = Piece::Kind::loose;
  piece.content = {};
  piece.length = 0;
  while (piece.length < piece_bytes) {
    auto head = head_at(offset_ + piece.length);
    // What is wrong behind the run is said when the walk comes there.
    if (!head && piece.length > 0) break;
    if (!head) return head.error();
    if (head->op != Op::schema && head->op != Op::channel && head->op != Op::message) break;
    if (head->length > limits_.max_chunk) return file_->damaged(offset_, "a record is too large");
    piece.length += head->length;
  }
  piece.content.records.resize(static_cast<std::size_t>(piece.length));
  SL_TRY(file_->read(offset_, piece.content.records));
  piece.content.head.end_time = UINT64_MAX;
  SL_TRY(index_records(
      *file_, offset_, [&](const RecordView& record) { return define(record, offset_); }, piece.content));
  ChunkHead& head = piece.content.head;
  head = {UINT64_MAX, 0, piece.length, 0, "", piece.length};
  for (const MessageIndex& index : piece.content.indexes)
    for (const auto& [time, at] : index.records) {
      head.start_time = std::min(head.start_time, time);
      head.end_time = std::max(head.end_time, time);
    }
  if (piece.content.indexes.empty()) head.start_time = 0;
  return {};
}

Status Walk::check_message_index(const RecordHead& head, const ChunkContent& chunk) {
  SL_ASSIGN(const std::vector<std::byte> content,
            read_record(*file_, offset_, Op::message_index, std::max(limits_.max_chunk, head.length)));
  MessageIndex index;
  ByteReader r(content);
  get(r, index);
  const auto own = std::find_if(chunk.indexes.begin(), chunk.indexes.end(),
                                [&](const MessageIndex& i) { return i.channel == index.channel; });
  std::sort(index.records.begin(), index.records.end(), [](auto& a, auto& b) { return a.second < b.second; });
  const bool fits = own == chunk.indexes.end() ? index.records.empty() : index.records == own->records;
  // Nor may it be longer than its entries: with a damaged length it would hide the chunks that follow.
  if (!r.ok() || r.remaining() != 0 || !fits)
    return file_->damaged(offset_, "the index of a channel does not fit its chunk");
  return {};
}

Status Walk::read_attachment(const RecordHead& head, Piece& piece) const {
  piece.kind = Piece::Kind::attachment;
  const std::uint64_t begin = offset_ + record_head, size = head.length - record_head;
  std::vector<std::byte> front(static_cast<std::size_t>(std::min(size, piece_bytes)));
  SL_TRY(file_->read(begin, front));
  AttachmentHead attachment;
  ByteReader r(front);
  get(r, attachment);
  const std::uint64_t before = front.size() - r.remaining();
  if (!r.ok() || size - before < 4 || attachment.data_size != size - before - 4)
    return file_->damaged(offset_, "the attachment's own sizes do not fit");
  SL_ASSIGN(const std::uint32_t found, crc_of(*file_, begin, begin + size - 4));
  std::uint32_t crc = 0;
  SL_TRY(file_->read(begin + size - 4, std::as_writable_bytes(std::span(&crc, 1))));
  if (crc != 0 && crc != found) return file_->damaged(offset_, "the attachment's checksum does not fit");
  piece.attachment = {offset_,
                      head.length,
                      attachment.log_time,
                      attachment.create_time,
                      attachment.data_size,
                      attachment.name,
                      attachment.media_type};
  return {};
}

Status Walk::read_metadata(const RecordHead& head, Piece& piece) const {
  piece.kind = Piece::Kind::metadata;
  SL_ASSIGN(const std::vector<std::byte> content,
            read_record(*file_, offset_, Op::metadata, limits_.max_attachment));
  Metadata metadata;
  ByteReader r(content);
  get(r, metadata);
  if (!r.ok() || r.remaining() != 0) return file_->damaged(offset_, "the metadata's own sizes do not fit");
  piece.metadata = {offset_, head.length, metadata.name};
  return {};
}

bool Walk::resume() {
  // A record whose frame is whole: the next one says so.
  if (const auto head = head_at(offset_)) {
    const std::uint64_t next = offset_ + head->length;
    std::byte op{};
    const bool framed = known(static_cast<std::byte>(head->op)) && next < file_->size() &&
                        file_->read(next, std::span(&op, 1)) && known(op) && head_at(next);
    if (framed) {
      offset_ = next;
      return true;
    }
  }
  // Else the next chunk whose sizes fit each other and whose checksum proves that it is one.
  constexpr std::uint64_t head_bytes = record_head + chunk_head_bytes;
  std::vector<std::byte> window;
  for (std::uint64_t begin = offset_ + 1; begin + head_bytes < file_->size();) {
    window.resize(static_cast<std::size_t>(std::min(piece_bytes, file_->size() - begin)));
    if (!file_->read(begin, window)) return false;
    for (std::size_t i = 0; i + head_bytes <= window.size(); ++i) {
      if (static_cast<Op>(window[i]) != Op::chunk) continue;
      std::uint64_t length = 0, raw = 0, stored = 0;
      std::uint32_t crc = 0, name = 0;
      const auto take = [&](std::size_t at, auto& value) {
        std::memcpy(&value, window.data() + i + at, sizeof value);
      };
      take(1, length), take(25, raw), take(33, crc), take(37, name);
      if (name > 4 || i + head_bytes + name > window.size() || crc == 0 || raw > limits_.max_chunk) continue;
      take(41 + name, stored);
      if (length != chunk_head_bytes + name + stored || length > file_->size() - begin - i - record_head)
        continue;
      ChunkContent content;
      const auto definition = [](const RecordView&) { return Status(); };
      // Chance gives hardly one candidate that fails; a file made to give many of them is left as it is.
      if (++failed_guesses_ > 1000) return false;
      if (!load_chunk(*file_, begin + i, limits_, definition, content)) continue;
      offset_ = begin + i;
      return true;
    }
    // What could have begun in the last bytes is looked at again with what follows.
    if (begin + window.size() >= file_->size()) break;
    begin += window.size() - head_bytes - 4;
  }
  return false;
}

}  // namespace sandlot::mcap
