#include "server/clients/roster.h"

#include <algorithm>

namespace sandlot::server {
namespace {

std::int64_t second_of(RateMeter::Moment moment) {
  return std::chrono::duration_cast<std::chrono::seconds>(moment.time_since_epoch()).count();
}

double seconds(std::chrono::steady_clock::duration passed) {
  return std::chrono::duration<double>(passed).count();
}

/// A name as others may see it: short, on one line.
std::string presentable(std::string name) {
  if (name.size() > Roster::longest_name) name.resize(Roster::longest_name);
  for (char& c : name)
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) c = ' ';
  return name;
}

}  // namespace

void RateMeter::advance(std::int64_t second) {
  second_ = std::max(second_, second - window_s);
  while (second_ < second) counts_[static_cast<std::size_t>(++second_ % window_s)] = 0;
}

void RateMeter::add(Moment now) {
  if (!begun_) begun_ = now;
  advance(second_of(now));
  ++counts_[static_cast<std::size_t>(second_ % window_s)];
}

double RateMeter::per_s(Moment now) const {
  if (!begun_) return 0;
  RateMeter until_now = *this;
  until_now.advance(second_of(now));
  const double of_this_second = seconds(now - Moment(std::chrono::seconds(second_of(now))));
  const double spanned_s = std::min(seconds(now - *begun_), window_s - 1 + of_this_second);
  constexpr double shortest_s = 0.5;
  double sum = 0;
  for (const std::uint32_t each : until_now.counts_) sum += each;
  return sum / std::max(spanned_s, shortest_s);
}

Roster::Client* Roster::find(ClientId id) {
  const auto found = clients_.find(id);
  return found == clients_.end() ? nullptr : &found->second;
}

Roster::Program* Roster::find(Client* client, const std::string& path) {
  if (!client) return nullptr;
  const auto found = std::find_if(client->programs.begin(), client->programs.end(),
                                  [&](const Program& each) { return each.path == path; });
  return found == client->programs.end() ? nullptr : &*found;
}

void Roster::connected(ClientId id, Protocol protocol, const ConnectionFacts& facts, const Access& access,
                       Moment now) {
  const std::lock_guard lock(mutex_);
  Client& client = clients_[id];
  client.since = now;
  client.row.id = id;
  client.row.protocol = protocol;
  client.row.connection = facts;
  client.row.connection.name = presentable(facts.name);
  client.row.access = access;
}

void Roster::disconnected(ClientId id) {
  const std::lock_guard lock(mutex_);
  Client* const client = find(id);
  if (!client) return;
  end_drive(*client, totals_);
  clients_.erase(id);
}

void Roster::measured(ClientId id, const ConnectionFacts& facts) {
  const std::lock_guard lock(mutex_);
  Client* const client = find(id);
  if (!client) return;
  ConnectionFacts& known = client->row.connection;
  known.bytes_in = facts.bytes_in;
  known.bytes_out = facts.bytes_out;
  known.dropped = facts.dropped;
}

void Roster::message(ClientId id, Moment now) {
  const std::lock_guard lock(mutex_);
  Client* const client = find(id);
  if (!client) return;
  ++client->row.messages;
  client->messages.add(now);
}

void Roster::refused(ClientId id) {
  const std::lock_guard lock(mutex_);
  if (Client* const client = find(id)) ++client->row.refused;
}

void Roster::commanded(ClientId id, Moment now) {
  const std::lock_guard lock(mutex_);
  Client* const client = find(id);
  if (!client) return;
  ++client->row.commands;
  client->commands.add(now);
}

void Roster::stopped(ClientId id) {
  const std::lock_guard lock(mutex_);
  if (Client* const client = find(id)) ++client->row.stops;
}

void Roster::claimed(ClientId id, const Access& access, Mode mode, double deadline_s,
                     const std::string& name) {
  const std::lock_guard lock(mutex_);
  Client* const client = find(id);
  if (!client) return;
  end_drive(*client, totals_);
  client->row.access = access;
  client->row.drives = access.name;
  client->row.mode = mode;
  client->deadline_s = deadline_s;
  if (!name.empty()) client->row.connection.name = presentable(name);
}

