#pragma once
/// Command queue: a command slot that keeps several orders, for devices whose orders do not replace each other: what is
/// said, sent or printed. In an ordinary slot the last order counts.
///
/// Order    first in, first out. `message`, `stamp` and `count` are those of the latest order taken.
/// Errors   a full queue refuses an order, and the old ones stay.
/// State    the orders that wait. A snapshot with more of them than the limit is refused.
/// Cost     room for `limit` messages from the start; nothing per tick while it is empty.
#include <utility>
#include <vector>

#include "base/check.h"
#include "messages/topic.h"

namespace sandlot {

inline constexpr std::size_t most_queued_orders = 10'000;  ///< limit of a queue's limit

template <class M>
class CommandQueue final : public Topic<M> {
 public:
  /// @pre 0 < limit <= most_queued_orders
  CommandQueue(std::string name, std::size_t limit) : Topic<M>(std::move(name)), ring_(limit) {
    SL_CHECK(limit > 0 && limit <= most_queued_orders);
  }
  bool empty() const { return size_ == 0; }
  /// The oldest order. @pre not empty
  const M& front() const {
    SL_CHECK(size_ > 0);
    return ring_[first_];
  }
  /// Removes the oldest order. @pre not empty
  void pop() {
    SL_CHECK(size_ > 0);
    // An empty one begins at the front again: only as many places hold long messages as have waited at once.
    first_ = --size_ == 0 ? 0 : (first_ + 1) % ring_.size();
  }
  void clear() { first_ = size_ = 0; }

  std::size_t waiting() const override { return size_; }
  std::size_t queue_limit() const override { return ring_.size(); }
  Status assign(std::span<const std::byte> bytes) override {
    if (size_ == ring_.size())
      return Error{"the queue of '" + this->name() + "' is full",
                   "at most " + std::to_string(size_) + " orders wait"};
    SL_TRY(Topic<M>::assign(bytes));
    ring_[(first_ + size_) % ring_.size()] = this->message;
    ++size_;
    return {};
  }
  void save(ByteWriter& w) const override {
    Topic<M>::save(w);
    write(w, static_cast<std::uint32_t>(size_));
    for (std::size_t i = 0; i < size_; ++i) write(w, ring_[(first_ + i) % ring_.size()]);
  }
  void load(ByteReader& r) override {
    Topic<M>::load(r);
    std::uint32_t size = 0;
    read(r, size);
    if (size > ring_.size()) return r.fail();
    clear();
    for (std::uint32_t i = 0; i < size && r.ok(); ++i) {
      read(r, ring_[i]);
      if (!r.ok() || !check_command(message_info<M>(), &ring_[i])) return r.fail();
      ++size_;
    }
  }
  std::unique_ptr<TopicBase> clone() const override { return std::make_unique<CommandQueue>(*this); }
  void copy_from(const TopicBase& other) override {
    Topic<M>::copy_from(other);
    const auto& from = static_cast<const CommandQueue&>(other);
    ring_ = from.ring_;
    first_ = from.first_;
    size_ = from.size_;
  }
  std::size_t memory_bytes() const override {
    std::size_t sum = Topic<M>::memory_bytes() + ring_.size() * sizeof(M);
    for (const M& each : ring_) sum += heap_bytes(each);
    return sum;
  }

 private:
  std::vector<M> ring_;
  std::size_t first_ = 0, size_ = 0;
};

}  // namespace sandlot
