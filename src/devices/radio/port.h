#pragma once
/// Port: what devices that send and receive packets have in common: names, inbox, orders.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "devices/kind.h"
#include "devices/radio/refill.h"
#include "media/packet.h"
#include "messages/messages.h"

namespace sandlot {

struct Port {
  static constexpr std::size_t most_received = 1000;  ///< packets that wait for the next sample
  static constexpr std::uint32_t always = 31;         ///< a level beyond all: whatever is active

  std::uint32_t medium = 0;
  std::uint64_t key = 0;
  BodyId body;
  Pose X_LS;
  std::string robot, team, address;
  Inbox* inbox = nullptr;
  EnergyMeter* energy = nullptr;  ///< null: the robot has no battery
  std::vector<std::byte> bytes;   ///< of the packet that is being sent, kept for its memory

  void begin(const DeviceBuild& build, std::uint32_t of_medium, const std::string& own_address) {
    medium = of_medium;
    key = build.key;
    body = build.body();
    X_LS = build.decl.X_LS;
    robot = build.instance.name.substr(0, most_packet_name);
    team = build.instance.team;
    address = own_address;
    inbox = build.receive(medium, most_received);
    energy = build.energy;
  }
  bool is_for_us(std::string_view to) const {
    return to.empty() || to == robot || (!team.empty() && to == team) || (!address.empty() && to == address);
  }
  Pose pose(const Engine& engine) const { return engine.states()[body.index].X_WB * X_LS; }

  /// Gives a packet to the medium.
  /// @param emission  strength, channel, direction and time
  /// @param head      number and focus
  /// @param per_bit_J  drawn from the robot's battery per bit of data
  /// @pre  names and data within the limits of media/packet.h
  void emit(const Context& context, Emission emission, const PacketHead& head, std::string_view to,
            std::span<const std::uint8_t> data, double per_bit_J) {
    if (energy && per_bit_J > 0) energy->draw(8 * static_cast<double>(data.size()) * per_bit_J);
    write_packet(head, robot, to, data, bytes);
    emission.medium = medium;
    emission.emitter = key;
    emission.body = body;
    emission.point_W = pose(context.engine).p;
    context.emissions.emit(emission, bytes);
  }
};

inline constexpr Field energy_per_bit_field{
    "energy_per_bit", "J", "Energy drawn from the robot's battery per bit of data sent.", 0, 1e6,
    Field::tunable};

/// Keys that radios and infrared ports share, the last in their lists.
void visit_packet_keys(auto& s, auto&& visit) {
  visit(Field{"channel", "1", "Channel on which it sends and receives.", 0, 100'000, Field::tunable},
        s.channel);
  visit(Field{"max_size", "B", "Greatest number of bytes in a packet.", 1, most_packet_data}, s.max_size);
  visit(Field{"queue", "1", "Number of orders that it takes per tick.", 1, most_queued_orders}, s.queue);
  visit(Field{"promiscuous", "", "Whether it publishes packets that are for others, too.", 0, 1,
              Field::tunable},
        s.promiscuous);
  visit(energy_per_bit_field, s.energy_per_bit_J);
  visit(Field{"rate", "Hz", "Samples per second; 0: one in every tick in which a packet has come.", 0, 1e6},
        s.rate_hz);
}

/// Orders to send that a device has taken so far.
struct SendCounts {
  std::uint64_t sent = 0, refused = 0;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"sent", "1", "Packets given to the medium."}, s.sent);
    visit(Field{"refused", "1", "Packets refused: too long, or with too long a name."}, s.refused);
  }
  bool takes(const msg::RadioPacket& packet, int max_size) {
    if (packet.data.size() <= static_cast<std::size_t>(max_size) && packet.to.size() <= most_packet_name)
      return true;
    ++refused;
    return false;
  }
};

/// Names mostly are as long as those that were there.
inline void assign(std::string_view from, std::string& to) {
  if (to.size() == from.size()) std::copy(from.begin(), from.end(), to.begin());
  else to = from;
}

/// Adds a packet to a message.
inline void add_reception(msg::RadioReceptionArray& message, Refill<msg::RadioReception>& refill,
                          const DeliveryHead& delivery, const PacketView& packet, double rssi_dBm) {
  msg::RadioReception& to = refill.next(message.packets);
  to.stamp = delivery.at;
  assign(packet.from, to.from);
  assign(packet.to, to.to);
  to.channel = delivery.channel;
  to.rssi = rssi_dBm;
  to.data.assign(packet.data.begin(), packet.data.end());
}

}  // namespace sandlot
