#include "record/playback.h"

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "base/text.h"
#include "files/resources.h"
#include "messages/cdr.h"
#include "messages/messages.h"
#include "record/recording.h"

namespace sandlot::record {
namespace {

using controllers::playback::read_samples;
using controllers::playback::Sample;
using controllers::playback::samples_text;
using Samples = std::vector<Sample>;

constexpr std::size_t most_samples = 10'000'000;
constexpr std::uintmax_t most_table_bytes = 500'000'000;

Sample sample_of(double time_s, const msg::Twist& twist) {
  return {time_s, twist.linear.x, twist.linear.y, twist.angular.z};
}

/// The velocity in a message of one of the types that tell one.
Result<Sample> sample_of(double time_s, std::string_view type, std::span<const std::byte> bytes) {
  if (type == long_name(msg::Twist::ros_type)) {
    msg::Twist m;
    SL_TRY(read_cdr(message_info<msg::Twist>(), bytes, &m));
    return sample_of(time_s, m);
  }
  if (type == long_name(msg::TwistStamped::ros_type)) {
    msg::TwistStamped m;
    SL_TRY(read_cdr(message_info<msg::TwistStamped>(), bytes, &m));
    return sample_of(time_s, m.twist);
  }
  msg::Odometry m;
  SL_TRY(read_cdr(message_info<msg::Odometry>(), bytes, &m));
  return sample_of(time_s, m.twist.twist);
}

bool tells_velocity(const mcap::Reader& reader, const mcap::Channel& channel) {
  const mcap::Schema* const schema = reader.schema_of(channel);
  if (!schema || channel.message_encoding != "cdr") return false;
  const std::string type = long_name(schema->name);
  return type == msg::Twist::ros_type || type == msg::TwistStamped::ros_type ||
         type == msg::Odometry::ros_type;
}

std::string listed(std::vector<std::string> names, const char* none) {
  std::sort(names.begin(), names.end());
  std::string out;
  for (const std::string& name : names) out.append(out.empty() ? "there are: " : ", ").append(name);
  return out.empty() ? none : out;
}

Status check_count(const Samples& samples) {
  if (samples.size() <= most_samples) return {};
  return Error{"the recording has more than " + std::to_string(most_samples) + " samples", "cut it"};
}

Result<Samples> samples_of_topic(const mcap::Reader& reader, std::string topic) {
  std::vector<std::string> playable;
  for (const auto& [id, channel] : reader.summary().channels)
    if (tells_velocity(reader, channel)) playable.push_back(channel.topic);
  if (topic.empty() && playable.size() == 1) topic = playable.front();
  const mcap::Channel* const channel = reader.find_channel(topic);
  if (topic.empty() || !channel || !tells_velocity(reader, *channel))
    return Error{topic.empty() ? "which topic is to be played back?"
                 : channel     ? "topic '" + topic + "' tells no velocity (Twist, TwistStamped, Odometry)"
                               : "the recording has no topic '" + topic + "'",
                 listed(playable, "it has none that could be played back"),
                 {},
                 "/topic"};
  const std::string type = long_name(reader.schema_of(*channel)->name);
  // Times count from where the recording began; one that others made tells its first message.
  std::uint64_t begin = reader.summary().statistics.start_time;
  if (const auto snapshot = reader.attachment(recording::snapshot_attachment))
    if (const auto info = examine_snapshot(*snapshot)) begin = static_cast<std::uint64_t>(info->now.ns);
  Samples out;
  mcap::Cursor cursor = reader.messages({.topics = {topic}});
  for (;;) {
    SL_ASSIGN(const mcap::Message* const message, cursor.next());
    if (!message) return out;
    SL_ASSIGN(out.emplace_back(),
              sample_of(static_cast<double>(message->log_time - begin) / 1e9, type, message->data));
    SL_TRY(check_count(out));
  }
}

/// Orders that a log holds for the drive `target`, at any of its levels.
Result<Samples> samples_of_commands(const std::string& path, const std::string& target) {
  SL_ASSIGN(Recording recording, Recording::open(path));
  std::vector<std::string> known;
  Samples out;
  const Time begin = recording.begin().now;
  Time before = begin;
  for (;;) {
    SL_ASSIGN(const RecordedTick* const tick, recording.next());
    if (!tick) break;
    for (const LogEntry& entry : tick->log) {
      if (entry.kind != LogEntry::command || entry.type != msg::Twist::ros_type || entry.refused) continue;
      if (entry.target != target && !entry.target.starts_with(target + "/")) {
        if (std::find(known.begin(), known.end(), entry.target) == known.end()) known.push_back(entry.target);
        continue;
      }
      msg::Twist twist;
      ByteReader r(entry.bytes);
      read(r, twist);
      if (!r.ok()) return Error{tick_text(tick->tick, tick->now) + ": a command in the log cannot be read"};
      // What is carried out in a tick was ordered at its beginning.
      out.push_back(sample_of((before - begin).s(), twist));
      SL_TRY(check_count(out));
    }
    before = tick->now;
  }
  if (out.empty())
    return Error{"the recording has no commands for '" + target + "'",
                 listed(known, "it has none for any drive"),
                 {},
                 "/commands"};
  // The last one held until the end.
  out.push_back({(before - begin).s(), 0, 0, 0});
  return out;
}

Result<Samples> samples_of_table(const std::string& path) {
  std::error_code code;
  const std::uintmax_t size = std::filesystem::file_size(path, code);
  std::ifstream in(path, std::ios::binary);
  if (code || !in) return Error{"cannot read '" + path + "'"};
  if (size > most_table_bytes) return Error{"'" + path + "' is too long for a table of velocities"};
  std::string text(size, '\0');
  in.read(text.data(), static_cast<std::streamsize>(size));
  text.resize(static_cast<std::size_t>(in.gcount()));
  // Names of columns in the first line.
  const std::size_t first = text.find_first_not_of(" \t\r\n\"");
  if (first != std::string::npos && std::isalpha(static_cast<unsigned char>(text[first])))
    text.erase(0, std::min(text.size(), text.find('\n', first)));
  return read_samples(text);
}

Status resolve(Node& config, std::span<const std::string> paths, const Place& place) {
  const Node* const file_node = config.find("file");
  if (!file_node) return {};
  const auto text_of = [&](const char* key) {
    const Node* const node = config.find(key);
    return node && node->is_scalar() ? node->text() : std::string();
  };
  const Place at = file_node->place().file ? file_node->place() : place;
  const auto here = [&](Error error) {
    error.path = "/controller" + (error.path.empty() ? "/file" : error.path);
    if (!error.place.file || error.place.line == 0) {
      const Node* const named = config.find(error.path.substr(error.path.rfind('/') + 1));
      if (error.place.file) error.what = *error.place.file + ": " + error.what;
      error.place = named && named->place().file ? named->place() : at;
    }
    return error;
  };
  if (config.find("samples"))
    return here({"both a file and samples are given", "leave one of them out", {}, "/samples"});
  if (config.find("topic") && config.find("commands"))
    return here({"both a topic and commands are given", "leave one of them out", {}, "/commands"});
  const std::string folder = at.file ? std::filesystem::path(*at.file).parent_path().string() : "";
  auto path = find_resource(text_of("file"), folder, search_path(paths), at);
  if (!path) return here(std::move(path.error()));
  const std::string extension = std::filesystem::path(*path).extension().string();
  Result<Samples> samples = Samples{};
  if (extension == ".csv") {
    if (config.find("topic") || config.find("commands"))
      return here({"a table has no topics",
                   "its columns are time, vx, vy, wz",
                   {},
                   config.find("topic") ? "/topic" : "/commands"});
    samples = samples_of_table(*path);
    if (!samples) samples.error().what = *path + ": " + samples.error().what;
  } else if (config.find("commands")) {
    samples = samples_of_commands(*path, text_of("commands"));
  } else {
    auto reader = mcap::Reader::open(*path);
    if (!reader) return here(std::move(reader.error()));
    samples = samples_of_topic(*reader, text_of("topic"));
  }
  if (!samples) return here(std::move(samples.error()));
  if (samples->empty()) return here({"the recording has no messages there"});
  config.set("samples", Node::scalar(samples_text(*samples)));
  return {};
}

}  // namespace

Status resolve_playbacks(model::Setup& setup, std::span<const std::string> paths) {
  const auto resolve_all = [&](SharedList<model::ControllerDecl>& controllers) -> Status {
    for (std::size_t i = 0; i < controllers.size(); ++i) {
      if (std::as_const(controllers)[i].kind != "playback") continue;
      model::ControllerDecl& controller = controllers[i];
      SL_TRY(resolve(controller.config, paths, controller.place));
    }
    return {};
  };
  for (model::Instance& instance : setup.instances) SL_TRY(resolve_all(instance.controllers));
  for (model::TeamDecl& team : setup.teams) SL_TRY(resolve_all(team.controllers));
  return {};
}

Result<model::Setup> load_with_playbacks(const std::string& file, const LoadOptions& options,
                                         Diagnostics& diagnostics) {
  SL_ASSIGN(model::Setup setup, load(file, options, diagnostics));
  SL_TRY(resolve_playbacks(setup, options.paths));
  return setup;
}

}  // namespace sandlot::record
