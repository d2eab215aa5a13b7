#pragma once
/// Inbox: what a medium has delivered to a device and the device has not read yet.
///
/// A device asks for one while it is built (DeviceBuild::receive) and empties it when it senses; so rates, failures, errors and
/// levels work on a receiver as on any sensor. The inbox is State of the device.
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/bytes.h"
#include "base/time.h"
#include "geometry/vec3.h"

namespace sandlot {

struct Delivery {
  Time at;                    ///< when it arrived
  std::uint64_t emitter = 0;  ///< key of the device that sent it
  std::int32_t channel = 0;
  double strength = 0;  ///< as received, in the medium's unit
  Vec3 direction_W;     ///< unit, from the receiver towards where it came from; zero: none
  std::vector<std::uint8_t> payload;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"at", "s", "Time of arrival."}, s.at);
    visit(Field{"emitter", "", "Key of the device that sent it."}, s.emitter);
    visit(Field{"channel", "1", "Channel."}, s.channel);
    visit(Field{"strength", "", "Strength as received, in the unit of the medium."}, s.strength);
    visit(Field{"direction", "1", "Direction towards where it came from, in the world."}, s.direction_W);
    visit(Field{"payload", "", "Content."}, s.payload);
  }
};

class Inbox {
 public:
  /// @param medium  index in the world's list
  Inbox(std::uint32_t medium, std::size_t limit) : medium_(medium), limit_(limit) {}
  std::uint32_t medium() const { return medium_; }
  /// Restricts what media deliver to one channel. No State: the device tunes again in every actuate phase.
  void tune(std::int32_t channel) { channel_ = channel; }
  /// Empty: all.
  std::optional<std::int32_t> channel() const { return channel_; }

  /// For media: room for one more, to be filled whole; it still holds what once was there, for its memory. Null: the inbox is
  /// full, and what comes is lost.
  Delivery* add() {
    ++arrived_;
    if (used_ >= limit_) return ++lost_, nullptr;
    if (used_ == items_.size()) items_.emplace_back();
    return &items_[used_++];
  }
  void put(Delivery delivery) {
    if (Delivery* const to = add()) *to = std::move(delivery);
  }
  /// For the device, in its sense phase: what has come since the last clear(), in order of arrival.
  std::span<const Delivery> items() const { return {items_.data(), used_}; }
  void clear() { used_ = 0; }

  std::uint64_t arrived() const { return arrived_; }  ///< so far, lost ones included
  std::uint64_t lost() const { return lost_; }        ///< because it was full

  void save(ByteWriter& w) const {
    write(w, static_cast<std::uint32_t>(used_));
    for (const Delivery& each : items()) write(w, each);
    write(w, arrived_);
    write(w, lost_);
  }
  void load(ByteReader& r) {
    read(r, items_);
    read(r, arrived_);
    read(r, lost_);
    used_ = items_.size();
    if (used_ > limit_) r.fail();
  }

 private:
  std::uint32_t medium_;
  std::size_t limit_;
  std::vector<Delivery> items_;  ///< the first `used_` of them
  std::size_t used_ = 0;
  std::uint64_t arrived_ = 0, lost_ = 0;
  std::optional<std::int32_t> channel_;  ///< empty: all
};

}  // namespace sandlot
