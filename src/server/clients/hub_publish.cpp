/// Parameters and commands from clients; the connection graph.
#include <algorithm>

#include "base/text.h"
#include "messages/command.h"
#include "server/clients/hub.h"
#include "server/clients/parameters.h"

namespace sandlot::server {
namespace {

using foxglove::Parameter;

constexpr const char* speed_name = "sandlot.speed";
constexpr const char* paused_name = "sandlot.paused";
bool is_own(const std::string& name) { return name == speed_name || name == paused_name; }

/// Answers of several parameters that come at different times; the last one who lets go of it sends them.
struct ParameterAnswer {
  std::shared_ptr<Mailbox> mailbox;
  ClientId client = 0;
  std::string id;
  std::vector<Parameter> values;
  std::vector<std::string> errors;  ///< one per value; "": it was set

  ~ParameterAnswer() {
    mailbox->push([client = client, id = id, values = std::move(values), errors = std::move(errors)](
                      Hub& hub) { hub.answer_parameters(client, id, values, errors); });
  }
};

}  // namespace

Parameter Hub::own_parameter(const std::string& name) const {
  const Session::Report report = session_.report();
  Parameter out;
  out.name = name;
  if (name == paused_name) {
    out.value = report.state == Session::State::paused;
  } else {
    out.value = report.speed.value_or(0);
    out.type = "float64";
  }
  return out;
}

void Hub::send_own_parameters() {
  const Parameter own[] = {own_parameter(speed_name), own_parameter(paused_name)};
  send_parameters(own);
}

void Hub::send_parameters(std::span<const Parameter> changed) {
  for (const auto& [id, client] : clients_) {
    std::vector<Parameter> chosen;
    for (const Parameter& each : changed)
      if (client.all_parameters || client.parameters.count(each.name) > 0) chosen.push_back(each);
    if (!chosen.empty()) client.face->tell_parameters(chosen, {});
  }
}

void Hub::answer_parameters(ClientId id, const std::string& about, std::span<const Parameter> values,
                            std::span<const std::string> errors) {
  Client* const client = find(id);
  if (!client) return;
  if (client->calls > 0) --client->calls;
  for (const std::string& each : errors)
    if (!each.empty()) refuse(id, each, about);
  client->face->tell_parameters(values, about);
}

bool Hub::get_parameters(ClientId id, const std::vector<std::string>& names, const std::string& about) {
  Client& client = clients_.at(id);
  if (!sees_world(client)) return refuse(id, "parameters are for those who see the world", about), false;
  if (client.calls >= most_calls) return refuse(id, "too many requests wait for their answers", about), false;
  // Each is looked up on the simulation's thread.
  if (names.size() > most_named_parameters)
    return refuse(id,
                  "more than " + std::to_string(most_named_parameters) + " parameters are requested by name",
                  about),
           false;
  ++client.calls;
  const auto answer = std::make_shared<ParameterAnswer>();
  answer->mailbox = mailbox_;
  answer->client = id;
  answer->id = about;
  if (names.empty()) answer->values = {own_parameter(speed_name), own_parameter(paused_name)};
  for (const std::string& name : names)
    if (is_own(name)) answer->values.push_back(own_parameter(name));
  const Charged charged(*this, client.access.is_admin() ? 0 : id);
  post([answer, names](Session& session) {
    const Simulation& simulation = session.simulation();
    if (names.empty() && !list_parameters(simulation, answer->values))
      answer->errors.push_back("there are more than " + std::to_string(most_parameters) +
                               " parameters; ask for the others by name");
    // The session's own have no such address.
    for (Parameter& found : read_parameters(simulation, names))
      if (found.value.index() != 0 && !is_own(found.name)) answer->values.push_back(std::move(found));
  });
  return true;
}

bool Hub::set_parameters(ClientId id, const std::vector<Parameter>& parameters, const std::string& about) {
  Client& client = clients_.at(id);
  if (!client.access.is_admin())
    return refuse(id, std::string("a ") + name_of(client.access.role) + " may not set parameters", about),
           false;
  if (client.calls >= most_calls) return refuse(id, "too many requests wait for their answers", about), false;
  ++client.calls;
  const auto answer = std::make_shared<ParameterAnswer>();
  answer->mailbox = mailbox_;
  answer->client = id;
  answer->id = about;
  answer->values.resize(parameters.size());
  answer->errors.resize(parameters.size());
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Parameter& parameter = parameters[i];
    answer->values[i].name = parameter.name;
    std::string& error = answer->errors[i];
    if (is_own(parameter.name)) {
      const auto* const number = std::get_if<double>(&parameter.value);
      const auto* const flag = std::get_if<bool>(&parameter.value);
      if (parameter.name == speed_name && number) {
        const Status status = session_.set_speed(*number == 0 ? std::nullopt : std::optional(*number));
        if (!status) error = status.error().text();
      } else if (parameter.name == paused_name && flag) {
        if (*flag) session_.pause();
        else session_.play();
      } else {
        error = parameter.name + (parameter.name == speed_name ? " is a number" : " is true or false");
      }
      answer->values[i] = own_parameter(parameter.name);
      if (error.empty()) answer->values[i].value = parameter.value;  // it acts before the next tick
      continue;
    }
    auto made = parameter_request(parameter);
    if (!made) {
      error = made.error().text();
      continue;
    }
    // Until it is answered the entry holds "the run is over", which is true if nobody answers.
    error = "the run is over";
    const auto queued = session_.submit(
        std::move(*made), {Source::Kind::admin, id}, [answer, i, &session = session_](const Status& status) {
          answer->errors[i] = status ? "" : answer->values[i].name + ": " + status.error().text();
          answer->values[i] = read_parameter(session.simulation(), answer->values[i].name);
        });
    if (!queued) error = queued.error().text();
  }
  return true;
}