void Roster::released(ClientId id, const Access& access) {
  const std::lock_guard lock(mutex_);
  Client* const client = find(id);
  if (!client) return;
  end_drive(*client, totals_);
  client->row.access = access;
}

std::shared_ptr<Roster::Counts> Roster::answers_for(ClientId id, const std::string& path,
                                                    double control_period_s, double longest_deadline_s) {
  const std::lock_guard lock(mutex_);
  Client* const client = find(id);
  if (!client) return nullptr;
  Program* program = find(client, path);
  if (!program) {
    client->programs.emplace_back();
    program = &client->programs.back();
    program->path = path;
  }
  program->control_period_s = control_period_s;
  program->deadline_s = std::min(client->deadline_s, longest_deadline_s);
  program->waits = false;
  return program->counts;
}

void Roster::told(ClientId id, const std::string& path, Moment now) {
  const std::lock_guard lock(mutex_);
  Program* const program = find(find(id), path);
  if (!program) return;
  if (program->told) program->step.add(seconds(now - *program->told));
  program->told = now;
  program->waits = true;
}

void Roster::answered(ClientId id, const std::string& path, Moment now) {
  const std::lock_guard lock(mutex_);
  Program* const program = find(find(id), path);
  if (!program || !program->waits) return;
  program->latency.add(seconds(now - *program->told));
  program->waits = false;
}

/// Adds to the totals what a client has driven until now; from here on it drives nothing.
void Roster::end_drive(Client& client, std::vector<Total>& totals) {
  Row& row = client.row;
  Total made;
  made.name = row.connection.name;
  made.role = row.access.role;
  made.drives = row.drives;
  made.mode = row.mode == Mode::watching ? Mode::free : row.mode;
  made.commands = row.commands;
  made.stops = row.stops;
  made.refused = row.refused - client.refused_before;
  for (const Program& each : client.programs) {
    made.steps += each.counts->steps;
    made.misses += each.counts->misses;
    made.latency.add(each.latency);
    made.step.add(each.step);
  }
  row.drives.clear();
  row.mode = Mode::watching;
  row.commands = row.stops = 0;
  client.refused_before = row.refused;
  client.programs.clear();
  if (made.steps + made.commands == 0) return;
  const auto same = [&](const Total& each) {
    return each.name == made.name && each.role == made.role && each.drives == made.drives &&
           each.mode == made.mode;
  };
  auto to = std::find_if(totals.begin(), totals.end(), same);
  if (to == totals.end() && totals.size() >= most_totals) {
    made.name = "others";
    made.drives.clear();
    made.role = Role::spectator;
    to = std::find_if(totals.begin(), totals.end(), same);
  }
  if (to == totals.end()) {
    totals.emplace_back();
    to = totals.end() - 1;
    to->name = made.name;
    to->role = made.role;
    to->drives = made.drives;
    to->mode = made.mode;
  }
  ++to->connections;
  to->steps += made.steps;
  to->misses += made.misses;
  to->commands += made.commands;
  to->refused += made.refused;
  to->stops += made.stops;
  to->latency.add(made.latency);
  to->step.add(made.step);
}

std::vector<Roster::Total> Roster::totals() const {
  const std::lock_guard lock(mutex_);
  std::vector<Total> out = totals_;
  for (const auto& [id, client] : clients_) {
    Client copy = client;
    end_drive(copy, out);
  }
  return out;
}

std::vector<Roster::Row> Roster::rows(Moment now) const {
  const std::lock_guard lock(mutex_);
  std::vector<Row> out;
  for (const auto& [id, client] : clients_) {
    Row& row = out.emplace_back(client.row);
    row.connected_s = seconds(now - client.since);
    row.messages_per_s = client.messages.per_s(now);
    row.commands_per_s = client.commands.per_s(now);
    for (const Program& each : client.programs) {
      ProgramRow& program = row.programs.emplace_back();
      program.path = each.path;
      program.control_period_s = each.control_period_s;
      program.deadline_s = each.deadline_s;
      program.steps = each.counts->steps;
      program.misses = each.counts->misses;
      if (each.waits) program.waiting_s = seconds(now - *each.told);
      program.latency = each.latency.recent();
      program.step = each.step.recent();
      program.histogram = each.latency.histogram();
    }
  }
  return out;
}

}  // namespace sandlot::server
