#pragma once
/// Roster: figures of a server's clients: who they are, what they drive, how late they are. None of it is State.
///
/// Threads   any.
/// Time      given by the caller: the wall clock in a server, anything in a test.
/// Gone      clients that have driven something stay as totals by name, role, what they drove and mode; at most most_totals of
///           them, what is beyond counts as "others".
#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "programs/remote/link.h"
#include "server/clients/duration_meter.h"
#include "server/http/access.h"
#include "server/http/transport.h"

namespace sandlot::server {

/// Events per second, over the latest three to four seconds.
class RateMeter {
 public:
  using Moment = std::chrono::steady_clock::time_point;
  void add(Moment now);
  double per_s(Moment now) const;

 private:
  static constexpr std::int64_t window_s = 4;
  void advance(std::int64_t second);
  std::array<std::uint32_t, window_s> counts_{};
  std::int64_t second_ = 0;
  std::optional<Moment> begun_;
};

/// How a client takes part in a run.
enum class Mode : std::uint8_t { watching, free, lockstep };
inline const char* name_of(Mode mode) {
  constexpr const char* names[] = {"watching", "free", "lockstep"};
  return names[static_cast<std::size_t>(mode)];
}

enum class Protocol : std::uint8_t { page, foxglove, rosbridge, rosbridge_tcp, rosbridge_udp };
inline const char* name_of(Protocol protocol) {
  constexpr const char* names[] = {"page", "foxglove", "rosbridge", "rosbridge, TCP", "rosbridge, UDP"};
  return names[static_cast<std::size_t>(protocol)];
}

class Roster {
 public:
  using Moment = std::chrono::steady_clock::time_point;
  using Counts = programs::remote::Link::Counts;
  static constexpr std::size_t most_totals = 200, longest_name = 60;

  // --- what happens ---
  void connected(ClientId id, Protocol protocol, const ConnectionFacts& facts, const Access& access,
                 Moment now);
  void disconnected(ClientId id);
  /// Bytes and messages dropped so far.
  void measured(ClientId id, const ConnectionFacts& facts);
  void message(ClientId id, Moment now);
  void refused(ClientId id);
  /// A command to a device, whatever became of it.
  void commanded(ClientId id, Moment now);
  /// The watchdog has stopped its robots.
  void stopped(ClientId id);
  /// It drives what `access` is for. @param name  "": it gave none
  void claimed(ClientId id, const Access& access, Mode mode, double deadline_s, const std::string& name);
  /// It drives nothing any more, and may do what `access` allows.
  void released(ClientId id, const Access& access);
  /// A program that it answers for in lockstep. Known ones keep their figures.
  /// @return  what the program's link counts into; null: there is no such client
  std::shared_ptr<Counts> answers_for(ClientId id, const std::string& path, double control_period_s,
                                      double longest_deadline_s);
  void told(ClientId id, const std::string& path, Moment now);
  void answered(ClientId id, const std::string& path, Moment now);

  // --- what is known ---
  struct ProgramRow {
    std::string path;
    double control_period_s = 0, deadline_s = 0;
    std::uint64_t steps = 0, misses = 0;
    std::optional<double> waiting_s;       ///< since it was told of the step that it has not answered
    DurationMeter::Figures latency, step;  ///< recent: tick told to answer, tick told to tick told
    std::array<std::uint64_t, DurationMeter::bins> histogram{};  ///< of all its latencies
  };
  struct Row {
    ClientId id = 0;
    Protocol protocol = Protocol::foxglove;
    ConnectionFacts connection;
    Access access;
    std::string drives;  ///< robot or team; "": nothing
    Mode mode = Mode::watching;
    double connected_s = 0;
    std::uint64_t messages = 0, commands = 0, refused = 0, stops = 0;
    double messages_per_s = 0, commands_per_s = 0;
    std::vector<ProgramRow> programs;
  };
  /// Those connected, in the order in which they came.
  std::vector<Row> rows(Moment now) const;

  /// What clients of one name did in one role, with one robot or team, in one mode.
  struct Total {
    std::string name;
    Role role = Role::spectator;
    std::string drives;
    Mode mode = Mode::free;
    std::uint64_t connections = 0, steps = 0, misses = 0, commands = 0, refused = 0, stops = 0;
    DurationMeter latency, step;
  };
  /// Of all clients that have driven something, present or gone, in the order of their end.
  std::vector<Total> totals() const;

 private:
  struct Program {
    std::string path;
    double control_period_s = 0, deadline_s = 0;
    std::shared_ptr<Counts> counts = std::make_shared<Counts>();
    DurationMeter latency, step;
    std::optional<Moment> told;
    bool waits = false;
  };
  struct Client {
    Row row;
    Moment since;
    double deadline_s = 0;
    RateMeter messages, commands;
    std::uint64_t refused_before = 0;  ///< when it began to drive what it drives now
    std::vector<Program> programs;
  };
  Client* find(ClientId id);
  static Program* find(Client* client, const std::string& path);
  static void end_drive(Client& client, std::vector<Total>& totals);

  mutable std::mutex mutex_;
  std::map<ClientId, Client> clients_;
  std::vector<Total> totals_;
};

/// A program outside the simulation's process.
struct OutsideProgram {
  std::string path, kind;
  bool is_client = false;  ///< a client of the server answers for it
  bool connected = false;  ///< to its process, or allowed to wait for a client
  bool started = false;    ///< a process that the run has started, as the client
  std::uint64_t answers = 0, misses = 0;
};

/// The message of /sandlot/clients.
std::string clients_json(const std::vector<Roster::Row>& rows, const std::vector<OutsideProgram>& programs);
/// A table for people.
std::string clients_text(const std::vector<Roster::Row>& rows);

}  // namespace sandlot::server
