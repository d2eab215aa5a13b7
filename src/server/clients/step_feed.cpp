#include "server/clients/step_feed.h"

namespace sandlot::server {
namespace {

constexpr double period_s = 0.02;
constexpr std::size_t most_steps = 10'000;  ///< in a message

}  // namespace

void StepFeed::send_to(std::uint32_t channel) {
  if (channel_ == 0 && channel != 0) session_.add_step_observer(this);
  if (channel_ != 0 && channel == 0) session_.remove_step_observer(this);
  channel_ = channel;
  if (channel == 0) {
    message_ = {};
    passed_ = {};
  }
}

void StepFeed::on_step(const StepTime& step) {
  const bool first = message_.compute_s.empty();
  // No interval amid a message can only be after a stretch that has ended, and its end was sent.
  if (!step.wall_s) message_.restarted = first;
  else message_.wall_s.push_back(*step.wall_s);
  message_.compute_s.push_back(step.compute_s);
  message_.stamp = step.now;
  passed_ = passed_ + step.step;
  // Whichever is nearer to the period: now, or after a tick like this one.
  const double since_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - sent_).count();
  const double next_s = step.wall_s.value_or(period_s);
  if (since_s >= period_s - next_s / 2 || message_.compute_s.size() >= most_steps) send();
}

void StepFeed::send() {
  if (message_.compute_s.empty()) return;
  sent_ = std::chrono::steady_clock::now();
  message_.step_s = passed_.s() / static_cast<double>(message_.compute_s.size());
  auto bytes = std::make_shared<std::vector<std::byte>>();
  write_cdr(message_info<msg::StepTimes>(), &message_, *bytes);
  Batch batch;
  batch.now = message_.stamp;
  batch.epoch = session_.epoch();
  batch.messages.push_back({channel_, message_.stamp, std::move(bytes)});
  mailbox_->push(std::move(batch), true);
  message_.restarted = false;
  message_.wall_s.clear();
  message_.compute_s.clear();
  passed_ = {};
}

}  // namespace sandlot::server
