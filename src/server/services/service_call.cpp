#include "server/services/service_call.h"

#include "messages/cdr.h"

namespace sandlot::server {

void ServiceCall::answer(const MessageInfo& info, const void* response) {
  std::vector<std::byte> cdr;
  write_cdr(info, response, cdr);
  answer(std::move(cdr));
}

void ServiceCall::answer(std::vector<std::byte> cdr) {
  if (!answered_.exchange(true)) send_(std::move(cdr));
}

void ServiceCall::fail(std::string_view why) {
  if (!answered_.exchange(true)) send_(Error{std::string(why)});
}

}  // namespace sandlot::server
