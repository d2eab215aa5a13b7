#pragma once
/// Link between a remote program, on the simulation's thread, and those who bring its client's messages: the server.
///
/// A client is attached with a deadline and functions that tell it of steps. In each control step the program puts the
/// step into the link; when the messages of the tick are on their way to the client, release() tells the client. The
/// client answers with the number of the step.
///
/// Threads   any; clients are told on the thread that calls release() or attach().
/// Waiting   who answers wakes the session: Session::wake().
/// Limits    one answer waits at most; an answer has at most most_answer bytes.
#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

#include "base/result.h"
#include "base/time.h"

namespace sandlot::programs::remote {

class Link {
 public:
  static constexpr std::size_t most_answer = std::size_t{1} << 20;
  using Clock = std::chrono::steady_clock;

  struct Step {
    std::uint64_t number = 0;
    Time now;
    std::uint64_t random = 0;  ///< of the program's own, one per step
  };
  /// Steps that a client was to answer, those of them without an answer in time, and answers, late ones too. Read on any thread.
  struct Counts {
    std::atomic<std::uint64_t> steps = 0, misses = 0, answers = 0;
  };

  // --- for the server ---
  /// What a client is told; on the thread of the simulation.
  struct Client {
    double deadline_s = 0;
    std::function<void(const Step&)> step;
    std::function<void(const std::string& why)> refused;  ///< its answer could not be carried out
    std::shared_ptr<Counts> counts = {};                  ///< of this client; null: nobody wants them
    std::uint64_t claim = 0;                              ///< grows from claim to claim
  };
  /// A client takes the program over. It is told at once of a step that waits. One whose claim has ended meanwhile is passed over.
  void attach(Client client);
  /// The claim and those before it have ended, on any thread, even before their client was attached.
  void detach(std::uint64_t claim, std::string why);
  /// Nobody comes any more, such as a process that has ended for good: nobody is waited for. An attachment takes it back.
  void give_up();
  /// Errors: no step waits for an answer, another one does, it is too long.
  Status answer(std::uint64_t step, std::string text);
  /// The messages of the tick are on their way: the client may be told of the step.
  void release();

  // --- for the program ---
  /// That of the client attached now.
  std::optional<double> deadline_s() const;
  /// Nobody is attached, and nobody will be.
  bool given_up() const;
  /// Counts the clients that came.
  std::uint64_t attachments() const;
  /// Of all steps, whether or not somebody was attached.
  const Counts& counts() const { return counts_; }
  void put(const Step& step);
  /// When the client was sent the step that waits; nothing: it was not.
  std::optional<Clock::time_point> told_at() const;
  /// A control step begins; its answer did not come in time; an answer came.
  void count_step();
  void count_miss();
  void count_answer();
  void refuse(const std::string& why);
  /// The answer, if it came until `latest`, whenever it is taken. An error: the client has gone without one.
  std::optional<Result<std::string>> take(Clock::time_point latest = Clock::time_point::max());

 private:
  void tell();

  mutable std::mutex mutex_;
  std::optional<Client> client_;
  std::uint64_t attachments_ = 0, ended_claim_ = 0;
  std::optional<Step> step_;  ///< that waits for its answer
  std::optional<Clock::time_point> told_at_;
  bool given_up_ = false;
  Counts counts_;
  std::optional<Result<std::string>> answer_;
  Clock::time_point answered_at_;
};

}  // namespace sandlot::programs::remote
