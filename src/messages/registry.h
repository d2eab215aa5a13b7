#pragma once
/// All message types by name, and messages whose type is known only when the program runs.
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/result.h"
#include "messages/info.h"

namespace sandlot {

/// Every type, in order of name.
std::span<const MessageInfo* const> all_messages();

/// The type of a name, `sensor_msgs/LaserScan` or `sensor_msgs/msg/LaserScan`; the error names the nearest.
Result<const MessageInfo*> find_message(std::string_view name);

/// A type of service: its request and its response.
struct ServiceInfo {
  std::string name;  ///< "sandlot_msgs/srv/Console"
  const MessageInfo *request, *response;
};
/// Every type of service, in order of name. Their messages are among all_messages().
std::span<const ServiceInfo> all_services();
/// The type of a name, `sandlot_msgs/srv/Console` or `sandlot_msgs/Console`; the error names the nearest.
Result<const ServiceInfo*> find_service(std::string_view name);

/// A message of some type.
class AnyMessage {
 public:
  /// With its defaults. The type has a C++ form: it is one of all_messages().
  explicit AnyMessage(const MessageInfo& info);
  const MessageInfo& info() const { return *info_; }
  const void* data() const { return object_.get(); }
  void* data() { return object_.get(); }

  void to_cdr(std::vector<std::byte>& out) const;
  std::string to_json() const;
  void to_cbor(std::vector<std::byte>& out) const;

 private:
  const MessageInfo* info_;
  std::unique_ptr<void, void (*)(void*)> object_;
};

/// A message from its bytes; what they leave out keeps its default (CDR leaves out nothing).
Result<AnyMessage> message_from_cdr(const MessageInfo& info, std::span<const std::byte> bytes);
Result<AnyMessage> message_from_json(const MessageInfo& info, std::string_view text);
Result<AnyMessage> message_from_cbor(const MessageInfo& info, std::span<const std::byte> bytes);

}  // namespace sandlot
