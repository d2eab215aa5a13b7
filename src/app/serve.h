#pragma once
/// Page of a run for the command line: prints its address and counts viewers.
#include <cstdint>
#include <memory>
#include <optional>

#include "app/commands.h"
#include "run/summary.h"
#include "server/processes.h"

namespace sandlot {
class Console;
class RunOutputs;
class Session;
namespace server {
class Server;
}
}  // namespace sandlot

namespace sandlot::app {

class Served {
 public:
  /// Starts the server and prints the address of the page, one line on standard error.
  /// @param options  unset: there is no page, only the ports of the programs that are started
  /// @param outputs  of the run, for what the page shows about its recording; null: nothing is recorded
  /// Errors   the address cannot be bound; an origin that is not one.
  static Result<Served> start(const std::optional<ServeOptions>& options, Session& session, Console& console,
                              RunOutputs* outputs = nullptr, const server::ProgramOptions& programs = {});
  Served(Served&&) noexcept;
  Served& operator=(Served&&) noexcept;
  ~Served();

  /// Call now and then, for the largest number of viewers at one time.
  void count_viewers();
  /// Closes all connections.
  ServerSummary stop();
  /// Clients that have driven something.
  std::vector<ClientSummary> clients() const;

 private:
  explicit Served(std::unique_ptr<server::Server> server);
  std::unique_ptr<server::Server> server_;
  std::uint64_t most_ = 0;
};

}  // namespace sandlot::app
