#include "server/refbox/refbox.h"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <mutex>
#include <optional>
#include <string_view>

#include "base/log.h"
#include "messages/sandlot_soccer.h"
#include "server/http/tcp_port.h"
#include "sim/session/session.h"

namespace sandlot::server {
namespace {

using Clock = std::chrono::steady_clock;
using refbox::Side;
using refbox::Word;

constexpr double messages_per_s = 100, messages_at_once = 200;
/// Sentences about base stations that are logged: who connects again and again fills no log.
constexpr double lines_per_s = 1, lines_at_once = 20;
/// Of wrong messages, for each connection.
constexpr int most_warnings = 5;
/// Words on their way to the port's thread.
constexpr std::size_t most_waiting = 4096;

double seconds_since(Clock::time_point then) {
  return std::chrono::duration<double>(Clock::now() - then).count();
}

}  // namespace

std::vector<Word> RefereeWords::take(const Frame& frame, bool new_world) {
  if (new_world) latest_ = 0;
  struct Numbered {
    std::uint64_t sequence;
    Word word;
  };
  std::vector<Numbered> found;
  for (const LogEntry& entry : frame.log) {
    if (entry.kind != LogEntry::command || entry.source.kind != Source::Kind::rule ||
        entry.type != msg::RefereeCommand::ros_type)
      continue;
    ByteReader r(entry.bytes);
    msg::RefereeCommand command;
    read(r, command);
    const auto side = refbox::side_of(command.team);
    if (!r.ok() || !side) {
      ++wrong_;
      continue;
    }
    Word word{.command = command.command, .side = *side, .robot = command.robot};
    // Each robot is told; base stations once. A command without a number is the same where all of it is.
    const bool known = std::any_of(found.begin(), found.end(), [&](const Numbered& each) {
      return each.sequence == command.sequence && (command.sequence != 0 || each.word == word);
    });
    if (known || (command.sequence != 0 && command.sequence <= latest_)) continue;
    found.push_back({command.sequence, std::move(word)});
  }
  std::stable_sort(found.begin(), found.end(),
                   [](const Numbered& a, const Numbered& b) { return a.sequence < b.sequence; });
  std::vector<Word> out;
  for (Numbered& each : found) {
    latest_ = std::max(latest_, each.sequence);
    out.push_back(std::move(each.word));
  }
  return out;
}

struct Refbox::Impl final : Observer {
  struct Team {
    RefboxReport report;
    std::string pattern;
    TcpPort::Id connection = 0;  ///< 0: none
    refbox::MessageStream stream;
    double budget = messages_at_once;
    int warnings = 0;
    Clock::time_point budgeted, received;
  };

  Impl(const RefboxOptions& options, Session& the_session) : session(the_session), ids(options.teams.ids) {
    for (std::size_t i = 0; i < teams.size(); ++i) {
      const RefboxTeam& given = options.teams.all[i];
      teams[i].pattern = given.pattern;
      teams[i].report.side = given.side;
      teams[i].report.protocol = given.protocol;
      teams[i].report.id = given.side == Side::cyan ? ids.cyan : ids.magenta;
    }
  }

  // Simulation's thread.
  Wants wants() const override { return {.input = true, .instances = false}; }
  void on_frame(const std::shared_ptr<const Frame>& frame) override {
    const bool new_world = epoch != session.epoch();
    epoch = session.epoch();
    if (session.rerunning()) return;
    std::vector<Word> words = finder.take(*frame, new_world);
    if (!words.empty()) pass(std::move(words));
  }
  void pass(std::vector<Word> words) {
    const std::size_t count = words.size();
    if (waiting.load() + count > most_waiting) {
      log::warning("the referee box cannot keep up: words are lost");
      return;
    }
    waiting += count;
    port->post([this, all = std::move(words), count] {
      waiting -= count;
      {
        const std::lock_guard lock(mutex);
        for (const Word& word : all)
          for (Team& team : teams) send(team, word);
      }
      flush();
    });
  }

  // Port's thread, with the lock.
  void send(Team& team, const Word& word) {
    if (team.connection == 0) return;
    const auto bytes = refbox::encode(word, team.report.protocol, ids);
    if (!bytes) {
      ++team.report.unsent;
      return;
    }
    ++team.report.words;
    outgoing.emplace_back(team.connection, *bytes);
  }
  // Port's thread, without it: what is sent may end a connection.
  void flush() {
    std::vector<std::pair<TcpPort::Id, std::string>> all;
    {
      const std::lock_guard lock(mutex);
      all.swap(outgoing);
    }
    for (const auto& [id, bytes] : all) port->send(id, bytes);
  }

  /// Logs a line, unless there were too many.
  void note(bool is_warning, const std::string& text) {
    lines = std::min(lines_at_once, lines + seconds_since(lined) * lines_per_s);
    lined = Clock::now();
    if (lines < 1) return;
    lines -= 1;
    if (is_warning) log::warning("referee box: " + text);
    else log::info("referee box: " + text);
  }
  bool connected(TcpPort::Id id, const std::string& address);
  void received(TcpPort::Id id, std::string_view bytes);
  void disconnected(TcpPort::Id id);
  void take(Team& team, std::string_view message);
  Team* team_of(TcpPort::Id id) {
    const auto found = std::find_if(teams.begin(), teams.end(),
                                    [id](const Team& each) { return each.connection == id; });
    return found == teams.end() ? nullptr : &*found;
  }

