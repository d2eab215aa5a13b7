#pragma once
/// A call of a service that waits for its answer. A call that is destroyed without one fails with "the run is over": so
/// each call is answered exactly once, whatever becomes of the run or of the client.
///
/// Threads   any.
#include <atomic>
#include <functional>
#include <string_view>
#include <vector>

#include "messages/registry.h"

namespace sandlot::server {

class ServiceCall {
 public:
  /// CDR of the response, or why there is none.
  using Outcome = Result<std::vector<std::byte>>;
  /// @param send  encodes the outcome and brings it to the client; called once, on the thread that answers
  explicit ServiceCall(std::function<void(Outcome)> send) : send_(std::move(send)) {}
  ~ServiceCall() { fail("the run is over"); }
  ServiceCall(const ServiceCall&) = delete;
  ServiceCall& operator=(const ServiceCall&) = delete;

  template <class M>
  void answer(const M& response) {
    answer(message_info<M>(), &response);
  }
  void answer(const MessageInfo& info, const void* response);
  /// @param cdr  the response
  void answer(std::vector<std::byte> cdr);
  void fail(std::string_view why);

 private:
  const std::function<void(Outcome)> send_;
  std::atomic<bool> answered_ = false;
};

}  // namespace sandlot::server
