#include "record/recording.h"

#include <utility>
#include <variant>

#include "messages/cdr.h"
#include "messages/messages.h"

namespace sandlot::record {
namespace {

using Decoded = std::variant<msg::LogEntry, msg::StateHash, msg::StateParts>;

template <class M>
Result<Decoded> decode_as(const mcap::Message& message) {
  M out;
  Status status = read_cdr(message_info<M>(), message.data, &out);
  if (status) return Decoded(std::move(out));
  status.error().what = message.channel->topic + ": " + status.error().what;
  return std::move(status.error());
}

Result<Decoded> decode(const mcap::Message& message) {
  const std::string& topic = message.channel->topic;
  if (topic == recording::log_topic) return decode_as<msg::LogEntry>(message);
  if (topic == recording::hash_topic) return decode_as<msg::StateHash>(message);
  return decode_as<msg::StateParts>(message);
}

}  // namespace

Recording::Recording(mcap::Reader reader)
    : reader_(std::make_unique<mcap::Reader>(std::move(reader))),
      cursor_(reader_->messages(
          {.topics = {recording::log_topic, recording::hash_topic, recording::parts_topic}})) {}

Result<Recording> Recording::open(const std::string& path) {
  SL_ASSIGN(mcap::Reader reader, mcap::Reader::open(path));
  const auto about = [&](Error error, const char* part) {
    if (!error.place.file) error.place.file = std::make_shared<const std::string>(path);
    error.what = part + error.what;
    return error;
  };
  const bool ours = reader.find_channel(recording::hash_topic) || reader.find_channel(recording::log_topic);
  const bool hashes = reader.find_channel(recording::hash_topic);
  Recording out(std::move(reader));
  auto snapshot = out.reader_->attachment(recording::snapshot_attachment);
  if (!snapshot && !ours)
    return about({"this recording cannot be replayed: it was not made by Sandlot",
                  "record with: sandlot run FILE --record out.mcap"},
                 "");
  if (!snapshot) return about(std::move(snapshot.error()), "the state at the beginning is missing: ");
  out.snapshot_ = std::move(*snapshot);
  auto info = examine_snapshot(out.snapshot_);
  if (!info) return about(std::move(info.error()), "the state at the beginning: ");
  out.begin_ = std::move(*info);
  if (!hashes)
    return about({"nobody knows its ticks: it was recorded without hashes of the state, or ended before the "
                  "first one was written",
                  "record again with hashes: true"},
                 "");
  if (auto facts = out.reader_->metadata(recording::run_metadata)) out.facts_ = std::move(*facts);
  return out;
}

struct Recording::Take {
  Recording& to;
  void operator()(msg::LogEntry& entry) const {
    LogEntry out;
    out.kind = entry.kind;
    out.source = {static_cast<Source::Kind>(entry.source_kind), entry.source_id};
    out.sequence = entry.sequence;
    out.target = std::move(entry.target);
    out.type = std::move(entry.type);
    const auto bytes = std::as_bytes(std::span(entry.bytes));
    out.bytes.assign(bytes.begin(), bytes.end());
    out.refused = entry.refused;
    to.next_.log.push_back(std::move(out));
  }
  void operator()(msg::StateHash& hash) const {
    to.next_.now = hash.stamp;
    to.next_.hash = hash.hash;
    to.next_.parts = std::move(hash.parts);
    to.next_.part_names = to.part_names_;
    to.next_has_hash_ = true;
  }
  void operator()(msg::StateParts& parts) const {
    to.part_names_ = std::make_shared<const std::vector<std::string>>(std::move(parts.paths));
    to.next_.part_names = to.part_names_;
  }
};

Result<const RecordedTick*> Recording::next() {
  const RecordedTick* const none = nullptr;
  while (!ended_) {
    SL_ASSIGN(const mcap::Message* const message, cursor_.next());
    if (!message) {
      ended_ = true;
      break;
    }
    SL_ASSIGN(Decoded decoded, decode(*message));
    const std::uint64_t tick = std::visit([](const auto& m) { return m.tick; }, decoded);
    if (!next_begun_ || tick == next_.tick) {
      next_begun_ = true;
      next_.tick = tick;
      std::visit(Take{*this}, decoded);
      continue;
    }
    tick_ = std::exchange(next_, RecordedTick{});
    next_.tick = tick;
    const bool whole = std::exchange(next_has_hash_, false);
    std::visit(Take{*this}, decoded);
    if (whole) return &tick_;
    // Only the last tick of a torn file may lack its hash.
    return Error{"the recording is incomplete: tick " + std::to_string(tick_.tick) + " has no state hash"};
  }
  if (!next_begun_ || !next_has_hash_) return none;
  next_begun_ = next_has_hash_ = false;
  tick_ = std::exchange(next_, RecordedTick{});
  return &tick_;
}

}  // namespace sandlot::record
