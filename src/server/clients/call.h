#pragma once
/// A call of a service that waits for its answer. Whoever lets go of it without one says that there will be none: so each
/// call is answered exactly once, whatever becomes of the run or of the client.
///
/// Threads   any.
#include <atomic>
#include <string>

#include "messages/registry.h"
#include "server/clients/mailbox.h"

namespace sandlot::server {

class Call {
 public:
  Call(std::shared_ptr<Mailbox> mailbox, ClientId client, std::uint32_t service, std::uint32_t id,
       std::string encoding)
      : mailbox_(std::move(mailbox)),
        client_(client),
        service_(service),
        id_(id),
        encoding_(std::move(encoding)) {}
  ~Call() { fail("the run is over"); }
  Call(const Call&) = delete;
  Call& operator=(const Call&) = delete;

  template <class M>
  void answer(const M& response) {
    answer(message_info<M>(), &response);
  }
  void answer(const MessageInfo& info, const void* response);
  void fail(std::string_view why);

 private:
  void send(Payload bytes, bool text);
  const std::shared_ptr<Mailbox> mailbox_;
  const ClientId client_;
  const std::uint32_t service_, id_;
  const std::string encoding_;
  std::atomic<bool> answered_ = false;
};

}  // namespace sandlot::server
