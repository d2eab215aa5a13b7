#pragma once
/// The rosbridge v2 protocol: bytes <-> structs. No sockets, no state.
///
/// Messages  an object with the key `op`, as JSON, or as CBOR in a binary message. Keys that are not known are passed over, as
///           other servers do; a key twice is an error.
/// Ours      operations of Sandlot: sandlot.hello, sandlot.claim, sandlot.done, sandlot.release; the server says sandlot.tick. docs/clients.md.
/// Errors    a sentence that can go back to the client as a status. Bounded by the limits below, whatever the bytes.
/// Source    RobotWebTools/rosbridge_suite, ROSBRIDGE_PROTOCOL.md; facts proven with roslib.
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "base/result.h"
#include "base/time.h"
#include "messages/json.h"
#include "messages/registry.h"

namespace sandlot {
class TopicBase;
}

namespace sandlot::rosbridge {

inline constexpr std::size_t most_bytes = 1 << 20;  ///< of one message of a client
inline constexpr std::size_t most_name = 4096;

/// The content of a message, a request or an answer.
class Body {
 public:
  Body() = default;
  explicit Body(std::shared_ptr<const nlohmann::json> document) : document_(std::move(document)) {}
  explicit operator bool() const { return document_ != nullptr; }
  /// As a message of a type, in CDR; what it leaves out keeps its default. Errors as in messages/json.h.
  Result<std::vector<std::byte>> to_cdr(const MessageInfo& info) const;
  /// As the command that a slot takes.
  Result<std::vector<std::byte>> to_command(const TopicBase& slot) const;
  std::string text() const;
  const nlohmann::json* document() const { return document_.get(); }

 private:
  std::shared_ptr<const nlohmann::json> document_;
};

struct Advertise {
  std::string topic, type;
};
struct Unadvertise {
  std::string topic;
};
struct Publish {
  std::string topic;
  Body message;
};
enum class Compression : std::uint8_t { none, png, cbor, cbor_raw };
struct Subscribe {
  std::string topic, type;
  double throttle_s = 0;
  std::size_t fragment_size = 0;  ///< 0: whole
  Compression compression = Compression::none;
};
struct Unsubscribe {
  std::string topic;
};
struct CallService {
  std::string service;
  Body args;
  std::size_t fragment_size = 0;
  Compression compression = Compression::none;
};
enum class Level : std::uint8_t { info, warning, error, none };
struct SetLevel {
  Level level = Level::error;
};
struct Fragment {
  std::string data;
  std::size_t number = 0, total = 0;
};
/// What the server has no use for, such as services of clients: named in its answer.
struct Other {
  std::string op;
};
struct Claim {
  std::string robot, team;  ///< one of them
  std::string token;
  bool lockstep = false;
  double deadline_s = 1;
  std::string name;  ///< that the client gives itself; "": none
};
struct Done {
  std::uint64_t step = 0;
  std::string program;  ///< "": the only one
  Body orders, samples;
};
struct Release {};
/// Asks a server for a sign of life; by UDP also for the nonce of the client's address.
struct Hello {};
using Operation = std::variant<Advertise, Unadvertise, Publish, Subscribe, Unsubscribe, CallService, SetLevel,
                               Fragment, Other, Claim, Done, Release, Hello>;

struct ClientMessage {
  std::string id;
  Operation operation;
};

Result<ClientMessage> read_text(std::string_view text);
Result<ClientMessage> read_binary(std::span<const std::byte> cbor);

// --- messages of the server ---
std::string status(Level level, std::string_view message, std::string_view id);
/// {"op":"publish","topic":...,"msg":...}
std::string publish_json(std::string_view topic, const MessageInfo& info, std::span<const std::byte> cdr);
std::vector<std::byte> publish_cbor(std::string_view topic, const MessageInfo& info,
                                    std::span<const std::byte> cdr);
std::vector<std::byte> publish_cbor_raw(std::string_view topic, Time stamp, std::span<const std::byte> cdr);
/// @param values  JSON of the response, or of the reason as a string
std::string service_response(std::string_view service, std::string_view id, std::string_view values,
                             bool result);
/// @param random  written as text: JavaScript's numbers end at 2^53
std::string tick(std::string_view program, std::uint64_t step, Time now, std::uint64_t random);
std::string quoted(std::string_view text);
/// A text among the arguments of a call; "": there is none.
std::string text_of(const Body& args, const char* key);
/// A value among them that may be JSON itself or JSON in a text, as JSON: what rosapi calls the value of a parameter. "": none.
std::string value_of(const Body& args, const char* key);

/// A JSON text in pieces of at most `size` bytes, each a message of its own.
std::vector<std::string> fragments(std::string_view text, std::size_t size, std::string_view id);

}  // namespace sandlot::rosbridge
