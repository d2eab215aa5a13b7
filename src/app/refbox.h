#pragma once
/// Referee box of a run for the command line: prints its address and sums up what base stations did.
#include <memory>

#include "app/commands.h"
#include "run/summary.h"

namespace sandlot {
class Session;
namespace server {
class Refbox;
}
}  // namespace sandlot

namespace sandlot::app {

/// "28097", "0.0.0.0:28097", "[::1]:28097". Errors: neither a port nor an address with one.
struct RefboxPlace {
  std::string address;
  std::uint16_t port = 0;
};
Result<RefboxPlace> read_refbox_place(const std::string& text);

class ServedRefbox {
 public:
  /// Starts the box and prints its address, one line on standard error.
  /// Errors   flags that are wrong; the address cannot be bound.
  static Result<ServedRefbox> start(const RefboxFlags& flags, Session& session);
  ServedRefbox(ServedRefbox&&) noexcept;
  ServedRefbox& operator=(ServedRefbox&&) noexcept;
  ~ServedRefbox();
  /// Closes all connections.
  RefboxSummary stop();

 private:
  explicit ServedRefbox(std::unique_ptr<server::Refbox> refbox);
  std::unique_ptr<server::Refbox> refbox_;
};

}  // namespace sandlot::app