  Session& session;
  const refbox::TeamIds ids;
  std::unique_ptr<TcpPort> port;
  // The simulation's thread.
  RefereeWords finder;
  std::uint64_t epoch = 0;
  std::atomic<std::size_t> waiting = 0;
  bool stopped = false;
  std::string bound;
  // The port's thread.
  double lines = lines_at_once;
  Clock::time_point lined = Clock::now();
  // Guarded.
  mutable std::mutex mutex;
  std::array<Team, 2> teams;
  std::vector<std::pair<TcpPort::Id, std::string>> outgoing;
};

bool Refbox::Impl::connected(TcpPort::Id id, const std::string& address) {
  bool known = false, accepted = false;
  {
    const std::lock_guard lock(mutex);
    for (Team& team : teams) {
      if (!address_matches(address, team.pattern)) continue;
      known = true;
      if (team.connection != 0) continue;
      team.connection = id;
      team.stream = {};
      team.warnings = 0;
      team.report.address = address;
      ++team.report.connections;
      send(team, {.command = "WELCOME", .side = team.report.side});
      note(false, fmt::format("base station of {} from {}, protocol {}", name_of(team.report.side), address,
                              name_of(team.report.protocol)));
      accepted = true;
      break;
    }
  }
  if (!accepted)
    note(true, fmt::format("{} is sent away: {}", address,
                           known ? "its team is connected already" : "no team has this address"));
  flush();
  return accepted;
}

void Refbox::Impl::received(TcpPort::Id id, std::string_view bytes) {
  bool ends = false;
  {
    const std::lock_guard lock(mutex);
    Team* const team = team_of(id);
    if (!team) return;
    team->budget = std::min(messages_at_once, team->budget + seconds_since(team->budgeted) * messages_per_s);
    team->budgeted = Clock::now();
    team->stream.append(bytes);
    while (true) {
      const auto next = team->stream.next();
      if (!next) {
        ++team->report.wrong;
        team->report.error = next.error().text();
        note(true, fmt::format("{} is disconnected: {}", name_of(team->report.side), next.error().text()));
        team->stream = {};
        ends = true;
        break;
      }
      if (!*next) break;
      take(*team, **next);
    }
  }
  if (ends) port->close(id);
}

void Refbox::Impl::take(Team& team, std::string_view message) {
  if (team.budget < 1) {
    ++team.report.dropped;
    return;
  }
  team.budget -= 1;
  auto state = refbox::read_world_state(message);
  if (!state) {
    ++team.report.wrong;
    team.report.error = state.error().text();
    if (team.warnings++ < most_warnings)
      note(true, fmt::format("a message of {}: {}", name_of(team.report.side), team.report.error));
    return;
  }
  ++team.report.world_states;
  team.report.latest = std::move(*state);
  team.received = Clock::now();
}

void Refbox::Impl::disconnected(TcpPort::Id id) {
  const std::lock_guard lock(mutex);
  Team* const team = team_of(id);
  if (!team) return;
  if (const std::size_t left = team->stream.waiting(); left > 0) {
    ++team->report.wrong;
    team->report.error = fmt::format("the connection ended within a message, after {} bytes without NUL",
                                     left);
    note(true, fmt::format("a message of {}: {}", name_of(team->report.side), team->report.error));
  }
  team->connection = 0;
  team->stream = {};
  team->report.address.clear();
  note(false, fmt::format("the base station of {} is gone", name_of(team->report.side)));
}

Refbox::Refbox(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

Result<std::unique_ptr<Refbox>> Refbox::start(const RefboxOptions& options, Session& session) {
  auto impl = std::make_unique<Impl>(options, session);
  Impl* const self = impl.get();
  SL_ASSIGN(self->port, TcpPort::listen({.option = "--refbox",
                                         .address = options.address,
                                         .port = options.port,
                                         .queue_bytes = options.queue_bytes,
                                         .send_buffer_bytes = options.send_buffer_bytes}));
  self->bound = fmt::format("{}:{}", options.address, self->port->port());
  TcpPort::Handler handler;
  handler.connected = [self](TcpPort::Id id, const std::string& address) {
    return self->connected(id, address);
  };
  handler.received = [self](TcpPort::Id id, std::string_view bytes) { self->received(id, bytes); };
  handler.disconnected = [self](TcpPort::Id id) { self->disconnected(id); };
  self->port->begin(std::move(handler));
  session.add_observer(self);
  return std::unique_ptr<Refbox>(new Refbox(std::move(impl)));
}

Refbox::~Refbox() { stop(); }

std::uint16_t Refbox::port() const { return impl_->port->port(); }
std::string Refbox::address() const { return impl_->bound; }

std::vector<RefboxReport> Refbox::teams() const {
  const std::lock_guard lock(impl_->mutex);
  std::vector<RefboxReport> out;
  for (const Impl::Team& team : impl_->teams) {
    out.push_back(team.report);
    if (team.report.world_states > 0)
      out.back().latest_age_s = seconds_since(team.received) + team.report.latest.age_ms / 1000.0;
  }
  return out;
}

std::uint64_t Refbox::refused() const { return impl_->port->counters().refused; }

void Refbox::say(std::vector<Word> words) { impl_->pass(std::move(words)); }

void Refbox::stop() {
  if (std::exchange(impl_->stopped, true)) return;
  impl_->session.remove_observer(impl_.get());
  impl_->port->stop();
}

}  // namespace sandlot::server