Status Hub::judge(ClientId id, const Publication& publication) const {
  const Access& who = access(id);
  if (who.role == Role::spectator) return Error{"a spectator may not publish"};
  if (inventory_->topics.empty() && !who.is_scoped()) return {};
  const auto target = find_target(id, publication);
  return target ? Status() : Status(target.error());
}

/// Who drives robots is told of no others, neither by refusals nor by the nearest name.
Result<Inventory::Target> Hub::find_target(ClientId id, const Publication& publication) const {
  const Access& who = access(id);
  if (!who.is_scoped()) return inventory_->target(publication.topic, publication.type);
  return inventory_->target(publication.topic, publication.type,
                            [&](const Inventory::Slot& slot) { return who.may_command(slot.device); });
}

void Hub::advertise(ClientId id, std::uint32_t number, Publication publication) {
  clients_.at(id).publications[number] = std::move(publication);
  graph_changed_ = true;
}

bool Hub::unadvertise(ClientId id, std::uint32_t number) {
  graph_changed_ = true;
  return clients_.at(id).publications.erase(number) > 0;
}

Hub::Publication* Hub::find_publication(ClientId id, std::uint32_t number) {
  auto& all = clients_.at(id).publications;
  const auto found = all.find(number);
  return found == all.end() ? nullptr : &found->second;
}

void Hub::publish(ClientId id, Publication& publication, std::span<const std::byte> bytes,
                  Encoding encoding) {
  publish(id, publication, [&](const TopicBase& slot) {
    return encoding == Encoding::json
               ? command_from_json(
                     slot, std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()))
               : command_from_cdr(slot, bytes);
  });
}

