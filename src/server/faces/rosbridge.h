#pragma once
/// The rosbridge v2 protocol as a face, with claims and lockstep of our own. docs/clients.md.
///
/// Topics    those in CDR; worlds, poses and states of the page have their own forms and are not here.
/// Throttle  of the messages that come within `throttle_rate` of the one sent last none is sent; `queue_length` has no effect.
/// Fragments of a client are put together: at most one message at a time, most_bytes in all, within fragment_patience.
/// Not here  services and actions of clients, BSON.
#include <chrono>
#include <functional>
#include <map>
#include <optional>

#include "server/clients/hub.h"
#include "wire/rosbridge.h"

namespace sandlot::server {

class RosbridgeFace final : public Face {
 public:
  /// What carries the messages. tcp, udp: JSON alone, no binary messages; udp: of a limited size.
  enum class Carrier : std::uint8_t { websocket, tcp, udp };
  RosbridgeFace(Hub& hub, Transport& transport, ClientId client, Carrier carrier)
      : hub_(hub), transport_(transport), client_(client), carrier_(carrier) {}

  void message(std::span<const std::byte> bytes, bool text) override;
  void over_budget(std::span<const std::byte> bytes, bool text) override;
  void remove_channels(std::span<const std::uint32_t> numbers) override;
  bool deliver(std::uint32_t subscription, const Outgoing& message, bool droppable) override;
  void report(foxglove::Level level, std::string_view text, std::string_view about) override;
  void tell_parameters(std::span<const foxglove::Parameter> values, std::string_view about) override;
  void tell_step(const StepNotice& step) override;

 private:
  using Clock = std::chrono::steady_clock;
  struct Subscription {
    std::uint32_t channel = 0;
    rosbridge::Compression compression = rosbridge::Compression::none;
    std::size_t fragment_size = 0;
    std::map<std::string, double> throttles_s;  ///< by the client's id: several parts of it may listen
    Clock::time_point next;
    bool too_long = false;  ///< it was told that messages do not fit
    double throttle_s() const;
  };
  struct Assembly {
    std::string id;
    std::vector<std::optional<std::string>> parts;
    std::size_t bytes, missing;
    Clock::time_point begun;
  };

  void handle(const rosbridge::ClientMessage& message);
  void subscribe(const std::string& id, const rosbridge::Subscribe& request);
  void unsubscribe(const std::string& id, const std::string& topic);
  void advertise(const std::string& id, const rosbridge::Advertise& request);
  void publish(const std::string& id, const rosbridge::Publish& request);
  void call(const std::string& id, const rosbridge::CallService& request);
  void fragment(const std::string& id, const rosbridge::Fragment& request);
  void claim(const std::string& id, const rosbridge::Claim& request);
  void done(const std::string& id, const rosbridge::Done& request);
  // rosapi.cpp
  std::optional<std::string> answer_of_rosapi(const std::string& service, const rosbridge::Body& args);
  /// @param values  JSON of the response, or of the reason
  using Respond = std::function<void(std::string_view values, bool result)>;
  /// A service of rosapi that asks for parameters, which come later. @return false: it is none of them
  bool call_parameters(const std::string& service, const rosbridge::CallService& request,
                       const Respond& respond);
  void refuse(const std::string& why, const std::string& id) { hub_.refuse(client_, why, id); }
  bool send_text(std::string text, std::size_t fragment_size, bool droppable);
  void send_response(const std::string& service, const std::string& id, std::string_view values, bool result,
                     std::size_t fragment_size, bool png);
  bool fits(std::size_t bytes, std::size_t fragment_size) const;

  Hub& hub_;
  Transport& transport_;
  const ClientId client_;
  const Carrier carrier_;
  rosbridge::Level level_ = rosbridge::Level::error;
  std::map<std::string, Subscription> subscriptions_;  ///< by topic
  std::map<std::string, std::uint32_t> publications_;  ///< by topic
  std::uint32_t next_publication_ = 1;
  std::uint64_t fragments_sent_ = 0;
  std::optional<Assembly> assembly_;
  /// A call that waits for parameters.
  struct ParameterCall {
    std::string what;  ///< "get_param"
    Respond respond;
    std::string otherwise;  ///< JSON of the value where there is none; "": that is a failure
    std::string error;
  };
  std::map<std::string, ParameterCall> parameter_calls_;  ///< by what the hub calls them
  std::uint64_t parameter_calls_made_ = 0;
};

/// "/chatter" of "chatter": clients leave the slash out.
std::string with_slash(std::string_view name);

}  // namespace sandlot::server
