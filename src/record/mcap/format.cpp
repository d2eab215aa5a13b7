#include "record/mcap/format.h"

#include <algorithm>

#include "record/mcap/codec.h"

namespace sandlot::mcap {

void Summary::add_chunk(ChunkIndex chunk, std::span<const MessageIndex* const> indexes) {
  Statistics& s = statistics;
  for (const MessageIndex* index : indexes) {
    if (index->records.empty()) continue;
    s.start_time = s.message_count ? std::min(s.start_time, chunk.start_time) : chunk.start_time;
    s.end_time = s.message_count ? std::max(s.end_time, chunk.end_time) : chunk.end_time;
    s.message_count += index->records.size();
    s.channel_message_counts[index->channel] += index->records.size();
  }
  chunks.push_back(std::move(chunk));
}

void put_message_indexes(ByteWriter& w, std::span<const MessageIndex* const> indexes, std::uint64_t offset,
                         ChunkIndex& chunk) {
  const std::size_t begin = w.size();
  for (const MessageIndex* index : indexes) {
    if (index->records.empty()) continue;
    chunk.message_index_offsets.emplace(index->channel, offset + w.size() - begin);
    put_record(w, Op::message_index, *index);
  }
  chunk.message_index_length = w.size() - begin;
}

void put_end(ByteWriter& w, Summary& summary, std::uint64_t offset, std::uint32_t data_crc) {
  Statistics& s = summary.statistics;
  s.schema_count = static_cast<std::uint16_t>(summary.schemas.size());
  s.channel_count = static_cast<std::uint32_t>(summary.channels.size());
  s.chunk_count = static_cast<std::uint32_t>(summary.chunks.size());
  s.attachment_count = static_cast<std::uint32_t>(summary.attachments.size());
  s.metadata_count = static_cast<std::uint32_t>(summary.metadata.size());

  put_record(w, Op::data_end, data_crc);
  const std::size_t summary_at = w.size();
  std::vector<SummaryOffset> groups;
  const auto group = [&](Op op, const auto& records) {
    const std::size_t at = w.size();
    for (const auto& record : records) {
      if constexpr (requires { record.second; }) put_record(w, op, record.second);
      else put_record(w, op, record);
    }
    if (w.size() > at) groups.push_back({static_cast<std::uint8_t>(op), offset + at, w.size() - at});
  };
  group(Op::schema, summary.schemas);
  group(Op::channel, summary.channels);
  group(Op::statistics, std::array{s});
  group(Op::chunk_index, summary.chunks);
  group(Op::attachment_index, summary.attachments);
  group(Op::metadata_index, summary.metadata);
  const std::uint64_t offsets_start = offset + w.size();
  for (const SummaryOffset& each : groups) put_record(w, Op::summary_offset, each);
  put_record_of(w, Op::footer, [&] {
    put(w, offset + summary_at);
    put(w, offsets_start);
    // The checksum covers the summary and the footer up to here, its head included.
    const std::uint64_t footer_size = 20;
    w.patch(w.size() - 24, footer_size);
    put(w, crc32(w.bytes().subspan(summary_at)));
  });
  w.raw(magic.data(), magic.size());
}

}  // namespace sandlot::mcap
