#include "server/clients/mailbox.h"

namespace sandlot::server {

std::size_t Batch::bytes() const {
  std::size_t sum = sizeof *this + messages.size() * sizeof(ChannelMessage);
  for (const ChannelMessage& message : messages) sum += message.bytes->size();
  return frame ? sum + pose_bytes(*frame) : sum;
}

void Mailbox::open(std::function<void()> wake) {
  const std::lock_guard lock(wake_mutex_);
  wake_ = std::move(wake);
}

void Mailbox::close() {
  {
    const std::lock_guard lock(wake_mutex_);
    wake_ = nullptr;
  }
  std::deque<QueuedItem> thrown;  // after the lock: a task's end may put another
  const std::lock_guard lock(mutex_);
  closed_ = true;
  thrown.swap(items_);
}

void Mailbox::push(Batch batch, bool at_once) {
  const std::size_t size = batch.bytes();
  {
    const std::lock_guard lock(mutex_);
    if (closed_) return;
    bytes_ += size;
    items_.push_back({std::move(batch), {}});
    // A frame is let go of here, on the thread that fills it.
    for (; bytes_ > limit_ && thinned_ + 1 < items_.size(); ++thinned_) {
      QueuedItem& oldest = items_[thinned_];
      if (oldest.task) continue;
      bytes_ -= oldest.batch.bytes();
      dropped_ += oldest.batch.messages.size() + (oldest.batch.frame ? 1 : 0);
      oldest.batch.frame = nullptr;
      oldest.batch.messages.clear();
      bytes_ += oldest.batch.bytes();
    }
  }
  wake(at_once);
}

void Mailbox::push(Task task) {
  {
    const std::lock_guard lock(mutex_);
    if (closed_) return;
    items_.push_back({{}, std::move(task)});
  }
  wake(true);
}

/// The transport's timer looks too: waking it at each of ten thousand ticks a second would cost more than they do.
void Mailbox::wake(bool now) {
  constexpr std::chrono::milliseconds pause{4};
  const std::lock_guard lock(wake_mutex_);
  if (!wake_ || woken_) return;
  const auto time = std::chrono::steady_clock::now();
  if (!now && time < last_wake_ + pause) return;
  last_wake_ = time;
  woken_ = true;
  wake_();
}

void Mailbox::take(std::deque<QueuedItem>& out) {
  {
    const std::lock_guard lock(wake_mutex_);
    woken_ = false;
  }
  const std::lock_guard lock(mutex_);
  out.swap(items_);
  bytes_ = 0;
  thinned_ = 0;
}

std::uint64_t Mailbox::dropped() const {
  const std::lock_guard lock(mutex_);
  return dropped_;
}

}  // namespace sandlot::server
