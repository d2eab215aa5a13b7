#pragma once
/// Server of a run: the page, the Foxglove protocol, services, parameters, publishing. Messages: docs/viewer_protocol.md.
///
///   Session session(...);
///   SL_ASSIGN(auto server, Server::start({.transport = {.port = 8765}}, session, console));
///   ... session.run(report) ...
///   server->stop();
///
/// The run   is never changed by viewers: messages are copied on the simulation's thread only while somebody has subscribed, and
///           encoded and sent by the server's own thread. When that falls behind, frames are left out.
/// Errors    start(): the address cannot be bound.
/// Cost      on the simulation's thread: filling frames with what is subscribed, at most 30 times a second for poses.
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "server/clients/roster.h"
#include "server/http/transport.h"
#include "server/processes.h"

namespace sandlot {
class Console;
class Session;
}  // namespace sandlot

namespace sandlot::server {

struct ServerOptions {
  TransportOptions transport;
  std::string name;     ///< of the run, shown by viewers
  std::string version;  ///< of Sandlot
  std::string world;    ///< file that the run was loaded from; "": none
  double poses_hz = 30;
  double watchdog_s =
      1;  ///< a robot whose client commands nothing for so long, by the wall clock, is stopped
  struct Recording {
    std::string file;
    std::uint64_t messages = 0, bytes = 0;
  };
  /// The recording in progress; called on the server's thread. Unset: none.
  std::function<std::optional<Recording>()> recording = {};
  ProgramOptions programs = {};  ///< whether and how the server starts the programs of robots and teams
};

class Server {
 public:
  /// Also starts the programs that the options ask for, each with a port of its own; without another port nobody else can come.
  /// @pre session and console outlive the server; called before session.run(). Session::on_change is taken, what was there
  /// is called as before.
  static Result<std::unique_ptr<Server>> start(const ServerOptions& options, Session& session,
                                               Console& console);
  ~Server();
  std::string url() const;
  Counters counters() const;
  /// Figures of all clients that have driven something, present or gone. On any thread.
  std::vector<Roster::Total> clients() const;
  /// Closes all connections. @pre session.run() has returned, or this is its thread
  void stop();

 private:
  struct Impl;
  explicit Server(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

/// A file of the page by its path ("/main.js"; "/" is index.html): in the program, put there by the build.
struct PageFile {
  std::string_view path, type;
  std::span<const std::byte> bytes;
  std::string_view etag;  ///< without quotes: another one for other bytes
};
std::span<const PageFile> page_files();
/// False: it was built without node or its packages, and "/" explains how to get them.
bool has_page();

}  // namespace sandlot::server
