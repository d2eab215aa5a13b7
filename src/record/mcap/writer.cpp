#include "record/mcap/writer.h"

#include <algorithm>

namespace sandlot::mcap {

Result<Writer> Writer::create(const std::string& path, const WriterOptions& options) {
  SL_ASSIGN(OutputFile file, OutputFile::create(path));
  Writer writer(std::move(file), options);
  ByteWriter begin;
  begin.raw(magic.data(), magic.size());
  put_record(begin, Op::header, options.header);
  SL_TRY(writer.hand_over(begin.bytes()));
  return writer;
}

Writer::Writer(OutputFile file, const WriterOptions& options)
    : file_(std::move(file)), options_(options), compressor_(options.compression) {}

std::uint16_t Writer::add_schema(std::string name, std::string encoding, std::string_view text) {
  const std::size_t id = summary_.schemas.size() + 1;
  SL_CHECK(id < 0xffff);
  const auto bytes = std::as_bytes(std::span(text));
  Schema schema{static_cast<std::uint16_t>(id), std::move(name), std::move(encoding), {}};
  schema.data.assign(bytes.begin(), bytes.end());
  summary_.schemas.emplace(schema.id, std::move(schema));
  schema_written_.resize(id + 1);
  return static_cast<std::uint16_t>(id);
}

std::uint16_t Writer::add_channel(std::uint16_t schema, std::string topic, std::string message_encoding,
                                  TextMap metadata) {
  const std::size_t id = summary_.channels.size() + 1;
  SL_CHECK(has_room() && (schema == 0 || summary_.schemas.contains(schema)));
  const auto number = static_cast<std::uint16_t>(id);
  summary_.channels.emplace(
      number, Channel{number, schema, std::move(topic), std::move(message_encoding), std::move(metadata)});
  channels_.resize(id + 1);
  channels_[id].index.channel = number;
  return number;
}

Status Writer::write(std::uint16_t channel, std::uint64_t time_ns, std::span<const std::byte> data) {
  if (!status_) return status_;
  SL_CHECK(!finished_ && channel > 0 && channel < channels_.size());
  if (data.size() >= (std::uint64_t{1} << 30)) return Error{"a message of 1 GiB and more cannot be recorded"};
  PerChannel& own = channels_[channel];
  if (!own.written) {
    const Channel& record = summary_.channels.at(channel);
    if (record.schema != 0 && !schema_written_[record.schema]) {
      put_record(chunk_, Op::schema, summary_.schemas.at(record.schema));
      schema_written_[record.schema] = true;
    }
    put_record(chunk_, Op::channel, record);
    own.written = true;
  }
  if (own.index.records.empty()) touched_.push_back(channel);
  const bool first = touched_.size() == 1 && own.index.records.empty();
  chunk_head_.start_time = first ? time_ns : std::min(chunk_head_.start_time, time_ns);
  chunk_head_.end_time = first ? time_ns : std::max(chunk_head_.end_time, time_ns);
  own.index.records.emplace_back(time_ns, chunk_.size());
  put_record_of(chunk_, Op::message, [&] {
    put(chunk_, MessageHead{channel, own.sequence++, time_ns, time_ns});
    chunk_.raw(data.data(), data.size());
  });
  if (chunk_.size() >= options_.chunk_bytes ||
      chunk_head_.end_time - chunk_head_.start_time >= options_.chunk_span_ns)
    return flush();
  return {};
}

Status Writer::flush() {
  if (!status_) return status_;
  if (chunk_.size() == 0) return {};
  chunk_head_.uncompressed_size = chunk_.size();
  chunk_head_.crc = crc32(chunk_.bytes());
  chunk_head_.compression = file_name(options_.compression);
  out_.clear();
  Status compressed;
  put_record_of(out_, Op::chunk, [&] {
    put(out_, chunk_head_);
    const std::size_t at = out_.size();
    compressed = compressor_.compress(chunk_.bytes(), out_.buffer());
    chunk_head_.stored_size = out_.size() - at;
    out_.patch(at - 8, chunk_head_.stored_size);
  });
  if (!compressed) return status_ = compressed;
  ChunkIndex entry{chunk_head_.start_time,
                   chunk_head_.end_time,
                   offset_,
                   out_.size(),
                   {},
                   0,
                   chunk_head_.compression,
                   chunk_head_.stored_size,
                   chunk_head_.uncompressed_size};
  std::sort(touched_.begin(), touched_.end());
  std::vector<const MessageIndex*> indexes;
  for (const std::uint16_t channel : touched_) indexes.push_back(&channels_[channel].index);
  put_message_indexes(out_, indexes, offset_ + out_.size(), entry);
  SL_TRY(hand_over(out_.bytes()));

  // Entered once it is in the file: what the end says is then true even after a full disk.
  summary_.add_chunk(std::move(entry), indexes);
  for (const std::uint16_t channel : touched_) channels_[channel].index.records.clear();
  touched_.clear();
  chunk_.clear();
  chunk_head_ = {};
  return {};
}

Status Writer::attach(const std::string& name, const std::string& media_type, std::uint64_t time_ns,
                      std::span<const std::byte> data) {
  if (!status_) return status_;
  out_.clear();
  put_record_of(out_, Op::attachment, [&] {
    put(out_, AttachmentHead{time_ns, 0, name, media_type, data.size()});
    out_.raw(data.data(), data.size());
    put(out_, crc32(out_.bytes().subspan(record_head)));
  });
  const AttachmentIndex entry{offset_, out_.size(), time_ns, 0, data.size(), name, media_type};
  SL_TRY(hand_over(out_.bytes()));
  summary_.attachments.push_back(entry);
  return {};
}

Status Writer::add_metadata(const std::string& name, const TextMap& values) {
  if (!status_) return status_;
  out_.clear();
  put_record(out_, Op::metadata, Metadata{name, values});
  const MetadataIndex entry{offset_, out_.size(), name};
  SL_TRY(hand_over(out_.bytes()));
  summary_.metadata.push_back(entry);
  return {};
}

Status Writer::finish() {
  if (finished_) return status_;
  const Status flushed = flush();
  finished_ = true;
  // After an error a part of a chunk may stand at the end: it goes, and makes room for the summary on a full disk.
  if (!flushed && !file_.cut(offset_)) return flushed;
  out_.clear();
  put_end(out_, summary_, offset_, data_crc_);
  Status ended = file_.write(out_.bytes());
  if (ended) offset_ += out_.size();
  const Status closed = file_.close();
  if (!flushed) return flushed;
  if (!ended) return status_ = ended;
  return status_ = closed;
}

Status Writer::hand_over(std::span<const std::byte> bytes) {
  status_ = file_.write(bytes);
  if (!status_) return status_;
  offset_ += bytes.size();
  data_crc_ = crc32(bytes, data_crc_);
  return {};
}

}  // namespace sandlot::mcap
