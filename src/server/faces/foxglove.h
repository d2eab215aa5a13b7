#pragma once
/// The Foxglove WebSocket protocol as a face. docs/viewer_protocol.md.
#include "server/clients/hub.h"

namespace sandlot::server {

class FoxgloveFace final : public Face {
 public:
  FoxgloveFace(Hub& hub, Transport& transport, ClientId client)
      : hub_(hub), transport_(transport), client_(client) {}

  void message(std::span<const std::byte> bytes, bool text) override;
  void over_budget(std::span<const std::byte> bytes, bool text) override;
  void welcome(const Access& access) override;
  void add_channels(std::span<const ChannelInfo* const> channels) override;
  void remove_channels(std::span<const std::uint32_t> numbers) override;
  void add_services(std::span<const ServiceOffer* const> services) override;
  void remove_services(std::span<const std::uint32_t> numbers) override;
  bool deliver(std::uint32_t subscription, const Outgoing& message, bool droppable) override;
  void tell_time(Time now, Payload& shared) override;
  void report(foxglove::Level level, std::string_view text, std::string_view about) override;
  void tell_parameters(std::span<const foxglove::Parameter> parameters, std::string_view about) override;
  void tell_graph(const foxglove::Graph& now, const foxglove::Graph& removed) override;

 private:
  void handle(const foxglove::ClientMessage& message);
  void subscribe(const foxglove::Subscribe& request);
  void advertise(const foxglove::Advertise& request);
  void publish(const foxglove::ClientData& data);
  void call(const foxglove::CallService& request);
  void fetch(const foxglove::FetchAsset& request);
  void refuse(const std::string& why, std::string_view about = {}) { hub_.refuse(client_, why, about); }

  Hub& hub_;
  Transport& transport_;
  const ClientId client_;
  std::map<std::uint32_t, bool> publications_;  ///< whether they are JSON
};

}  // namespace sandlot::server
