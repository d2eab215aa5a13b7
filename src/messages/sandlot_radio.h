#pragma once
/// sandlot_msgs: packets of radios, and neighbours by range and bearing.
#include <string>
#include <vector>

#include "messages/std_msgs.h"

namespace sandlot::msg {

/// A packet to send.
struct RadioPacket {
  static constexpr const char* ros_type = "sandlot_msgs/msg/RadioPacket";
  std::string to;
  std::vector<std::uint8_t> data;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"to", "", "Name of the robot or team that it is for; empty: all."}, s.to);
    visit(Field{"data", "", "Content of the packet."}, s.data);
  }
};

/// A packet as it was received.
struct RadioReception {
  static constexpr const char* ros_type = "sandlot_msgs/msg/RadioReception";
  Time stamp;
  std::string from, to;
  std::int32_t channel = 0;
  double rssi = 0;
  std::vector<std::uint8_t> data;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"stamp", "s", "Time of arrival: the last bit, and the delay of the medium."}, s.stamp);
    visit(Field{"from", "", "Name of the robot that sent it."}, s.from);
    visit(Field{"to", "", "Name of the robot or team that it is for; empty: all."}, s.to);
    visit(Field{"channel", "1", "Channel on which it came."}, s.channel);
    visit(Field{"rssi", "dBm", "Received power."}, s.rssi);
    visit(Field{"data", "", "Content, with the bit errors that it suffered."}, s.data);
  }
};

/// All packets received since the sample before.
struct RadioReceptionArray {
  static constexpr const char* ros_type = "sandlot_msgs/msg/RadioReceptionArray";
  Header header;
  std::vector<RadioReception> packets;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"packets", "", "Packets in the order of their arrival."}, s.packets);
  }
};

/// A neighbour whose packet was received: who, how far, in which direction.
struct RangeBearing {
  static constexpr const char* ros_type = "sandlot_msgs/msg/RangeBearing";
  Time stamp;
  std::string from;
  double range = 0, bearing = 0, elevation = 0;
  std::vector<std::uint8_t> data;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"stamp", "s", "Time at which the packet arrived."}, s.stamp);
    visit(Field{"from", "", "Name of the robot that sent it."}, s.from);
    visit(Field{"range", "m", "Measured distance."}, s.range);
    visit(Field{"bearing", "rad", "Measured direction about z, 0 along x of the receiver."}, s.bearing);
    visit(Field{"elevation", "rad", "Measured direction above the receiver's xy plane."}, s.elevation);
    visit(Field{"data", "", "Content of the packet."}, s.data);
  }
};

/// All neighbours heard since the sample before.
struct RangeBearingArray {
  static constexpr const char* ros_type = "sandlot_msgs/msg/RangeBearingArray";
  Header header;
  std::vector<RangeBearing> neighbours;
  static void fields(auto& s, auto&& visit) {
    visit(header_field, s.header);
    visit(Field{"neighbours", "", "Neighbours in the order in which their packets arrived."}, s.neighbours);
  }
};

}  // namespace sandlot::msg
