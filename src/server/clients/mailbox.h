#pragma once
/// Queue from the simulation's thread to the transport's: batches of messages, and tasks.
///
/// Batches   one per tick with something to send. They wait in a queue of `limit_bytes`; when it is full the oldest ones lose
///           what viewers can do without (frames, messages), which is counted. Commands from outside stay.
/// Tasks     calls of the Hub, in order with the batches; their number is bounded by those who push them.
/// Frames    are given back to the simulation's thread (sim/world/frame_returns.h).
/// Threads   push() and release() as noted; take(), give_back() and close() belong to the transport's.
/// Cost      a lock per batch that is never held while something is encoded or sent.
#include <chrono>
#include <deque>
#include <functional>
#include <memory>
#include <mutex>
#include <vector>

#include "server/http/transport.h"
#include "sim/world/frame_returns.h"

namespace sandlot::server {

class Hub;

/// A message for the subscribers of a channel.
struct ChannelMessage {
  std::uint32_t channel = 0;
  Time stamp;
  Payload bytes;
};

struct Batch {
  Time now;
  std::uint64_t epoch = 1;
  std::shared_ptr<const Frame> frame;  ///< with poses; null: none is due
  bool contacts = false;               ///< the frame has them
  std::vector<ChannelMessage> messages;
  Payload commands;  ///< JSON of the commands from outside
  std::size_t bytes() const;
};

using Task = std::function<void(Hub&)>;

struct QueuedItem {
  Batch batch;
  Task task;  ///< empty: it is a batch
};

class Mailbox {
 public:
  explicit Mailbox(std::size_t limit_bytes = 32u << 20) : limit_(limit_bytes) {}
  /// @param wake  brings the transport's thread to take(); called with a lock of its own, also by other threads
  void open(std::function<void()> wake);
  /// No wake() comes after it, and tasks are thrown away.
  void close();

  /// Simulation's thread.
  /// @param at_once  the transport's thread looks now, however recently it has
  void push(Batch batch, bool at_once = false);
  /// Any thread.
  void push(Task task);
  /// Simulation's thread: lets go of the frames that were given back.
  void release() { returns_.release(); }

  void take(std::deque<QueuedItem>& out);
  void give_back(std::shared_ptr<const Frame> frame) { returns_.give_back(std::move(frame)); }

  std::uint64_t dropped() const;

 private:
  void wake(bool now);
  const std::size_t limit_;
  mutable std::mutex mutex_;
  std::deque<QueuedItem> items_;
  std::size_t bytes_ = 0;
  std::size_t thinned_ = 0;  ///< so many at the front have nothing left to lose
  std::uint64_t dropped_ = 0;
  FrameReturns returns_;
  bool closed_ = false;

  std::mutex wake_mutex_;
  std::function<void()> wake_;
  bool woken_ = false;
  std::chrono::steady_clock::time_point last_wake_;
};

}  // namespace sandlot::server
