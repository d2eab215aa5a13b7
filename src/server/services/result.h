#pragma once
/// Answers of those services of simulation_interfaces whose response is a result and nothing else.
#include <string>

#include "server/services/service.h"

namespace sandlot::server {

using SimResult = msg::simulation::Result;

inline SimResult make_result(std::uint8_t code, std::string why = "") {
  SimResult out;
  out.result = code;
  out.error_message = std::move(why);
  return out;
}

template <class S>
void reply_result(const Reply<S>& reply, std::uint8_t code, std::string why = "") {
  typename S::Response response;
  response.result = make_result(code, std::move(why));
  reply(response);
}

template <class S>
void reply_status(const Reply<S>& reply, const Status& status) {
  if (status) reply_result(reply, SimResult::ok);
  else reply_result(reply, SimResult::operation_failed, status.error().text());
}

}  // namespace sandlot::server
