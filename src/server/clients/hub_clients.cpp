/// Who is connected: figures of the clients, to those who may see them; the end of a connection by an administrator.
#include "programs/remote/remote.h"
#include "server/clients/hub.h"

namespace sandlot::server {
namespace {

using namespace std::chrono_literals;

constexpr auto measuring_pause = 230ms;
constexpr auto clients_pause = 450ms;

/// A number of a program's State; 0 when it has none of that name.
std::uint64_t count_of(const Program& program, const char* name) {
  const ValueStep path[] = {ValueStep{name}};
  const ValueFound found = program.value(ValuePart::state, path);
  return found.is == ValueFound::Is::value ? static_cast<std::uint64_t>(found.value) : 0;
}

}  // namespace

/// Measures the connections, and asks the simulation's thread for the programs that clients may answer for.
void Hub::watch_clients() {
  const auto now = Clock::now();
  if (now < clients_measured_ + measuring_pause) return;
  clients_measured_ = now;
  for (const auto& [id, client] : clients_) roster_.measured(id, transport_->facts(id));
  if (!subscribed(ChannelKind::clients) || now < clients_asked_ + clients_pause) return;
  clients_asked_ = now;
  const bool posted = post([mailbox = mailbox_](Session& session) {
    std::vector<OutsideProgram> programs;
    session.simulation().for_each_outside([&](const SimulationParts::ProgramEntry& entry, Outside& outside) {
      programs.push_back({entry.path, entry.decl.kind, outside.is_client(), outside.connected(),
                          outside.has_command(), count_of(*entry.program, "answers"),
                          count_of(*entry.program, "misses")});
    });
    mailbox->push([programs = std::move(programs)](Hub& hub) { hub.send_clients(programs); });
  });
  if (!posted) send_clients({});  // the run is over
}

void Hub::send_clients(std::vector<OutsideProgram> programs) {
  if (!subscribed(ChannelKind::clients)) return;
  const std::vector<Roster::Row> rows = roster_.rows(Clock::now());
  const Channel& to = channel(ChannelKind::clients);
  std::optional<Outgoing> whole;
  for (const Subscriber& each : to.subscribers) {
    const Client* const client = find(each.client);
    if (!client) continue;
    if (client->access.is_admin()) {
      if (!whole) whole.emplace(to.info, now_, payload_of(clients_json(rows, programs)));
      send(each, *whole, true);
      continue;
    }
    std::vector<Roster::Row> itself = rows;
    std::erase_if(itself, [&](const Roster::Row& row) { return row.id != each.client; });
    send(each, {to.info, now_, payload_of(clients_json(itself, {}))}, true);
  }
}

Status Hub::disconnect(ClientId id) {
  Client* const client = find(id);
  if (!client) return Error{"there is no client " + std::to_string(id)};
  constexpr const char* why = "an administrator has ended the connection";
  end_claim(id, *client, why);
  transport_->close_client(id, why);
  return {};
}

}  // namespace sandlot::server
