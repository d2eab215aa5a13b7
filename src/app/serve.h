#pragma once
/// A run's page, from the command line's point of view: where it is, and who was there.
#include <cstdint>
#include <memory>
#include <nlohmann/json.hpp>

#include "app/commands.h"
#include "server/server.h"

namespace sandlot::app {

class Served {
 public:
  /// Starts the server and prints where the page is, one line on standard error.
  /// Errors   the address cannot be bound; an origin that is none.
  /// @param recording  see ServerOptions; unset: nothing is recorded
  static Result<Served> start(
      const ServeOptions& options, Session& session, Console& console,
      std::function<std::optional<server::ServerOptions::Recording>()> recording = {});
  /// Now and then, so that it knows how many there are.
  void look();
  /// Says good-bye to all viewers. @return what the summary tells of them
  nlohmann::ordered_json stop();

 private:
  std::unique_ptr<server::Server> server_;
  std::uint64_t most_ = 0;
};

}  // namespace sandlot::app
