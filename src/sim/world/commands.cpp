/// Requests on their way into a tick, and what the tick records of them.
#include "sim/world/commands.h"

#include <algorithm>
#include <tuple>

namespace sandlot {

void Commands::drop_unlogged() {
  const std::lock_guard lock(mutex_);
  std::erase_if(inbox_, [](const Pending& each) { return !each.logged; });
}

bool Commands::awaits_spawn(std::string_view name) const {
  const std::lock_guard lock(mutex_);
  return std::any_of(inbox_.begin(), inbox_.end(), [&](const Pending& each) {
    const auto* const spawn = std::get_if<SpawnRequest>(&each.request);
    return spawn && spawn->instance.name == name;
  });
}

std::uint64_t Commands::queue(Request request, Source source, bool logged) {
  const std::lock_guard lock(mutex_);
  inbox_.push_back({source, next_sequence_, std::move(request), logged});
  return next_sequence_++;
}

std::span<Commands::Pending> Commands::take(const SerialOf& serial_of) {
  taken_.clear();
  {
    const std::lock_guard lock(mutex_);
    std::swap(taken_, inbox_);
  }
  const auto live = std::stable_partition(taken_.begin(), taken_.end(),
                                          [](const Pending& each) { return each.logged; });
  std::sort(live, taken_.end(), [](const Pending& a, const Pending& b) {
    return std::tuple(a.source.kind, a.source.id, a.sequence) <
           std::tuple(b.source.kind, b.source.id, b.sequence);
  });
  if (live != taken_.end()) order_clients(static_cast<std::size_t>(live - taken_.begin()), serial_of);
  return taken_;
}

/// Orders the clients whose requests lie side by side from `begin` on.
void Commands::order_clients(std::size_t begin, const SerialOf& serial_of) {
  constexpr std::uint64_t nobody = ~std::uint64_t{0};
  struct Client {
    Source::Kind kind;
    std::uint64_t robot;  ///< the first that it drives
    std::vector<std::byte> content;
    std::size_t first, end;  ///< of its requests
  };
  std::vector<Client> clients;
  for (std::size_t i = begin; i < taken_.size(); ++i) {
    Pending& each = taken_[i];
    const Source& source = each.source;
    const bool drives = source.kind == Source::Kind::robot;
    const std::optional<std::uint64_t> serial = drives ? serial_of(request_target(each.request))
                                                       : std::nullopt;
    if (i == begin || source.kind != taken_[i - 1].source.kind || source.id != taken_[i - 1].source.id)
      clients.push_back({source.kind, source.kind == Source::Kind::program ? source.id : nobody, {}, i, i});
    clients.back().end = i + 1;
    if (serial) clients.back().robot = std::min(clients.back().robot, *serial);
  }
  if (clients.size() > 1) {
    for (Client& client : clients) {
      ByteWriter w;
      for (std::size_t i = client.first; i < client.end; ++i) write_request(w, taken_[i].request);
      client.content = std::move(w.buffer());
    }
    std::stable_sort(clients.begin(), clients.end(), [](const Client& a, const Client& b) {
      return std::tie(a.kind, a.robot, a.content) < std::tie(b.kind, b.robot, b.content);
    });
    std::vector<Pending> ordered;
    ordered.reserve(taken_.size() - begin);
    for (const Client& client : clients)
      for (std::size_t i = client.first; i < client.end; ++i) ordered.push_back(std::move(taken_[i]));
    std::move(ordered.begin(), ordered.end(), taken_.begin() + static_cast<std::ptrdiff_t>(begin));
  }
  for (std::size_t i = begin; i < taken_.size(); ++i)
    if (Source& source = taken_[i].source; source.kind == Source::Kind::robot)
      source.id = serial_of(request_target(taken_[i].request)).value_or(source.id);
}

void Commands::begin_tick(Time now) {
  outcomes_.clear();
  std::erase_if(overrides_, [&](const ManualOverride& each) { return each.until <= now; });
}

void Commands::conclude(const Pending& pending, Status status, bool logged, std::vector<std::byte> response) {
  outcomes_.push_back({pending.source, pending.sequence, std::move(status), std::move(response)});
  if (logged) log_request(pending.request, outcomes_.back());
}

void Commands::override_manually(const SimulationParts::Device& device, Time now) {
  const auto place = std::lower_bound(
      overrides_.begin(), overrides_.end(), device.key,
      [](const ManualOverride& each, std::uint64_t key) { return each.device < key; });
  const Time until = now + Time::from_s(manual_override_s);
  if (place != overrides_.end() && place->device == device.key) place->until = until;
  else overrides_.insert(place, {device.key, until});
}

void Commands::restore(std::vector<ManualOverride> overrides) {
  overrides_ = std::move(overrides);
  // A snapshot may hold them in any order.
  std::stable_sort(overrides_.begin(), overrides_.end(),
                   [](const ManualOverride& a, const ManualOverride& b) { return a.device < b.device; });
}

LogEntry& Commands::log_entry(std::uint8_t kind, const Source& source, std::uint64_t sequence) {
  if (spare_log_.empty()) spare_log_.emplace_back();
  LogEntry& entry = log_.emplace_back(std::move(spare_log_.back()));
  spare_log_.pop_back();
  entry.kind = kind;
  entry.source = source;
  entry.sequence = sequence;
  entry.target.clear();
  entry.type.clear();
  entry.bytes.clear();
  entry.refused = false;
  entry.why.clear();
  return entry;
}

void Commands::clear_log() {
  for (LogEntry& entry : log_) spare_log_.push_back(std::move(entry));
  log_.clear();
}

void Commands::log_request(const Request& request, const Outcome& outcome) {
  LogEntry& entry = log_entry(static_cast<std::uint8_t>(request.index()), outcome.source, outcome.sequence);
  entry.target = request_target(request);
  entry.refused = !outcome.status;
  if (entry.refused) entry.why = outcome.status.error().text();
  if (const auto* command = std::get_if<CommandRequest>(&request)) {
    entry.type = command->type;
    entry.bytes = command->bytes;
  } else {
    ByteWriter w;
    write_request(w, request);
    entry.bytes = std::move(w.buffer());
  }
}

}  // namespace sandlot
