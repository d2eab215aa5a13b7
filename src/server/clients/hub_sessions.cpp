/// Sessions: clients that drive a robot or a team, freely or in lockstep with the run.
///
/// A claim narrows the client to its robots: what it sees and does from then on is theirs alone. Commands of free clients are
/// requests to the run. Those of clients in lockstep are collected until the client ends the step; then they are the answer of
/// the robot's remote program (programs/remote/remote.h), and act as the orders of a controller in this process would.
#include <algorithm>

#include "base/json_writer.h"
#include "base/text.h"
#include "messages/command.h"
#include "messages/json.h"
#include "programs/remote/remote.h"
#include "server/clients/hub.h"
#include "server/http/http.h"

namespace sandlot::server {
namespace {

constexpr int most_wrong_tokens = 5;
/// A claim makes work for the simulation's thread: it counts as so many requests.
constexpr double requests_per_claim = 25;
constexpr double messages_per_step =
    64;  ///< that a client in lockstep may send for each, however fast the run is

bool overlap(const Access& a, const Access& b) {
  return std::any_of(a.robots.begin(), a.robots.end(),
                     [&](const std::string& each) { return b.drives(each); });
}

}  // namespace

/// What a claim would open, if the client may make it.
Result<Access> Hub::access_of_claim(ClientId id, const ClaimRequest& request) {
  Client& client = clients_.at(id);
  Access out;
  out.role = request.robot.empty() ? Role::team : Role::robot;
  out.name = request.robot.empty() ? request.team : request.robot;
  for (const Inventory::Robot& each : inventory_->robots)
    if (out.role == Role::robot ? each.name == out.name : each.team == out.name)
      out.robots.push_back(each.name);
  const auto& tokens = options_.transport.tokens;
  const Access& has = client.access;
  bool allowed = has.is_admin() || (has.role == out.role && has.name == out.name);
  bool knows_names = has.is_admin();
  if (!allowed && !request.token.empty()) {
    // Messages that came with the one too many are on their way still.
    if (client.wrong_tokens >= most_wrong_tokens) return Error{"too many wrong tokens"};
    if (!transport_->may_try_token(id))
      return Error{"too many wrong tokens came from your address", "wait some seconds"};
    const Token* const token = find_token(request.token, tokens);
    allowed = token && (token->access.is_admin() ||
                        (token->access.role == out.role && token->access.name == out.name));
    knows_names = knows_names || (token && token->access.is_admin());
    // Who guesses is sent away.
    if (!allowed) transport_->count_wrong_token(id);
    if (!allowed && ++client.wrong_tokens >= most_wrong_tokens)
      transport_->close_client(id, "too many wrong tokens");
  }
  if (!allowed) return Error{"this is not the token of '" + out.name.substr(0, 100) + "'"};
  if (out.robots.empty()) {
    std::vector<std::string> known;
    for (const Inventory::Robot& each : inventory_->robots)
      known.push_back(out.role == Role::robot ? each.name : each.team);
    return Error{std::string("there is no ") + name_of(out.role) + " '" + out.name.substr(0, 100) + "'",
                 knows_names ? suggestion(out.name, known) : ""};
  }
  return out;
}

/// One client drives a robot. Another takes it over with the same token alone.
Status Hub::make_room(ClientId id, const Access& access, const std::string& token) {
  for (auto& [other_id, other] : clients_) {
    if (other_id == id || !other.claim || !overlap(other.access, access)) continue;
    const std::string& others = other.claim->request.token;
    const bool same = !token.empty() && same_secret(token, others) && other.access.name == access.name;
    if (!same)
      return Error{"'" + access.name + "' is driven by another client",
                   "take it over with the token of that one"};
  }
  for (auto& [other_id, other] : clients_) {
    if (other_id == id || !other.claim || !overlap(other.access, access)) continue;
    end_claim(other_id, other, "another client has taken over");
    transport_->close_client(other_id, "another client has taken over");
  }
  return {};
}

void Hub::claim(ClientId id, const ClaimRequest& request, Claimed claimed) {
  Client& client = clients_.at(id);
  const auto fail = [&](Error error) {
    ++counts_.refused;
    roster_.refused(id);
    claimed(*client.face, std::move(error));
  };
  if (client.budget < requests_per_claim - 1) return fail({"too many claims in a second"});
  client.budget -= requests_per_claim - 1;
  if (client.claim) {  // the same in another way
    const std::string& name = request.robot.empty() ? request.team : request.robot;
    const Role role = request.robot.empty() ? Role::team : Role::robot;
    if (client.access.name != name || client.access.role != role)
      return fail({"this connection drives '" + client.access.name + "' already"});
    const std::string token = client.claim->request.token;
    if (!token.empty() && !same_secret(request.token, token))
      return fail({"this is not the token of '" + name + "'"});
  }
  auto access = access_of_claim(id, request);
  if (!access) return fail(std::move(access.error()));
  if (Status free = make_room(id, *access, request.token); !free) return fail(std::move(free.error()));
  Access before = client.access;
  if (client.claim) {  // its subscriptions stay
    before = client.claim->before;
    let_go(id, client, "the client claims it in another way");
  }
  change_access(id, client, std::move(*access));
  client.claim.emplace();
  client.claim->number = ++claims_;
  client.claim->request = request;
  client.claim->before = before;
  client.claim->commanded = Clock::now();
  roster_.claimed(id, client.access, request.lockstep ? Mode::lockstep : Mode::free, request.deadline_s,
                  request.name);
  if (!request.lockstep) return claimed(*client.face, std::vector<ClaimedProgram>());
  attach(id, claimed);
}

/// What the client may not see or do any more is taken from it.
void Hub::change_access(ClientId id, Client& client, Access access) {
  client.access = std::move(access);
  transport_->change_access(id, client.access);
  revoke(id, client);
  client.publications.clear();
}

/// Finds the remote programs of the client's robots, behind what it has subscribed to until now.
void Hub::attach(ClientId id, const Claimed& claimed) {
  Client& client = clients_.at(id);
  for (const ProgramLink& each : client.claim->links)
    post([feed = feed_, link = each.link](Session&) { feed->remove_link(link); });
  client.claim->links.clear();
  flush(true);
  post([mailbox = mailbox_, id, number = client.claim->number, access = client.access,
        claimed](Session& session) {
    std::vector<ProgramLink> links;
    session.simulation().for_each_outside([&](const SimulationParts::ProgramEntry& entry, Outside& outside) {
      auto* const remote = dynamic_cast<programs::remote::Remote*>(&outside);
      const std::string_view whose = first_part(entry.path);
      if (!remote || !remote->spec().lockstep ||
          !(access.drives(whose) || (access.role == Role::team && whose == access.name)))
        return;
      links.push_back(
          {{entry.path, entry.description->control_period_s}, remote->link(), remote->spec().deadline_s});
    });
    mailbox->push([id, number, links = std::move(links), claimed](Hub& hub) {
      hub.hold_links(id, number, links, claimed);
    });
  });
}

void Hub::hold_links(ClientId id, std::uint64_t claim, std::vector<ProgramLink> links,
                     const Claimed& claimed) {
  Client* const client = find(id);
  if (!client || !client->claim || client->claim->number != claim) return;
  if (links.empty()) {
    const std::string name = client->access.name;
    end_claim(id, *client, "it has no remote program");
    if (claimed)
      claimed(
          *client->face,
          Error{"'" + name + "' has no program of kind remote that could wait for a client",
                "give it controller: remote in the scenario, without lockstep: false, or drive it freely"});
    return;
  }
  client->claim->links = std::move(links);
  std::vector<ClaimedProgram> told;
  for (const ProgramLink& each : client->claim->links) told.push_back(each.program);
  if (claimed) claimed(*client->face, std::move(told));
  for (const ProgramLink& each : client->claim->links) {
    post([feed = feed_, mailbox = mailbox_, id, claim, path = each.program.path, link = each.link,
          deadline_s = client->claim->request.deadline_s,
          counts = roster_.answers_for(id, each.program.path, each.program.control_period_s,
                                       each.longest_deadline_s)](Session&) {
      feed->add_link(link);
      link->attach({deadline_s,
                    [mailbox, id, path](const programs::remote::Link::Step& step) {
                      mailbox->push([id, notice = StepNotice{path, step.number, step.now, step.random}](
                                        Hub& hub) { hub.tell_step(id, notice); });
                    },
                    [mailbox, id](const std::string& why) {
                      mailbox->push([id, why](Hub& hub) { hub.report_refusal(id, why); });
                    },
                    counts, claim});
    });
  }
  session_.wake();
}

void Hub::tell_step(ClientId id, const StepNotice& step) {
  Client* const client = find(id);
  if (!client || !client->claim) return;
  client->claim->orders[step.program].clear();
  // It was asked: the run, not the clock, bounds how much it says.
  client->budget = std::min(most_requests_per_s, client->budget + messages_per_step);
  transport_->grant(id, messages_per_step);
  client->face->tell_step(step);
  roster_.told(id, step.program, Clock::now());
}

/// Keeps a command for the end of the step. @return false: it is not for a program in lockstep
bool Hub::collect(ClientId id, Client& client, const Publication& publication,
                  std::span<const std::byte> command) {
  const std::string_view address = publication.target.address;
  for (const ProgramLink& each : client.claim->links) {
    const bool of_team = first_part(each.program.path) == client.access.name &&
                         client.access.role == Role::team;
    if (!of_team && first_part(each.program.path) != first_part(address)) continue;
    // A robot's program knows its devices by their own names, a team's by the robot's name in front.
    const std::string_view name = of_team ? address : address.substr(first_part(address).size() + 1);
    constexpr std::size_t most_bytes = std::size_t{1} << 19;
    std::string& orders = client.claim->orders[each.program.path];
    if (orders.size() > most_bytes) {
      refuse(id, "more than 512 KiB of commands in one step");
      return true;
    }
    const auto form = publication.target.slot->blank->clone();
    std::vector<std::byte> cdr;
    std::string json;
    if (!form->assign(command)) return true;
    form->to_cdr(cdr);
    if (!cdr_to_json(form->info(), cdr, json)) return true;
    if (!orders.empty()) orders += ',';
    JsonWriter w(orders);
    w.list([&] {
      w.text(name);
      w.raw(json);
      w.text(publication.target.slot->info->name);
    });
    return true;
  }
  return false;
}

Status Hub::done(ClientId id, std::uint64_t step, const std::string& program, const std::string& orders,
                 const std::string& samples) {
  Client& client = clients_.at(id);
  if (!client.claim || client.claim->links.empty())
    return Error{"this connection drives nothing in lockstep"};
  const ProgramLink* link = nullptr;
  for (const ProgramLink& each : client.claim->links)
    if (program.empty() || each.program.path == program) {
      if (link) return Error{"this connection answers for several programs: name one with 'program'"};
      link = &each;
    }
  if (!link) return Error{"this connection does not answer for '" + program.substr(0, 100) + "'"};
  std::string answer = "{";
  std::string& published = client.claim->orders[link->program.path];
  if (!published.empty() && !orders.empty())
    return Error{"orders are either published or part of the answer"};
  if (!published.empty()) answer += "\"orders\":[" + published + "]";
  else if (!orders.empty()) answer += "\"orders\":" + orders;
  published.clear();
  if (!samples.empty()) answer += std::string(answer.size() > 1 ? "," : "") + "\"samples\":" + samples;
  answer += "}";
  SL_TRY(link->link->answer(step, std::move(answer)));
  roster_.answered(id, link->program.path, Clock::now());
  session_.wake();
  return {};
}

void Hub::release(ClientId id) { end_claim(id, clients_.at(id), "the client let go of it"); }

/// What it drove stands still, and is free for others.
void Hub::end_claim(ClientId id, Client& client, const std::string& why) {
  if (!client.claim) return;
  Access before = client.claim->before;
  let_go(id, client, why);
  change_access(id, client, std::move(before));
  roster_.released(id, client.access);
}

void Hub::let_go(ClientId id, Client& client, const std::string& why) {
  for (const ProgramLink& each : client.claim->links) {
    each.link->detach(client.claim->number, why);
    post([feed = feed_, link = each.link](Session&) { feed->remove_link(link); });
  }
  if (!client.claim->request.lockstep) stop_robots(id, client);
  client.claim.reset();
  session_.wake();
}

/// Orders all drives of the client's robots to stand still.
void Hub::stop_robots(ClientId id, Client& client) {
  if (!std::exchange(client.claim->moving, false)) return;
  for (const Inventory::Slot& slot : inventory_->slots) {
    if (slot.of_program || !slot.active || !client.access.may_command(slot.device)) continue;
    if (auto still = standstill(slot.info->name))
      (void)session_.submit(CommandRequest{slot.device, slot.info->name, std::move(*still)},
                            {Source::Kind::robot, id});
  }
}

/// Stops the robots of clients that have been silent for long.
void Hub::watch_claims() {
  const auto limit = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(options_.watchdog_s));
  const auto now = Clock::now();
  for (auto& [id, client] : clients_)
    if (client.claim && !client.claim->request.lockstep && client.claim->moving &&
        now > client.claim->commanded + limit && report_.state == Session::State::playing) {
      stop_robots(id, client);
      roster_.stopped(id);
      client.face->report(foxglove::Level::warning,
                          "no command for long: '" + client.access.name + "' was stopped", {});
    }
}

}  // namespace sandlot::server
