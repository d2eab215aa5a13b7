/// Messages of the server.
#include <algorithm>
#include <cstring>
#include <set>

#include "base/bytes.h"
#include "base/json_writer.h"
#include "wire/foxglove.h"

namespace sandlot::foxglove {
namespace {

/// A text message: `members` writes what follows its "op".
template <class F>
std::string text_message(std::string_view op, F members) {
  std::string out;
  JsonWriter w(out);
  w.object([&] {
    w.key("op").text(op);
    members(w);
  });
  return out;
}

void write_ids(JsonWriter& w, std::span<const std::uint32_t> ids) {
  w.list([&] {
    for (const std::uint32_t id : ids) w.integer(id);
  });
}

void write_side(JsonWriter& w, const Service::Side& side) {
  w.object([&] {
    w.key("encoding").text(side.encoding);
    w.key("schemaName").text(side.schema_name);
    w.key("schemaEncoding").text(side.schema_encoding);
    w.key("schema").text(side.schema);
  });
}

void write_named(JsonWriter& w, const std::vector<Graph::Named>& all, const char* ids) {
  w.list([&] {
    for (const Graph::Named& each : all)
      w.object([&] {
        w.key("name").text(each.name);
        w.key(ids).texts(each.ids);
      });
  });
}

void write_value(JsonWriter&, std::monostate) {}
void write_value(JsonWriter& w, bool value) { w.key("value").flag(value); }
void write_value(JsonWriter& w, double value) { w.key("value").real(value); }
void write_value(JsonWriter& w, const std::string& value) { w.key("value").text(value); }
void write_value(JsonWriter& w, const std::vector<double>& values) {
  w.key("value").list([&] {
    for (const double value : values) w.real(value);
  });
}
void write_value(JsonWriter& w, const std::vector<std::string>& values) { w.key("value").texts(values); }

template <class... Parts>
std::vector<std::byte> bytes_of(const Parts&... parts) {
  ByteWriter w;
  (write(w, parts), ...);
  return std::move(w.buffer());
}

void append(std::vector<std::byte>& out, std::span<const std::byte> bytes) {
  out.insert(out.end(), bytes.begin(), bytes.end());
}

std::uint64_t ns(Time time) { return static_cast<std::uint64_t>(std::max<std::int64_t>(time.ns, 0)); }

}  // namespace

std::string server_info(const ServerInfo& info) {
  return text_message("serverInfo", [&](JsonWriter& w) {
    w.key("name").text(info.name);
    w.key("capabilities").texts(info.capabilities);
    w.key("supportedEncodings").texts(info.encodings);
    w.key("metadata").object([&] {
      for (const auto& [key, value] : info.metadata) w.key(key).text(value);
    });
    w.key("sessionId").text(info.session_id);
  });
}

std::string status(Level level, std::string_view message, std::string_view id) {
  return text_message("status", [&](JsonWriter& w) {
    w.key("level").integer(static_cast<int>(level));
    w.key("message").text(message);
    if (!id.empty()) w.key("id").text(id);
  });
}

std::string advertise(std::span<const Channel> channels) {
  return text_message("advertise", [&](JsonWriter& w) {
    w.key("channels").list([&] {
      for (const Channel& each : channels)
        w.object([&] {
          w.key("id").integer(each.id);
          w.key("topic").text(each.topic);
          w.key("encoding").text(each.encoding);
          w.key("schemaName").text(each.schema_name);
          w.key("schema").text(each.schema);
          w.key("schemaEncoding").text(each.schema_encoding);
        });
    });
  });
}

std::string unadvertise(std::span<const std::uint32_t> ids) {
  return text_message("unadvertise", [&](JsonWriter& w) { write_ids(w.key("channelIds"), ids); });
}

std::string advertise_services(std::span<const Service> services) {
  return text_message("advertiseServices", [&](JsonWriter& w) {
    w.key("services").list([&] {
      for (const Service& each : services)
        w.object([&] {
          w.key("id").integer(each.id);
          w.key("name").text(each.name);
          w.key("type").text(each.type);
          write_side(w.key("request"), each.request);
          write_side(w.key("response"), each.response);
        });
    });
  });
}

std::string unadvertise_services(std::span<const std::uint32_t> ids) {
  return text_message("unadvertiseServices", [&](JsonWriter& w) { write_ids(w.key("serviceIds"), ids); });
}

std::string parameter_values(std::span<const Parameter> parameters, std::string_view id) {
  return text_message("parameterValues", [&](JsonWriter& w) {
    w.key("parameters").list([&] {
      for (const Parameter& each : parameters)
        w.object([&] {
          w.key("name").text(each.name);
          std::visit([&](const auto& value) { write_value(w, value); }, each.value);
          if (!each.type.empty()) w.key("type").text(each.type);
        });
    });
    if (!id.empty()) w.key("id").text(id);
  });
}

std::string graph_update(const Graph& graph, const Graph& removed) {
  std::set<std::string> topics, services;
  for (const auto& each : removed.published) topics.insert(each.name);
  for (const auto& each : removed.subscribed) topics.insert(each.name);
  for (const auto& each : removed.services) services.insert(each.name);
  return text_message("connectionGraphUpdate", [&](JsonWriter& w) {
    write_named(w.key("publishedTopics"), graph.published, "publisherIds");
    write_named(w.key("subscribedTopics"), graph.subscribed, "subscriberIds");
    write_named(w.key("advertisedServices"), graph.services, "providerIds");
    w.key("removedTopics").texts(topics);
    w.key("removedServices").texts(services);
  });
}

std::string service_failure(std::uint32_t service, std::uint32_t call, std::string_view message) {
  return text_message("serviceCallFailure", [&](JsonWriter& w) {
    w.key("serviceId").integer(service);
    w.key("callId").integer(call);
    w.key("message").text(message);
  });
}

std::array<std::byte, 13> message_header(std::uint32_t subscription, Time stamp) {
  std::array<std::byte, 13> out{std::byte{1}};
  const std::uint64_t at = ns(stamp);
  std::memcpy(out.data() + 1, &subscription, 4);
  std::memcpy(out.data() + 5, &at, 8);
  return out;
}

std::vector<std::byte> time(Time now) { return bytes_of(std::uint8_t{2}, ns(now)); }

std::vector<std::byte> service_response(std::uint32_t service, std::uint32_t call, std::string_view encoding,
                                        std::span<const std::byte> payload) {
  auto out = bytes_of(std::uint8_t{3}, service, call, std::string(encoding));
  append(out, payload);
  return out;
}

std::vector<std::byte> asset(std::uint32_t request, std::span<const std::byte> data) {
  auto out = bytes_of(std::uint8_t{4}, request, std::uint8_t{0}, std::uint32_t{0});
  append(out, data);
  return out;
}

std::vector<std::byte> asset_error(std::uint32_t request, std::string_view message) {
  return bytes_of(std::uint8_t{4}, request, std::uint8_t{1}, std::string(message));
}

}  // namespace sandlot::foxglove
