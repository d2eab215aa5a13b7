#pragma once
/// Face: the side of one client that speaks its protocol (server/faces/). The hub says what there is and what comes; the face
/// writes that in its protocol, and turns what the client says into calls of the hub. A protocol is one class.
///
/// Threads   the transport's.
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "messages/registry.h"
#include "server/http/access.h"
#include "server/http/transport.h"
#include "server/services/service_call.h"
#include "wire/foxglove.h"

namespace sandlot::server {

/// A topic that clients may subscribe to.
struct ChannelInfo {
  std::uint32_t id = 0;
  std::string topic;
  std::string encoding;               ///< "cdr", "json", or a form of our own
  std::string schema_name;            ///< "sensor_msgs/msg/LaserScan", "sandlot.World"
  const MessageInfo* type = nullptr;  ///< null: it is not CDR
};

/// A service that clients may call.
struct ServiceOffer {
  std::uint32_t number = 0;
  std::string name;
  ServiceInfo type;
};

/// A message for the subscribers of a channel. Forms that several of them need are written once.
class Outgoing {
 public:
  Outgoing(const ChannelInfo& channel, Time stamp, Payload bytes)
      : channel(channel), stamp(stamp), bytes(std::move(bytes)) {}
  const ChannelInfo& channel;
  const Time stamp;
  const Payload bytes;

  /// Slots for the forms of faces; empty at first.
  enum class Form : std::uint8_t { json, png, cbor, cbor_raw, count_ };
  Payload& form(Form which) const { return forms_[static_cast<std::size_t>(which)]; }

 private:
  mutable Payload forms_[static_cast<std::size_t>(Form::count_)];
};

/// A control step that a client in lockstep is to answer.
struct StepNotice {
  std::string program;  ///< "red1/controller"
  std::uint64_t number = 0;
  Time now;
  std::uint64_t random = 0;
};

class Face {
 public:
  virtual ~Face() = default;
  /// What the client said.
  virtual void message(std::span<const std::byte> bytes, bool text) = 0;
  /// The same of a client that has said too much: it is told so, and nothing else happens.
  virtual void over_budget(std::span<const std::byte> bytes, bool text) = 0;

  // What the hub says; a protocol leaves out what it has no word for.
  virtual void welcome(const Access&) {}
  virtual void add_channels(std::span<const ChannelInfo* const>) {}
  virtual void remove_channels(std::span<const std::uint32_t>) {}
  virtual void add_services(std::span<const ServiceOffer* const>) {}
  virtual void remove_services(std::span<const std::uint32_t>) {}
  /// @return false: it was dropped
  virtual bool deliver(std::uint32_t subscription, const Outgoing& message, bool droppable) = 0;
  virtual void tell_time(Time, [[maybe_unused]] Payload& shared) {}
  /// @param about  what it answers to, in the protocol's own form; "": nothing
  virtual void report(foxglove::Level level, std::string_view text, std::string_view about) = 0;
  virtual void tell_parameters(std::span<const foxglove::Parameter>, std::string_view) {}
  virtual void tell_graph(const foxglove::Graph&, const foxglove::Graph&) {}
  virtual void tell_step(const StepNotice&) {}
};

}  // namespace sandlot::server
