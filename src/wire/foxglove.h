#pragma once
/// The Foxglove WebSocket protocol: bytes <-> structs. No sockets, no state.
///
/// Both sub-protocol names carry the same messages. What a client sent is decoded by read_text() and read_binary() into one
/// ClientMessage; the messages of the server are written by the functions below, text as JSON, binary little-endian.
///
/// Errors   a message that is none of these: a sentence that can go back to the client as a status. Bounded by the limits below,
///          whatever the bytes; nothing is allocated that is larger than the message.
/// Source   github.com/foxglove/ws-protocol (specification), facts proven with its own client.
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/result.h"
#include "base/time.h"

namespace sandlot::foxglove {

inline constexpr std::string_view subprotocols[] = {"foxglove.websocket.v1", "foxglove.sdk.v1"};

// --- messages of clients ---
struct Subscribe {
  struct Each {
    std::uint32_t id = 0, channel = 0;
  };
  std::vector<Each> subscriptions;
};
struct Unsubscribe {
  std::vector<std::uint32_t> ids;
};
/// Channels that a client will publish on.
struct Advertise {
  struct Each {
    std::uint32_t id = 0;
    std::string topic, encoding, schema_name;
  };
  std::vector<Each> channels;
};
struct Unadvertise {
  std::vector<std::uint32_t> ids;
};
struct GetParameters {
  std::vector<std::string> names;  ///< empty: all
  std::string id;
};
struct Parameter {
  std::string name;
  /// Nothing: it has no value (or shall be deleted).
  std::variant<std::monostate, bool, double, std::string, std::vector<double>, std::vector<std::string>>
      value;
  /// "float64" and "float64_array": a number is meant although JSON writes an integer. "byte_array": text is base64.
  std::string type;
};
struct SetParameters {
  std::vector<Parameter> parameters;
  std::string id;
};
struct SubscribeParameters {
  std::vector<std::string> names;  ///< empty: all
  bool subscribe = true;           ///< false: unsubscribe
};
struct SubscribeGraph {
  bool subscribe = true;
};
struct FetchAsset {
  std::string uri;
  std::uint32_t request = 0;
};
/// A message on one of the client's channels; `bytes` point into what was read.
struct ClientData {
  std::uint32_t channel = 0;
  std::span<const std::byte> bytes;
};
struct CallService {
  std::uint32_t service = 0, call = 0;
  std::string encoding;
  std::span<const std::byte> bytes;
};
/// Sub-protocol sdk only.
struct PlaybackControl {
  bool play = false;
  double speed = 1;
  std::optional<std::uint64_t> seek_ns;
  std::string id;
};
using ClientMessage =
    std::variant<Subscribe, Unsubscribe, Advertise, Unadvertise, GetParameters, SetParameters,
                 SubscribeParameters, SubscribeGraph, FetchAsset, ClientData, CallService, PlaybackControl>;

inline constexpr std::size_t most_text_bytes = 1 << 20, most_binary_bytes = 16 << 20;
inline constexpr std::size_t most_entries = 20'000;  ///< in one list of one message
inline constexpr std::size_t most_name_bytes = 4096;

Result<ClientMessage> read_text(std::string_view text);
Result<ClientMessage> read_binary(std::span<const std::byte> bytes);

// --- messages of the server ---
struct ServerInfo {
  std::string name;
  std::vector<std::string> capabilities, encodings;
  std::vector<std::pair<std::string, std::string>> metadata;
  std::string session_id;
};
struct Channel {
  std::uint32_t id = 0;
  std::string topic, encoding, schema_name, schema, schema_encoding;
};
struct Service {
  std::uint32_t id = 0;
  std::string name, type;
  struct Side {
    std::string encoding, schema_name, schema_encoding, schema;
  } request, response;
};
enum class Level : std::uint8_t { info, warning, error };
struct Graph {
  struct Named {
    std::string name;
    std::vector<std::string> ids;
  };
  std::vector<Named> published, subscribed, services;
};

std::string server_info(const ServerInfo& info);
std::string status(Level level, std::string_view message, std::string_view id = {});
std::string advertise(std::span<const Channel> channels);
std::string unadvertise(std::span<const std::uint32_t> ids);
std::string advertise_services(std::span<const Service> services);
std::string unadvertise_services(std::span<const std::uint32_t> ids);
std::string parameter_values(std::span<const Parameter> parameters, std::string_view id = {});
/// Everything; clients replace what they knew. @param removed  names that are gone since the last update
std::string graph_update(const Graph& graph, const Graph& removed);
std::string service_failure(std::uint32_t service, std::uint32_t call, std::string_view message);

/// The 13 bytes before a message's payload, so that one payload serves many clients.
std::array<std::byte, 13> message_header(std::uint32_t subscription, Time stamp);
std::vector<std::byte> time(Time now);
std::vector<std::byte> service_response(std::uint32_t service, std::uint32_t call, std::string_view encoding,
                                        std::span<const std::byte> payload);
std::vector<std::byte> asset(std::uint32_t request, std::span<const std::byte> data);
std::vector<std::byte> asset_error(std::uint32_t request, std::string_view message);

}  // namespace sandlot::foxglove
