#include "programs/remote/link.h"

#include <algorithm>
#include <utility>

namespace sandlot::programs::remote {

void Link::attach(Client client) {
  const std::lock_guard lock(mutex_);
  if (client.claim <= ended_claim_) return;
  client_ = std::move(client);
  ++attachments_;
  if (step_ && client_->counts) ++client_->counts->steps;
  given_up_ = false;
  answer_.reset();
  told_at_.reset();
  tell();
}

void Link::detach(std::uint64_t claim, std::string why) {
  const std::lock_guard lock(mutex_);
  ended_claim_ = std::max(ended_claim_, claim);
  if (!client_ || client_->claim > claim) return;
  client_.reset();
  if (!step_ || answer_) return;
  answer_ = Error{std::move(why)};
  answered_at_ = Clock::now();
}

void Link::give_up() {
  const std::lock_guard lock(mutex_);
  given_up_ = true;
}

bool Link::given_up() const {
  const std::lock_guard lock(mutex_);
  return given_up_;
}

Status Link::answer(std::uint64_t step, std::string text) {
  const std::lock_guard lock(mutex_);
  if (text.size() > most_answer) return Error{"an answer has at most 1 MiB"};
  if (!step_ || !told_at_ || answer_)
    return Error{"step " + std::to_string(step) + " does not wait for an answer"};
  if (step != step_->number)
    return Error{"step " + std::to_string(step_->number) + " waits for an answer, not " +
                 std::to_string(step)};
  answer_ = std::move(text);
  answered_at_ = Clock::now();
  return {};
}

void Link::release() {
  const std::lock_guard lock(mutex_);
  tell();
}

/// @pre the mutex is held
void Link::tell() {
  if (!step_ || !client_ || told_at_) return;
  told_at_ = Clock::now();
  client_->step(*step_);
}

std::optional<double> Link::deadline_s() const {
  const std::lock_guard lock(mutex_);
  return client_ ? std::optional(client_->deadline_s) : std::nullopt;
}

std::uint64_t Link::attachments() const {
  const std::lock_guard lock(mutex_);
  return attachments_;
}

void Link::put(const Step& step) {
  const std::lock_guard lock(mutex_);
  step_ = step;
  told_at_.reset();
  answer_.reset();
}

std::optional<Link::Clock::time_point> Link::told_at() const {
  const std::lock_guard lock(mutex_);
  return told_at_;
}

void Link::count_step() {
  const std::lock_guard lock(mutex_);
  ++counts_.steps;
  if (client_ && client_->counts) ++client_->counts->steps;
}

void Link::count_miss() {
  const std::lock_guard lock(mutex_);
  ++counts_.misses;
  if (client_ && client_->counts) ++client_->counts->misses;
}

void Link::count_answer() {
  const std::lock_guard lock(mutex_);
  ++counts_.answers;
  if (client_ && client_->counts) ++client_->counts->answers;
}

void Link::refuse(const std::string& why) {
  const std::lock_guard lock(mutex_);
  if (client_) client_->refused(why);
}

std::optional<Result<std::string>> Link::take(Clock::time_point latest) {
  const std::lock_guard lock(mutex_);
  if (!answer_ || answered_at_ > latest) return std::nullopt;
  step_.reset();
  return std::exchange(answer_, std::nullopt);
}

}  // namespace sandlot::programs::remote
