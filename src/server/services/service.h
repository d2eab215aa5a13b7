#pragma once
/// Services: the table of them, and the part of the server that their functions may use. Nothing here knows a protocol: the
/// code that speaks one (server/clients/) decodes a request, finds its row, checks the right and sends the outcome.
///
/// A service is a pair of messages (messages/services.h), a row of messages/services.def and a function in a source of this
/// folder: docs/adding_a_service.md.
///
/// Threads   functions are called on the transport's thread. They reach the run through Session's own functions, or by
///           post(); a reply may be given on any thread, at once or later.
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "messages/registry.h"
#include "messages/services.h"
#include "server/http/transport.h"
#include "server/services/service_call.h"
#include "sim/session/session.h"

namespace sandlot {
class Console;
}

namespace sandlot::server {

/// The least that a client must be allowed to do.
enum class Right : std::uint8_t { watch, steer };

/// The server as a service sees it.
class ServiceHost {
 public:
  virtual Session& session() = 0;
  virtual Console& console() = 0;
  /// Runs `task` on the simulation's thread between two ticks. @return false: the run is over and the task was destroyed
  virtual bool post(std::function<void(Session&)> task) = 0;
  /// Calls `done` with the first status that `reached` returns; it is called whenever the run's report changes. When the run
  /// makes no progress for a few seconds, `done` gets an error.
  virtual void wait(std::function<std::optional<Status>(const Session::Report&)> reached,
                    std::function<void(const Status&)> done) = 0;
  /// Starts a program again that the server has started. Errors: it has started none of that name.
  virtual Status restart_program(const std::string& program) = 0;
  /// Opens a topic of sandlot_msgs/msg/Samples for this client. @param done  gets the topic's name
  virtual void watch(ClientId client, const std::vector<std::string>& values, double rate_hz,
                     std::function<void(const Result<std::string>& topic)> done) = 0;
  /// Decisions of referees so far. @param done  called on the simulation's thread
  virtual void decisions(const std::string& topic,
                         std::function<void(std::vector<msg::RefereeDecision>)> done) = 0;
  /// Track of the match so far. @param done  called on the simulation's thread
  virtual void match_track(std::function<void(const msg::MatchTrack::Response&)> done) = 0;
  /// What services know of the run from calls before; on the transport's thread.
  struct Memory {
    std::string world;  ///< file of the world; "": it has none
    std::uint64_t stopped_at =
        0;  ///< epoch in which the run was stopped, and has not been paused or played since; 0: none
  };
  virtual Memory& memory() = 0;
  /// Brings tasks to the transport's thread, from any thread and whatever has become of the host.
  virtual std::function<void(std::function<void()>)> way_back() = 0;

  /// Ends a client's connection. Errors: it is not there.
  virtual Status disconnect(ClientId client) = 0;

 protected:
  ~ServiceHost() = default;
};

/// One call: its client and the server.
struct ServiceContext {
  ServiceHost& host;
  ClientId client = 0;
  bool may_steer = false;
};

/// The way back of a call: takes one response of the service's type; copies share the call.
template <class S>
class Reply {
 public:
  explicit Reply(std::shared_ptr<ServiceCall> call) : call_(std::move(call)) {}
  void operator()(const typename S::Response& response) const { call_->answer(response); }

 private:
  std::shared_ptr<ServiceCall> call_;
};

/// A row of the table.
struct Service {
  const char* name;         ///< "/sandlot/console"
  const ServiceInfo* type;  ///< its messages
  Right right;
  void (*call)(const ServiceContext& context, const AnyMessage& request, std::shared_ptr<ServiceCall> call);
};
/// In the order of messages/services.def.
std::span<const Service> services();

/// The functions of the rows.
namespace service {
#define SL_SERVICE(type, name, right, function) \
  void function(const ServiceContext& context, const type::Request& request, const Reply<type>& reply);
#include "messages/services.def"
#undef SL_SERVICE
}  // namespace service

}  // namespace sandlot::server
