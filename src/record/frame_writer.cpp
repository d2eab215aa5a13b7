#include "record/frame_writer.h"

#include <algorithm>

#include "messages/cdr.h"
#include "record/glob.h"
#include "record/layout.h"
#include "sim/world/transforms.h"

namespace sandlot {
namespace {

mcap::Compression compression_of(model::Recording::Compression compression) {
  switch (compression) {
    case model::Recording::Compression::none: return mcap::Compression::none;
    case model::Recording::Compression::lz4: return mcap::Compression::lz4;
    case model::Recording::Compression::zstd: break;
  }
  return mcap::Compression::zstd;
}

std::uint64_t ns(Time time) { return static_cast<std::uint64_t>(std::max<std::int64_t>(time.ns, 0)); }

/// Transient local: a player of bags keeps the message for those who come later.
constexpr const char* latched_qos =
    "- history: 1\n  depth: 1\n  reliability: 1\n  durability: 1\n  deadline: {sec: 2147483647, nsec: "
    "4294967295}\n"
    "  lifespan: {sec: 2147483647, nsec: 4294967295}\n  liveliness: 1\n"
    "  liveliness_lease_duration: {sec: 2147483647, nsec: 4294967295}\n"
    "  avoid_ros_namespace_conventions: false\n";

}  // namespace

Result<FrameWriter> FrameWriter::create(const RecordOptions& options, const Simulation& simulation) {
  const model::Recording& recording = options.recording;
  mcap::WriterOptions writer_options;
  writer_options.compression = compression_of(recording.compression);
  writer_options.chunk_bytes = static_cast<std::uint64_t>(recording.chunk_mb * 1024 * 1024);
  writer_options.chunk_span_ns = ns(Time::from_s(recording.chunk_s));
  writer_options.header.library = "sandlot " + options.version;
  SL_ASSIGN(mcap::Writer writer, mcap::Writer::create(recording.file, writer_options));
  FrameWriter out(std::move(writer), recording);
  const Time now = simulation.now();
  out.tf_begin_ = now;

  const model::Setup& setup = simulation.setup();
  const bool continuous = setup.clock.mode == model::Clock::Mode::continuous;
  SL_TRY(out.writer_.add_metadata(recording::run_metadata,
                                  {{"version", options.version},
                                   {"profile", Simulation::profile()},
                                   {"seed", std::to_string(setup.seed)},
                                   {"scenario", setup.name},
                                   {"file", options.scenario_file},
                                   {"engine", setup.engine},
                                   {"step_ns", std::to_string(setup.step.ns)},
                                   {"clock", continuous ? "continuous" : "fixed"},
                                   {"start_tick", std::to_string(simulation.tick_index())},
                                   {"start_ns", std::to_string(now.ns)}}));
  SL_TRY(out.writer_.attach(recording::snapshot_attachment, "application/x-sandlot-snapshot", ns(now),
                            simulation.snapshot()));
  if (!options.scenario_text.empty())
    SL_TRY(out.writer_.attach(recording::scenario_attachment, "text/plain", ns(now),
                              std::as_bytes(std::span(options.scenario_text))));
  if (out.wants(recording::tf_static_topic))
    SL_TRY(out.put(recording::tf_static_topic, now, static_transforms(simulation)));
  // What the first tick's programs act upon was measured before it.
  Status first_messages;
  simulation.for_each_topic([&](const TopicBase& topic, const std::string&) {
    if (topic.count == 0 || topic.stamp != now || !first_messages) return;
    auto to = out.target(topic.name(), topic.info());
    first_messages = to ? out.put(**to, now, topic.data()) : Status(std::move(to).error());
  });
  SL_TRY(first_messages);
  if (!recording.hashes) return out;
  // The state that the recording begins with, so that a replay can check what it starts from.
  msg::StateHash first;
  std::vector<std::string> names;
  for (const SubHash& part : simulation.sub_hashes()) {
    names.push_back(part.path);
    first.parts.push_back(part.hash);
  }
  first.stamp = now;
  first.tick = simulation.tick_index();
  first.revision = simulation.revision();
  first.hash = simulation.state_hash();
  SL_TRY(out.put_parts(first.tick, first.revision, now, names));
  out.part_names_ = std::make_shared<const std::vector<std::string>>(std::move(names));
  SL_TRY(out.put(recording::hash_topic, now, first));
  return out;
}

FrameWriter::FrameWriter(mcap::Writer writer, const model::Recording& recording)
    : writer_(std::move(writer)), recording_(recording) {}

bool FrameWriter::wants(std::string_view topic) const {
  return recording_.topics.empty() ||
         std::any_of(recording_.topics.begin(), recording_.topics.end(),
                     [&](const auto& glob) { return glob_matches(glob, topic); });
}

Result<FrameWriter::Target*> FrameWriter::target(const std::string& topic, const MessageInfo& type) {
  const auto [found, is_new] = targets_.try_emplace(topic);
  Target& target = found->second;
  // Our own topics are the proof: they are recorded whatever is chosen.
  if (!is_new || (!wants(topic) && topic.rfind("/sandlot/", 0) != 0)) return &target;
  if (!writer_.has_room())
    return Error{"the recording has as many topics as a file can have, and now comes '" + topic + "'",
                 "record fewer of them: --record-topics"};
  target.type = &type;
  std::uint16_t& schema = schemas_[target.type->name];
  if (schema == 0) schema = writer_.add_schema(target.type->name, "ros2msg", target.type->schema);
  const bool latched = topic == recording::tf_static_topic;
  target.channel = writer_.add_channel(schema, topic, "cdr",
                                       {{"offered_qos_profiles", latched ? latched_qos : ""}});
  return &target;
}

Status FrameWriter::put(Target& target, Time now, const void* message) {
  if (!target.type) return {};
  write_cdr(*target.type, message, bytes_);
  SL_TRY(writer_.write(target.channel, ns(now), bytes_));
  ++messages_;
  return {};
}

template <class M>
Status FrameWriter::put(const char* topic, Time now, const M& message) {
  SL_ASSIGN(Target* const to, target(topic, message_info<M>()));
  return put(*to, now, &message);
}

Status FrameWriter::put_parts(std::uint64_t tick, std::uint64_t revision, Time now,
                              const std::vector<std::string>& names) {
  msg::StateParts parts;
  parts.stamp = now;
  parts.tick = tick;
  parts.revision = revision;
  parts.paths = names;
  return put(recording::parts_topic, now, parts);
}

Status FrameWriter::put_transforms(const Frame& frame) {
  transforms_of(frame, transforms_);
  return put(recording::tf_topic, frame.now, transforms_);
}

Status FrameWriter::write(const Frame& frame, const msg::TFMessage* tf_static) {
  if (tf_static && wants(recording::tf_static_topic))
    SL_TRY(put(recording::tf_static_topic, frame.now, *tf_static));
  if (recording_.tf_hz > 0 && frame.now >= due_time(tf_begin_, tf_sample_, recording_.tf_hz)) {
    do ++tf_sample_;
    while (frame.now >= due_time(tf_begin_, tf_sample_, recording_.tf_hz));
    if (wants(recording::clock_topic)) {
      msg::Clock clock;
      clock.clock = frame.now;
      SL_TRY(put(recording::clock_topic, frame.now, clock));
    }
    // Frames of which only the log was kept have no instances.
    if (!frame.instances.empty() && wants(recording::tf_topic)) SL_TRY(put_transforms(frame));
  }
  for (const auto& topic : frame.topics) {
    SL_ASSIGN(Target* const to, target(topic->name(), topic->info()));
    SL_TRY(put(*to, frame.now, topic->data()));
  }
  for (const LogEntry& entry : frame.log) {
    entry_.stamp = frame.now;
    entry_.tick = frame.tick;
    entry_.source_kind = static_cast<std::uint8_t>(entry.source.kind);
    entry_.source_id = entry.source.id;
    entry_.sequence = entry.sequence;
    entry_.kind = entry.kind;
    entry_.target = entry.target;
    entry_.type = entry.type;
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(entry.bytes.data());
    entry_.bytes.assign(bytes, bytes + entry.bytes.size());
    entry_.refused = entry.refused;
    SL_TRY(put(recording::log_topic, frame.now, entry_));
  }
  if (!frame.part_names) return {};
  if (frame.part_names != part_names_ && (!part_names_ || *frame.part_names != *part_names_)) {
    part_names_ = frame.part_names;
    SL_TRY(put_parts(frame.tick, frame.revision, frame.now, *part_names_));
  }
  hash_.stamp = frame.now;
  hash_.tick = frame.tick;
  hash_.revision = frame.revision;
  hash_.hash = frame.hash;
  hash_.parts = frame.parts;
  return put(recording::hash_topic, frame.now, hash_);
}

Status FrameWriter::finish(const mcap::TextMap& end) {
  // Before the summary, so that what is missing is known to those who read the file.
  Status status = writer_.flush();
  if (status) status = writer_.add_metadata(recording::end_metadata, end);
  const Status finished = writer_.finish();
  return status ? finished : status;
}

}  // namespace sandlot