void Hub::publish(ClientId id, Publication& publication, const ReadCommand& read) {
  if (publication.world != inventory_) {  // levels may have changed, and with them who takes it
    if (Status allowed = judge(id, publication); !allowed) return refuse(id, allowed.error().text());
    const auto target = find_target(id, publication);
    if (!target) return refuse(id, target.error().text());
    publication.world = inventory_;
    publication.target = *target;
  }
  const Inventory::Slot& slot = *publication.target.slot;
  auto command = read(*slot.blank);
  if (!command) return refuse(id, publication.topic + ": " + command.error().text());
  roster_.commanded(id, Clock::now());
  Client& client = clients_.at(id);
  if (client.claim &&
      !slot.of_program) {  // a goal is no order of the step, and who sent one may be silent then
    client.claim->commanded = Clock::now();
    client.claim->moving = true;
    if (client.claim->request.lockstep && collect(id, client, publication, *command)) return;
  }
  const auto queued = session_.submit(
      CommandRequest{publication.target.address, slot.info->name, std::move(*command)},
      {Source::Kind::robot, id}, [mailbox = mailbox_, id](const Status& status) {
        if (!status)
          mailbox->push([id, why = status.error().text()](Hub& hub) { hub.report_refusal(id, why); });
      });
  if (!queued) refuse(id, queued.error().text());
}

foxglove::Graph Hub::graph() const {
  using Named = foxglove::Graph::Named;
  std::map<std::string, std::vector<std::string>> published, subscribed;
  for (const Inventory::Topic& topic : inventory_->topics) published[topic.name].push_back(topic.device);
  for (const auto& [id, each] : channels_)
    if (each.kind != ChannelKind::device && each.owner == 0)
      published[each.info.topic].emplace_back("sandlot");
  for (const Inventory::Slot& slot : inventory_->slots)
    if (!slot.of_program) subscribed[slot.name].push_back(slot.device);
  for (const Inventory::Program& program : inventory_->programs) {
    for (const std::string& topic : program.reads) subscribed[topic].push_back(program.path);
    for (const std::string& topic : program.orders) published[topic].push_back(program.path);
  }
  for (const auto& [id, each] : channels_)
    if (each.owner == 0)
      for (const Subscriber& subscriber : each.subscribers)
        subscribed[each.info.topic].push_back("viewer " + std::to_string(subscriber.client));
  for (const auto& [id, client] : clients_)
    for (const auto& [channel, publication] : client.publications) {
      const auto target = inventory_->target(publication.topic, publication.type);
      published[target ? target->slot->name : publication.topic].push_back("viewer " + std::to_string(id));
    }
  foxglove::Graph out;
  for (auto& [name, ids] : published) out.published.push_back(Named{name, std::move(ids)});
  for (auto& [name, ids] : subscribed) out.subscribed.push_back(Named{name, std::move(ids)});
  for (const auto& [number, service] : services_)
    out.services.push_back(Named{service.offer.name, {service.row ? "sandlot" : service.device}});
  return out;
}

/// Nothing is written as long as nobody looks. @param new_looker  gets it alone, and whole
void Hub::send_graph(ClientId new_looker) {
  if (new_looker != 0) return clients_.at(new_looker).face->tell_graph(graph(), {});
  graph_changed_ = false;
  graph_sent_ = Clock::now();
  std::vector<ClientId> lookers;
  for (const auto& [id, client] : clients_)
    if (client.graph) lookers.push_back(id);
  if (lookers.empty()) return;
  foxglove::Graph now = graph();
  const auto gone = [](const auto& before, const auto& after) {
    std::vector<foxglove::Graph::Named> out;
    for (const auto& each : before)
      if (std::none_of(after.begin(), after.end(), [&](const auto& a) { return a.name == each.name; }))
        out.push_back({each.name, {}});
    return out;
  };
  const foxglove::Graph removed{gone(graph_.published, now.published),
                                gone(graph_.subscribed, now.subscribed), gone(graph_.services, now.services)};
  const auto same = [](const auto& a, const auto& b) {
    return std::equal(a.begin(), a.end(), b.begin(), b.end(),
                      [](const auto& x, const auto& y) { return x.name == y.name && x.ids == y.ids; });
  };
  const bool changed = !same(graph_.published, now.published) || !same(graph_.subscribed, now.subscribed) ||
                       !same(graph_.services, now.services);
  graph_ = std::move(now);
  if (!changed) return;
  for (const ClientId id : lookers) clients_.at(id).face->tell_graph(graph_, removed);
}

}  // namespace sandlot::server
