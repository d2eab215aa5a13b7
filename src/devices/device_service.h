#pragma once
/// Service of a kind of device: a call that a device answers once, at the beginning of a tick, such as "set your odometry to
/// zero". A kind lists its services; each is a row and a member function of the device:
///
///   struct Odometer { Result<Trigger::Response> reset(const Trigger::Request&, const Context&); ... };
///   constexpr DeviceService services[] = {
///       device_service<Odometer, Trigger, &Odometer::reset>("reset", "Sets the pose of the odometry to zero.")};
///
/// A call is a request like any other (elements/request.h): sorted, logged and replayed; its outcome carries the response. It is
/// offered by the server as /robot/device/NAME, in the console by `call`, in C++ by sandlot/embed.h. The function may change
/// the device's State and nothing else.
#include <cstddef>
#include <span>
#include <vector>

#include "base/result.h"
#include "messages/cdr.h"
#include "messages/info.h"

namespace sandlot {

struct Context;

struct DeviceService {
  const char* name;  ///< "reset"
  const char* help;  ///< one sentence
  const char* type;  ///< "std_srvs/srv/Trigger", a row of messages/services.def
  const MessageInfo& (*request)();
  const MessageInfo& (*response)();
  /// Reads the request and fills the response, both in CDR. @param device  of the kind
  Status (*call)(void* device, std::span<const std::byte> request, std::vector<std::byte>& response,
                 const Context& context);
};

template <class Device, class S, auto function>
constexpr DeviceService device_service(const char* name, const char* help) {
  return {name,
          help,
          S::ros_type,
          []() -> const MessageInfo& { return message_info<typename S::Request>(); },
          []() -> const MessageInfo& { return message_info<typename S::Response>(); },
          [](void* device, std::span<const std::byte> request, std::vector<std::byte>& response,
             const Context& context) -> Status {
            typename S::Request asked{};
            SL_TRY(read_cdr(message_info<typename S::Request>(), request, &asked));
            SL_ASSIGN(const typename S::Response answer,
                      (static_cast<Device*>(device)->*function)(asked, context));
            response.clear();
            write_cdr(message_info<typename S::Response>(), &answer, response);
            return {};
          }};
}

}  // namespace sandlot
