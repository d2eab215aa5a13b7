#include "messages/registry.h"

#include <algorithm>

#include "base/text.h"
#include "messages/cbor.h"
#include "messages/cdr.h"
#include "messages/diagnostic_msgs.h"
#include "messages/json.h"
#include "messages/line_segments.h"
#include "messages/make_info.h"
#include "messages/messages.h"
#include "messages/rcl_interfaces.h"
#include "messages/services.h"
#include "messages/simulation_interfaces.h"
#include "messages/tf2_msgs.h"
#include "messages/visualization_msgs.h"

namespace sandlot {

#define SL_MESSAGE(type) template const MessageInfo& message_info<type>();
#include "messages/types.def"
#undef SL_MESSAGE
#define SL_SERVICE(type, ...)                                \
  template const MessageInfo& message_info<type::Request>(); \
  template const MessageInfo& message_info<type::Response>();
#define SL_SERVICE_TYPE(type) SL_SERVICE(type, )
#include "messages/services.def"
#undef SL_SERVICE

namespace {

std::vector<const MessageInfo*> make_list() {
  std::vector<const MessageInfo*> list{&message_info<Time>(), &message_info<msg::Duration>(),
                                       &message_info<Vec3>(), &message_info<msg::Point>(),
                                       &message_info<Quat>(), &message_info<Pose>()};
#define SL_MESSAGE(type) list.push_back(&message_info<type>());
#include "messages/types.def"
#undef SL_MESSAGE
  for (const ServiceInfo& service : all_services())
    list.insert(list.end(), {service.request, service.response});
  std::sort(list.begin(), list.end(), [](const auto* a, const auto* b) { return a->name < b->name; });
  return list;
}

std::vector<ServiceInfo> make_services() {
  std::vector<ServiceInfo> list;
#define SL_SERVICE(type, ...) \
  list.push_back({type::ros_type, &message_info<type::Request>(), &message_info<type::Response>()});
#define SL_SERVICE_TYPE(type) SL_SERVICE(type, )
#include "messages/services.def"
#undef SL_SERVICE
  std::sort(list.begin(), list.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  return list;
}

}  // namespace

std::span<const MessageInfo* const> all_messages() {
  static const std::vector<const MessageInfo*> list = make_list();
  return list;
}

Result<const MessageInfo*> find_message(std::string_view name) {
  const std::string full = long_name(name);
  const auto all = all_messages();
  const auto found = std::lower_bound(all.begin(), all.end(), full,
                                      [](const auto* info, const std::string& n) { return info->name < n; });
  if (found != all.end() && (*found)->name == full) return *found;
  std::vector<std::string> known;
  for (const MessageInfo* info : all) known.push_back(short_name(info->name));
  const std::string near = nearest(short_name(name), known);
  return Error{"there is no message type '" + std::string(name) + "'",
               near.empty() ? "" : "did you mean '" + near + "'?"};
}

std::span<const ServiceInfo> all_services() {
  static const std::vector<ServiceInfo> list = make_services();
  return list;
}

Result<const ServiceInfo*> find_service(std::string_view name) {
  std::string full(name);
  const auto slash = full.find('/');
  if (slash != std::string::npos && full.find('/', slash + 1) == std::string::npos)
    full.insert(slash, "/srv");
  std::vector<std::string> known;
  for (const ServiceInfo& service : all_services()) {
    if (service.name == full) return &service;
    known.push_back(service.name);
  }
  const std::string near = nearest(full, known);
  return Error{"there is no service type '" + std::string(name) + "'",
               near.empty() ? "" : "did you mean '" + near + "'?"};
}

AnyMessage::AnyMessage(const MessageInfo& info) : info_(&info), object_(nullptr, info.destroy) {
  SL_CHECK_MSG(info.create, "a type from a schema has no C++ form");
  object_.reset(info.create());
}
void AnyMessage::to_cdr(std::vector<std::byte>& out) const { write_cdr(*info_, data(), out); }
std::string AnyMessage::to_json() const {
  std::vector<std::byte> cdr;
  to_cdr(cdr);
  std::string text;
  const Status done = cdr_to_json(*info_, cdr, text);
  SL_CHECK(done);
  return text;
}
void AnyMessage::to_cbor(std::vector<std::byte>& out) const {
  std::vector<std::byte> cdr;
  to_cdr(cdr);
  const Status done = cdr_to_cbor(*info_, cdr, out);
  SL_CHECK(done);
}

Result<AnyMessage> message_from_cdr(const MessageInfo& info, std::span<const std::byte> bytes) {
  AnyMessage message(info);
  SL_TRY(read_cdr(info, bytes, message.data()));
  return message;
}
Result<AnyMessage> message_from_json(const MessageInfo& info, std::string_view text) {
  AnyMessage message(info);
  SL_TRY(read_json(info, text, message.data()));
  return message;
}
Result<AnyMessage> message_from_cbor(const MessageInfo& info, std::span<const std::byte> bytes) {
  AnyMessage message(info);
  SL_TRY(read_cbor(info, bytes, message.data()));
  return message;
}

}  // namespace sandlot
