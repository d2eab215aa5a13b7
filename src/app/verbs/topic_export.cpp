#include "app/verbs/topic_export.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <map>

#include "app/commands.h"
#include "base/atomic_file.h"
#include "base/text.h"
#include "messages/dynamic.h"
#include "record/mcap/reader.h"
#include "sim/watch/csv_log.h"

namespace sandlot::app {
namespace {

constexpr std::size_t most_columns = 10'000, flush_bytes = std::size_t{1} << 20;

std::optional<double> as_number(const MessageValue& value) {
  if (const auto* x = std::get_if<bool>(&value)) return *x ? 1 : 0;
  if (const auto* x = std::get_if<std::int64_t>(&value)) return static_cast<double>(*x);
  if (const auto* x = std::get_if<std::uint64_t>(&value)) return static_cast<double>(*x);
  if (const auto* x = std::get_if<double>(&value)) return *x;
  return std::nullopt;
}

/// Columns of one topic.
struct TopicSource {
  DynamicSchema schema;
  std::vector<std::string> wanted;
  std::size_t begin = 0, end = 0;                             ///< its columns
  std::map<std::string, std::size_t, std::less<>> column_of;  ///< by path
  bool seen = false;
};

Error at(const std::string& file, std::string what, std::string fix = "") {
  Place place;
  place.file = std::make_shared<const std::string>(file);
  return {std::move(what), std::move(fix), place, ""};
}

/// Paths of all numbers in a message.
Result<std::vector<std::string>> numbers_in(const TopicSource& source, std::span<const std::byte> cdr) {
  std::vector<std::string> paths;
  SL_TRY(visit_values(source.schema.info(), cdr, [&](std::string_view path, const MessageValue& value) {
    if (as_number(value) && paths.size() <= most_columns) paths.emplace_back(path);
  }));
  return paths;
}

/// Whether messages of a type can have a number at `path`, "ranges[3]" or "pose.position.x", however long
/// lists become.
bool may_hold(const MessageInfo& info, std::string_view path) {
  const MessageInfo* type = &info;
  while (type) {
    const std::string_view step = path.substr(0, path.find('.'));
    const std::string_view name = step.substr(0, step.find('['));
    const auto field = std::find_if(type->fields.begin(), type->fields.end(),
                                    [&](const MessageField& each) { return each.name == name; });
    const bool indexed = name.size() < step.size();
    if (field == type->fields.end() || indexed != (field->count != MessageField::Count::one)) return false;
    // One number, in seconds.
    const bool is_time = field->message && (field->message->name == "builtin_interfaces/msg/Time" ||
                                            field->message->name == "builtin_interfaces/msg/Duration");
    if (is_time || step.size() == path.size())
      return step.size() == path.size() && (is_time || (!field->message && field->type != Wire::string));
    path.remove_prefix(step.size() + 1);
    type = field->message;
  }
  return false;
}

Status export_csv(const ExportOptions& options) {
  SL_ASSIGN(mcap::Reader reader, mcap::Reader::open(options.recording));
  if (reader.trouble()) std::fprintf(stderr, "warning: %s\n", reader.trouble()->text().c_str());
  std::vector<std::string> topics;
  for (const auto& [id, channel] : reader.summary().channels) topics.push_back(channel.topic);
  std::sort(topics.begin(), topics.end());
  topics.erase(std::unique(topics.begin(), topics.end()), topics.end());
  auto wanted = wanted_topics(options.values, topics);
  if (!wanted) return at(options.recording, wanted.error().what, wanted.error().fix);

  mcap::Query query;
  const auto ns = [](double s) {
    return static_cast<std::uint64_t>(std::max<std::int64_t>(0, Time::from_s(s).ns));
  };
  if (options.from_s) query.from = ns(*options.from_s);
  if (options.to_s) query.to = ns(*options.to_s);
  HeldColumns columns;
  std::map<std::string, TopicSource> sources;
  for (WantedTopic& topic : *wanted) {
    query.topics.push_back(topic.topic);
    const mcap::Channel* const channel = reader.find_channel(topic.topic);
    const mcap::Schema* const schema = channel ? reader.schema_of(*channel) : nullptr;
    if (!schema || schema->encoding != "ros2msg" || channel->message_encoding != "cdr")
      return at(options.recording,
                "the messages of '" + topic.topic + "' are not in CDR with a ros2msg schema");
    const std::string_view text(reinterpret_cast<const char*>(schema->data.data()), schema->data.size());
    auto parsed = DynamicSchema::parse(schema->name, text);
    if (!parsed) return at(options.recording, "the schema of '" + topic.topic + "': " + parsed.error().what);
    TopicSource source{std::move(*parsed), std::move(topic.paths), 0, 0, {}, false};
    {
      // Names are checked against the first message; a topic without a path stands for all its numbers.
      mcap::Cursor first = reader.messages({.topics = {topic.topic}});
      SL_ASSIGN(const mcap::Message* const message, first.next());
      if (message) {
        auto known = numbers_in(source, message->data);
        if (!known) return at(options.recording, "a message of '" + topic.topic + "': " + known.error().what);
        if (source.wanted.empty()) source.wanted = *known;
        for (const std::string& path : source.wanted)
          if (!may_hold(source.schema.info(), path))
            return at(options.recording, "messages of '" + topic.topic + "' have no number '" + path + "'",
                      suggestion(path, *known));
      }
    }
    source.begin = columns.size();
    for (const std::string& path : source.wanted)
      source.column_of.emplace(path, columns.add(topic.topic + "." + path));
    source.end = columns.size();
    if (columns.size() > most_columns)
      return Error{"these are more than 10000 columns",
                   "name the values, such as " + topic.topic + ".ranges[0]"};
    sources.emplace(topic.topic, std::move(source));
  }

  AtomicFile out(options.out);
  std::string text = columns.header();
  SL_TRY(out.write(text));
  mcap::Cursor cursor = reader.messages(query);
  while (true) {
    SL_ASSIGN(const mcap::Message* const message, cursor.next());
    if (!message) break;
    const TopicSource& source = sources.at(message->channel->topic);
    columns.message(message->log_time, source.begin, source.end, text);
    const Status visited = visit_values(source.schema.info(), message->data,
                                        [&](std::string_view path, const MessageValue& value) {
                                          const auto column = source.column_of.find(path);
                                          if (column == source.column_of.end()) return;
                                          if (const auto number = as_number(value))
                                            columns.set(column->second, *number);
                                        });
    if (!visited)
      return at(options.recording, "a message of '" + message->channel->topic + "': " + visited.error().what);
    if (text.size() > flush_bytes) SL_TRY(out.write(text));
  }
  columns.finish(text);
  SL_TRY(out.write(text));
  return out.commit();
}

}  // namespace

Result<std::vector<WantedTopic>> wanted_topics(std::span<const std::string> values,
                                               std::span<const std::string> topics) {
  std::vector<WantedTopic> out;
  for (const std::string& written : values) {
    const std::string value = starts_with(written, "/") ? written : "/" + written;
    const std::string* longest = nullptr;
    for (const std::string& topic : topics) {
      const bool fits = starts_with(value, topic) &&
                        (value.size() == topic.size() || value[topic.size()] == '.');
      if (fits && (!longest || topic.size() > longest->size())) longest = &topic;
    }
    if (!longest) {
      const std::string_view name = std::string_view(value).substr(0, value.find('.'));
      return Error{"there is no topic '" + std::string(name.substr(0, 200)) + "'", suggestion(name, topics)};
    }
    auto known = std::find_if(out.begin(), out.end(),
                              [&](const WantedTopic& w) { return w.topic == *longest; });
    const bool all = value.size() == longest->size();
    if (known == out.end()) {
      out.push_back({*longest, {}});
      known = out.end() - 1;
    } else if (all || known->paths.empty()) {
      known->paths.clear();  // the whole topic includes paths named separately
      continue;
    }
    if (!all) known->paths.push_back(value.substr(longest->size() + 1));
  }
  if (out.empty()) return Error{"nothing to export", "name topics or values by --values"};
  return out;
}

std::size_t HeldColumns::add(std::string name) {
  names_.push_back(std::move(name));
  cells_.emplace_back();
  return names_.size() - 1;
}

std::string HeldColumns::header() const {
  std::string out = "time";
  for (const std::string& name : names_) out += "," + csv_field(name);
  return out + "\n";
}

void HeldColumns::message(std::uint64_t time_ns, std::size_t begin, std::size_t end, std::string& out) {
  if (time_ns_ && *time_ns_ != time_ns) row(out);
  time_ns_ = time_ns;
  for (std::size_t i = begin; i < end; ++i) cells_[i].reset();
}

void HeldColumns::finish(std::string& out) {
  if (time_ns_) row(out);
  time_ns_.reset();
}

void HeldColumns::row(std::string& out) {
  out += number_text(static_cast<double>(*time_ns_) / 1e9);
  for (const auto& cell : cells_) {
    out += ',';
    if (cell) out += std::isnan(*cell) ? "nan" : number_text(*cell);
  }
  out += '\n';
}

int topic_export(const ExportOptions& options) {
  if (Status status = export_csv(options); !status) return complain(status.error());
  return exit_ok;
}

}  // namespace sandlot::app
