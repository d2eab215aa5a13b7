#pragma once
/// Inbox: what a medium has delivered to a device and the device has not read yet.
///
/// A device asks for one while it is built (DeviceBuild::receive) and empties it when it senses; so rates, failures, errors and
/// levels work on a receiver as on any sensor. The inbox is State of the device.
///
/// Cost   put: a copy of the payload. lend: none; whoever receives the same packet reads the same bytes, which stay with the
///        medium. No heap after warm-up.
#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "base/bytes.h"
#include "base/prefetch.h"
#include "base/time.h"
#include "geometry/vec3.h"

namespace sandlot {

/// What is known of a delivery in addition to its content.
struct DeliveryHead {
  Time at;                    ///< when it arrived
  std::uint64_t emitter = 0;  ///< key of the device that sent it
  std::int32_t channel = 0;
  double strength = 0;  ///< as received, in the medium's unit
  Vec3 direction_W;     ///< unit, from the receiver towards where it came from; zero: none

  static void fields(auto& s, auto&& visit) {
    visit(Field{"at", "s", "Time of arrival."}, s.at);
    visit(Field{"emitter", "", "Key of the device that sent it."}, s.emitter);
    visit(Field{"channel", "1", "Channel."}, s.channel);
    visit(Field{"strength", "", "Strength as received, in the unit of the medium."}, s.strength);
    visit(Field{"direction", "1", "Direction towards where it came from, in the world."}, s.direction_W);
  }
};

/// A delivery with its content.
struct Delivery : DeliveryHead {
  std::vector<std::uint8_t> payload;

  static void fields(auto& s, auto&& visit) {
    DeliveryHead::fields(s, visit);
    visit(Field{"payload", "", "Content."}, s.payload);
  }
};

/// A delivery as it lies in an inbox.
struct Received {
  DeliveryHead head;
  const std::uint8_t* data = nullptr;
  std::uint32_t size = 0;
  bool lent = false;  ///< the bytes are the medium's

  std::span<const std::uint8_t> payload() const { return {data, size}; }
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

  /// For media. @return the copy of the payload, which the medium may still damage; empty: the inbox is full, and what comes is lost
  std::span<std::uint8_t> put(const DeliveryHead& head, std::span<const std::uint8_t> payload) {
    Received* const to = add(head);
    return to ? copy(payload, *to) : std::span<std::uint8_t>();
  }
  void put(const Delivery& delivery) { put(delivery, delivery.payload); }
  /// For media and the device, soon before either of them.
  void expect(std::size_t count) const { prefetch(items_.data(), std::min(count, items_.size())); }
  /// The same without a copy. @pre the bytes stay as they are until the medium has called keep()
  void lend(const DeliveryHead& head, std::span<const std::uint8_t> payload) {
    Received* const to = add(head);
    if (!to) return;
    to->data = payload.data();
    to->size = static_cast<std::uint32_t>(payload.size());
    to->lent = true;
    any_lent_ = true;
  }
  /// Copies what was lent and has not been read yet.
  void keep() {
    if (!any_lent_) return;
    for (Received& each : std::span(items_).first(used_))
      if (each.lent) copy(each.payload(), each);
    any_lent_ = false;
  }

  /// For the device, in its sense phase: what has come since the last clear(), in order of arrival.
  std::span<const Received> items() const { return {items_.data(), used_}; }
  void clear() {
    used_ = copies_used_ = 0;
    any_lent_ = false;
  }

  std::uint64_t arrived() const { return arrived_; }  ///< so far, lost ones included
  std::uint64_t lost() const { return lost_; }        ///< because it was full

  void save(ByteWriter& w) const {
    write(w, static_cast<std::uint32_t>(used_));
    for (const Received& each : items()) {
      write(w, each.head);
      write(w, each.size);
      w.raw(each.data, each.size);
    }
    write(w, arrived_);
    write(w, lost_);
  }
  void load(ByteReader& r) {
    clear();
    std::uint32_t count = 0;
    read(r, count);
    if (count > limit_) return r.fail();
    Delivery delivery;
    for (std::uint32_t i = 0; i < count && r.ok(); ++i) {
      read(r, delivery);
      if (r.ok()) put(delivery);
    }
    read(r, arrived_);
    read(r, lost_);
  }

 private:
  Received* add(const DeliveryHead& head) {
    ++arrived_;
    if (used_ >= limit_) return ++lost_, nullptr;
    if (used_ == items_.size()) items_.emplace_back();
    Received& to = items_[used_++];
    to.head = head;
    return &to;
  }
  std::span<std::uint8_t> copy(std::span<const std::uint8_t> payload, Received& to) {
    if (copies_used_ == copies_.size()) copies_.emplace_back();
    std::vector<std::uint8_t>& bytes = copies_[copies_used_++];
    bytes.assign(payload.begin(), payload.end());
    to.data = bytes.data();
    to.size = static_cast<std::uint32_t>(bytes.size());
    to.lent = false;
    return bytes;
  }

  std::uint32_t medium_;
  std::size_t limit_;
  std::vector<Received> items_;                    ///< the first `used_` of them
  std::vector<std::vector<std::uint8_t>> copies_;  ///< payloads; the first `copies_used_` of them
  std::size_t used_ = 0, copies_used_ = 0;
  bool any_lent_ = false;
  std::uint64_t arrived_ = 0, lost_ = 0;
  std::optional<std::int32_t> channel_;  ///< empty: all
};

}  // namespace sandlot
