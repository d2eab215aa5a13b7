#pragma once
/// Step times for the clients that have subscribed to them: a message about every 20 ms of wall time, of one tick where ticks are slower.
///
/// Threads   the simulation's.
/// Cost      without a subscriber the session measures nothing.
#include <chrono>
#include <cstdint>
#include <memory>

#include "messages/sandlot_time.h"
#include "server/clients/mailbox.h"
#include "sim/session/session.h"

namespace sandlot::server {

class StepFeed final : public StepObserver {
 public:
  StepFeed(Session& session, std::shared_ptr<Mailbox> mailbox)
      : session_(session), mailbox_(std::move(mailbox)) {}
  /// @param channel  that the messages go to; 0: nobody has subscribed
  void send_to(std::uint32_t channel);
  void on_step(const StepTime& step) override;
  void on_stretch_end() override { send(); }

 private:
  void send();

  Session& session_;
  const std::shared_ptr<Mailbox> mailbox_;
  std::uint32_t channel_ = 0;
  msg::StepTimes message_;  ///< that is being gathered
  Time passed_;             ///< simulated time of its ticks
  std::chrono::steady_clock::time_point sent_;
};

}  // namespace sandlot::server
