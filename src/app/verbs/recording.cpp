/// Verbs about recordings: `doctor FILE`, `topic list`, `topic echo`, `topic hz`.
#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "base/json_text.h"
#include "base/text.h"
#include "base/time.h"
#include "messages/dynamic.h"
#include "messages/json.h"
#include "record/mcap/repair.h"
#include "run/snapshot_files.h"

namespace sandlot::app {
namespace {

using Json = nlohmann::ordered_json;

double seconds(std::uint64_t ns) { return static_cast<double>(ns) * 1e-9; }

mcap::Query query_of(const RecordingOptions& options) {
  mcap::Query query;
  if (options.from_s) query.from = static_cast<std::uint64_t>(Time::from_s(*options.from_s).ns);
  if (options.to_s) query.to = static_cast<std::uint64_t>(Time::from_s(*options.to_s).ns);
  if (!options.topic.empty()) query.topics = {options.topic};
  return query;
}

/// Opens a recording for reading; damage is a warning.
Result<mcap::Reader> open(const RecordingOptions& options) {
  SL_ASSIGN(mcap::Reader reader, mcap::Reader::open(options.file));
  if (reader.trouble())
    std::fprintf(stderr, "warning: %s; what comes before is shown, `sandlot doctor %s` repairs the file\n",
                 reader.trouble()->text().c_str(), options.file.c_str());
  if (!options.topic.empty() && !reader.find_channel(options.topic)) {
    std::vector<std::string> known;
    for (const auto& [id, channel] : reader.summary().channels) known.push_back(channel.topic);
    return Error{"the recording has no topic '" + options.topic + "'",
                 suggestion(options.topic, known),
                 {std::make_shared<const std::string>(options.file), 0, 0}};
  }
  return reader;
}

std::uint64_t count_of(const mcap::Summary& summary, std::uint16_t channel) {
  const auto found = summary.statistics.channel_message_counts.find(channel);
  return found == summary.statistics.channel_message_counts.end() ? 0 : found->second;
}

Json contents(const mcap::Summary& summary, const mcap::Header& header) {
  const mcap::Statistics& s = summary.statistics;
  return {{"profile", header.profile},        {"library", header.library},
          {"messages", s.message_count},      {"topics", summary.channels.size()},
          {"chunks", summary.chunks.size()},  {"attachments", summary.attachments.size()},
          {"start_s", seconds(s.start_time)}, {"end_s", seconds(s.end_time)}};
}

}  // namespace

int doctor_file(const RecordingOptions& options) {
  if (is_snapshot_file(options.file)) {
    const auto facts = snapshot_facts(options.file);
    if (!facts) return complain(facts.error());
    Json json;
    for (const auto& [name, value] : *facts) {
      json[name] = value;
      if (!options.json) fmt::print("{:<9} {}\n", name, value);
    }
    if (options.json) fmt::print("{}\n", json_text(json));
    return exit_ok;
  }
  auto examined = mcap::examine(options.file);
  if (!examined) return complain(examined.error());
  Json json{{"file", options.file}, {"whole", examined->whole()}, {"bytes", examined->file_bytes}};
  json.update(contents(examined->found, examined->header));
  Json damages = Json::array();
  for (const mcap::Damage& damage : examined->damages)
    damages.push_back({{"offset", damage.offset}, {"bytes", damage.bytes}, {"what", damage.what}});
  json["damages"] = damages;
  json["end"] = examined->summary_trouble ? examined->summary_trouble->what : "";
  bool failed = false;
  if (!examined->whole() && !options.dry_run) {
    const auto repaired = mcap::repair(options.file, *examined);
    if (repaired) {
      json["repaired"] = {{"messages", repaired->kept_messages},
                          {"lost_bytes", repaired->lost_bytes},
                          {"bytes", repaired->new_bytes},
                          {"kept_original", repaired->kept_original}};
    } else {
      std::fprintf(stderr, "error: %s\n", repaired.error().text().c_str());
      failed = true;
    }
  }
  if (options.json) {
    fmt::print("{}\n", json_text(json));
  } else {
    fmt::print("{}: {}, {} messages on {} topics in {} chunks, {:.3f} s to {:.3f} s, written by {}\n",
               options.file, examined->whole() ? "whole" : "not whole",
               examined->found.statistics.message_count, examined->found.channels.size(),
               examined->found.chunks.size(), json["start_s"].get<double>(), json["end_s"].get<double>(),
               examined->header.library);
    for (const mcap::Damage& damage : examined->damages)
      fmt::print("  {} ({} bytes)\n", damage.what, damage.bytes);
    if (examined->summary_trouble) fmt::print("  {}\n", examined->summary_trouble->what);
    if (json.contains("repaired")) {
      const Json& r = json["repaired"];
      fmt::print("repaired: {} messages kept, {} bytes lost\n", r["messages"].get<std::uint64_t>(),
                 r["lost_bytes"].get<std::uint64_t>());
      if (!r["kept_original"].get<std::string>().empty())
        fmt::print("the damaged file is kept as {}\n", r["kept_original"].get<std::string>());
    } else if (!examined->whole() && !failed) {
      fmt::print("`sandlot doctor {}` keeps what is readable and makes the file whole\n", options.file);
    }
  }
  return examined->whole() || json.contains("repaired") ? exit_ok : exit_failed;
}

int topic_list(const RecordingOptions& options) {
  const auto reader = open(options);
  if (!reader) return complain(reader.error());
  const mcap::Summary& summary = reader->summary();
  Json list = Json::array();
  for (const auto& [id, channel] : summary.channels) {
    const mcap::Schema* const schema = reader->schema_of(channel);
    list.push_back({{"topic", channel.topic},
                    {"type", schema ? schema->name : ""},
                    {"encoding", channel.message_encoding},
                    {"messages", count_of(summary, id)}});
  }
  std::sort(list.begin(), list.end(), [](const Json& a, const Json& b) {
    return a["topic"].get<std::string>() < b["topic"].get<std::string>();
  });
  if (options.json) {
    Json json = contents(summary, reader->header());
    json["list"] = list;
    fmt::print("{}\n", json_text(json));
    return exit_ok;
  }
  for (const Json& each : list)
    fmt::print("{:<44} {:<36} {:>9}\n", each["topic"].get<std::string>(), each["type"].get<std::string>(),
               each["messages"].get<std::uint64_t>());
  return exit_ok;
}

int topic_echo(const RecordingOptions& options) {
  const auto reader = open(options);
  if (!reader) return complain(reader.error());
  const mcap::Channel* const found = reader->find_channel(options.topic);
  if (!found) return complain({"'' is not a topic", "`sandlot topic list " + options.file + "` names them"});
  const mcap::Channel& channel = *found;
  const mcap::Schema* const schema = reader->schema_of(channel);
  const bool is_json = channel.message_encoding == "json";
  if (!is_json && (channel.message_encoding != "cdr" || !schema || schema->encoding != "ros2msg"))
    return complain({"the messages of '" + channel.topic + "' are '" + channel.message_encoding +
                         "', which cannot be shown",
                     "this Sandlot shows cdr with a ros2msg schema, and json"});
  std::optional<DynamicSchema> types;
  if (!is_json) {
    auto parsed = DynamicSchema::parse(
        schema->name, {reinterpret_cast<const char*>(schema->data.data()), schema->data.size()});
    if (!parsed) return complain(parsed.error());
    types = std::move(*parsed);
  }
  mcap::Cursor cursor = reader->messages(query_of(options));
  std::string text;
  for (std::uint64_t shown = 0; !options.count || shown < *options.count; ++shown) {
    auto message = cursor.next();
    if (!message) return complain(message.error());
    if (!*message) break;
    const mcap::Message& m = **message;
    if (is_json) text.assign(reinterpret_cast<const char*>(m.data.data()), m.data.size());
    else if (Status status = cdr_to_json(types->info(), m.data, text); !status)
      return complain(status.error());
    if (options.json) fmt::print("{{\"time\":{:.9f},\"message\":{}}}\n", seconds(m.log_time), text);
    else fmt::print("{:.6f} {}\n", seconds(m.log_time), text);
    if (std::ferror(stdout)) break;
  }
  return exit_ok;
}

int topic_hz(const RecordingOptions& options) {
  const auto reader = open(options);
  if (!reader) return complain(reader.error());
  struct Times {
    std::uint64_t count = 0, first = 0, last = 0, shortest = UINT64_MAX, longest = 0;
  };
  std::map<std::string, Times> topics;
  mcap::Cursor cursor = reader->messages(query_of(options));
  for (;;) {
    auto message = cursor.next();
    if (!message) return complain(message.error());
    if (!*message) break;
    Times& t = topics[(*message)->channel->topic];
    const std::uint64_t time = (*message)->log_time;
    if (t.count++ == 0) {
      t.first = time;
    } else {
      t.shortest = std::min(t.shortest, time - t.last);
      t.longest = std::max(t.longest, time - t.last);
    }
    t.last = time;
  }
  Json list = Json::array();
  for (const auto& [topic, t] : topics) {
    const bool several = t.count > 1 && t.last > t.first;
    const double hz = several ? static_cast<double>(t.count - 1) / seconds(t.last - t.first) : 0.0;
    list.push_back({{"topic", topic},
                    {"messages", t.count},
                    {"hz", hz},
                    {"shortest_s", several ? seconds(t.shortest) : 0.0},
                    {"longest_s", several ? seconds(t.longest) : 0.0}});
    if (!options.json && !several)
      fmt::print("{:<44} {:>9}     {} {}\n", topic, "-", t.count,
                 t.count == 1 ? "message" : "messages, all at one time");
    else if (!options.json)
      fmt::print("{:<44} {:>9.3f} Hz  {} messages, {:.6f} to {:.6f} s apart\n", topic, hz, t.count,
                 list.back()["shortest_s"].get<double>(), list.back()["longest_s"].get<double>());
  }
  if (options.json) fmt::print("{}\n", json_text(list));
  return exit_ok;
}

}  // namespace sandlot::app
