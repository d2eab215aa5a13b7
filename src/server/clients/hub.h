#pragma once
/// Hub: what all clients of a server share, whatever they speak: channels, subscriptions, services, parameters, publishing,
/// rights, sessions of those who drive robots. A protocol is a face (server/clients/face.h).
/// long file: one class whose functions are in five sources by concept; what clients share is one state.
///
/// Threads   the transport's, for everything. The run is reached through Session's orders, submit() and post(); answers come
///           back by the Mailbox.
/// Limits    of docs/viewer_protocol.md; what goes beyond is refused with a status of level 2 and counted.
#include <array>
#include <atomic>
#include <chrono>
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "messages/tf2_msgs.h"
#include "server/clients/claim.h"
#include "server/clients/face.h"
#include "server/clients/feed.h"
#include "server/clients/roster.h"
#include "server/server.h"
#include "server/services/service.h"
#include "wire/foxglove.h"
#include "wire/scene.h"

namespace sandlot::server {

inline constexpr std::size_t most_subscriptions = 10'000, most_publications = 1000, most_calls = 100,
                             most_watched = 200, most_watched_by_all = 2000;
inline constexpr double most_requests_per_s = 500;

class Hub final : private ServiceHost {
 public:
  Hub(Session& session, Console& console, const ServerOptions& options, std::shared_ptr<Mailbox> mailbox,
      std::shared_ptr<Feed> feed, wire::Assets assets);
  /// Before anything else is called.
  void use(Transport& transport) { transport_ = &transport; }
  /// @param processes  of programs that the server has started; null: none
  void use(Processes* processes) { processes_ = processes; }

  // --- called by the transport ---
  using MakeFace = std::function<std::unique_ptr<Face>(Hub&, Transport&, ClientId)>;
  void connected(ClientId id, Access access, Protocol protocol, const MakeFace& make_face);
  void message(ClientId id, std::span<const std::byte> bytes, bool text);
  void disconnected(ClientId id);
  void timer();
  /// Sends what lies in the mailbox.
  void drain();
  void state_changed();

  // --- called by faces ---
  const ServerOptions& options() const { return options_; }
  const std::string& session_id() const { return session_id_; }
  const wire::Assets& assets() const { return assets_; }
  const Session::Report& report() const { return report_; }
  /// Figures of the clients; on any thread.
  const Roster& roster() const { return roster_; }
  const Access& access(ClientId id) const;
  bool sees_world(ClientId id) const {
    const Client* const client = find(id);
    return client && sees_world(*client);
  }
  /// A refusal: told to the client, unless it has had many in this second, and counted.
  void refuse(ClientId id, const std::string& why, std::string_view about = {});
  /// The public channels that the client may see, in portions as its queue has room; it is told of others as they come.
  const ChannelInfo* find_channel(ClientId id, std::uint32_t number) const;
  const ChannelInfo* find_channel(ClientId id, std::string_view topic) const;
  std::vector<const ChannelInfo*> channels(ClientId id) const;
  /// @param subscription  the face's own number for it
  Status subscribe(ClientId id, std::uint32_t subscription, std::uint32_t channel);
  Status unsubscribe(ClientId id, std::uint32_t subscription);

  /// What a client publishes on, once it has been judged.
  struct Publication {
    std::string topic, type;
    std::shared_ptr<const Inventory> world;  ///< that `target` is of
    Inventory::Target target;
  };
  enum class Encoding : std::uint8_t { cdr, json };
  /// Whether the client may publish there; a world that is not known yet is judged with the first message.
  Status judge(ClientId id, const Publication& publication) const;
  Result<Inventory::Target> find_target(ClientId id, const Publication& publication) const;
  void advertise(ClientId id, std::uint32_t number, Publication publication);
  bool unadvertise(ClientId id, std::uint32_t number);
  Publication* find_publication(ClientId id, std::uint32_t number);
  void publish(ClientId id, Publication& publication, std::span<const std::byte> bytes, Encoding encoding);
  /// @param read  the bytes of the command for a slot
  using ReadCommand = std::function<Result<std::vector<std::byte>>(const TopicBase& slot)>;
  void publish(ClientId id, Publication& publication, const ReadCommand& read);

  std::vector<const ServiceOffer*> offered_services(ClientId id) const;
  const ServiceOffer* find_service(ClientId id, std::uint32_t number) const;
  const ServiceOffer* find_service(ClientId id, std::string_view name) const;
  /// @param answer  called once on the transport's thread, if the client is still there
  using Answer = std::function<void(Face&, const ServiceCall::Outcome&)>;
  void call(ClientId id, const ServiceOffer& service, const AnyMessage& request, Answer answer);

  /// @return false: refused at once
  bool get_parameters(ClientId id, const std::vector<std::string>& names, const std::string& about);
  bool set_parameters(ClientId id, const std::vector<foxglove::Parameter>& parameters,
                      const std::string& about);
  /// @param names  empty: all
  Status subscribe_parameters(ClientId id, const std::vector<std::string>& names, bool subscribe);
  void subscribe_graph(ClientId id, bool subscribe);
  foxglove::Graph graph() const;

  // --- sessions of clients that drive robots; hub_sessions.cpp ---
  /// Makes the client the one that drives a robot or a team; from now on it sees and does no more than that.
  /// @param claimed  called on the transport's thread, with the remote programs that it answers for in lockstep
  using Claimed = std::function<void(Face&, const Result<std::vector<ClaimedProgram>>&)>;
  void claim(ClientId id, const ClaimRequest& request, Claimed claimed);
  void release(ClientId id);
  /// Ends a step of a client in lockstep. @param orders, samples  JSON of programs/answer.h; "": none
  Status done(ClientId id, std::uint64_t step, const std::string& program, const std::string& orders,
              const std::string& samples);

  // --- called by tasks in the mailbox ---
  void hold_links(ClientId id, std::uint64_t claim, std::vector<ProgramLink> links, const Claimed& claimed);
  void tell_step(ClientId id, const StepNotice& step);
  void send_world(const WorldUpdate& update);
  /// The latest messages to those who have just subscribed; from now on they get what comes.
  void send_latest(std::span<const ChannelMessage> latest, std::span<const std::uint32_t> channels);
  void send_parameters(std::span<const foxglove::Parameter> changed);
  void answer(ClientId client, const std::function<void(Face&)>& tell);
  void answer_parameters(ClientId client, const std::string& id, std::span<const foxglove::Parameter> values,
                         std::span<const std::string> errors);
  void report_refusal(ClientId client, const std::string& why);
  /// A line for /rosout; levels of rcl_interfaces/msg/Log. Who subscribes later has the latest 200, too: what a program prints when it
  /// begins is mostly over before somebody looks.
  void send_log(std::uint8_t level, const std::string& text);
  /// Who is connected, to those who may see it.
  void send_clients(std::vector<OutsideProgram> programs);

  struct Counts {
    std::atomic<std::uint64_t> refused = 0, dropped = 0;
    std::atomic<std::uint64_t> too_long = 0;  ///< dropped, as they fit no datagram
  };
  const Counts& counts() const { return counts_; }
  void count_refused() { ++counts_.refused; }
  void count_dropped() { ++counts_.too_long; }

 private:
  using Clock = std::chrono::steady_clock;
  enum class ChannelKind : std::uint8_t {
    device,
    transforms,
    transforms_static,
    clock,
    step_times,
    log,
    world,
    poses,
    status,
    commands,
    contacts,
    deliveries,
    batteries,
    clients,
    watch,
    count_
  };
  struct Subscriber {
    ClientId client = 0;
    std::uint32_t id = 0;
    bool initial_state_sent = false;  ///< it has had what it gets at once; until then it gets nothing else
  };
  struct Channel {
    ChannelKind kind = ChannelKind::device;
    ChannelInfo info;
    ClientId owner = 0;  ///< of a watch; 0: everybody may subscribe
    std::size_t numbers = 0;
    Clock::time_point unused_since;  ///< of a watch without its subscriber
    std::vector<Subscriber> subscribers;
  };
  struct Client {
    Access access;
    std::unique_ptr<Face> face;
    std::unordered_map<std::uint32_t, std::uint32_t> subscriptions;  ///< id: channel
    std::map<std::uint32_t, Publication> publications;
    std::set<std::string> parameters;
    bool all_parameters = false, graph = false;
    std::size_t calls = 0, watched = 0;
    std::uint32_t advertised_below = 0;  ///< it knows the public ones below this number
    double budget = most_requests_per_s;
    Clock::time_point budgeted;
    std::optional<Claim> claim;
    int wrong_tokens = 0;
    std::uint64_t refusals_unsent = 0;  ///< errors of this second that were not sent
    int errors = 0;
    Clock::time_point refusals_since;
  };
  struct Waiting {  ///< a call that ends when the run has got somewhere
    /// The outcome, once there is one.
    std::function<std::optional<Status>(const Session::Report&)> reached;
    std::function<void(const Status&)> done;
    std::uint64_t tick = 0;  ///< of the run at `since`
    Clock::time_point since;
  };
  // hub.cpp
  std::uint32_t add_channel(ChannelKind kind, const char* topic, const char* encoding, const char* schema);
  Channel& channel(ChannelKind kind) { return channels_.at(fixed_[static_cast<std::size_t>(kind)]); }
  bool subscribed(ChannelKind kind) { return !channel(kind).subscribers.empty(); }
  Client* find(ClientId id);
  bool within_budget(ClientId id, Client& client);
  const Client* find(ClientId id) const;
  bool may_see(const Client& client, ClientId id, const Channel& channel) const;
  bool sees_world(const Client& client) const {
    return server::sees_world(client.access, inventory_->sharing);
  }
  void revoke(ClientId id, Client& client);
  void leave_channel(ClientId id, std::uint32_t channel_id, std::uint32_t subscription);
  void remove_channel(std::uint32_t id);
  void advertise_waiting(ClientId id, Client& client);
  void flush(bool now = false);
  bool post(std::function<void(Session&)> task) override;
  void charge(ClientId id, double seconds);
  /// What is posted during its life is a client's work; 0: nobody's.
  class Charged {
   public:
    Charged(Hub& hub, ClientId id) : hub_(hub) { hub.calling_ = id; }
    ~Charged() { hub_.calling_ = 0; }
    Charged(const Charged&) = delete;

   private:
    Hub& hub_;
  };

  // hub_send.cpp
  bool send(const Subscriber& to, const Outgoing& message, bool droppable);
  void send_to_all(Channel& channel, Time stamp, const Payload& bytes, bool droppable = true);
  void send_time(Time now);
  void send_status(bool to_new_ones_only = false);
  void send_batch(Batch& batch);
  void send_poses(const Batch& batch);
  void adopt(const Inventory& inventory);

  // hub_services.cpp
  /// A row of the table, or, with the numbers behind those, a service of a device.
  struct OfferedService {
    ServiceOffer offer;
    const Service* row = nullptr;
    std::string device;
    const DeviceService* service = nullptr;
  };
  bool may_call(const Client& client, const OfferedService& service) const;
  void adopt_services(const Inventory& inventory);
  void call_device(ClientId id, const OfferedService& offered, const AnyMessage& request,
                   const std::shared_ptr<ServiceCall>& call);
  using WatchDone = std::function<void(const Result<std::string>&)>;
  Session& session() override { return session_; }
  Console& console() override { return console_; }
  Status restart_program(const std::string& program) override;
  void wait(std::function<std::optional<Status>(const Session::Report&)> reached,
            std::function<void(const Status&)> done) override;
  void watch(ClientId id, const std::vector<std::string>& values, double rate_hz, WatchDone done) override;
  void decisions(const std::string& topic,
                 std::function<void(std::vector<msg::RefereeDecision>)> done) override;
  void match_track(std::function<void(const msg::MatchTrack::Response&)> done) override;
  Memory& memory() override { return memory_; }
  std::function<void(std::function<void()>)> way_back() override;
  void open_watch(ClientId id, std::uint32_t channel_id, std::size_t values, const Status& status,
                  const WatchDone& done);
  void end_waiting();

  // hub_sessions.cpp
  void change_access(ClientId id, Client& client, Access access);
  Result<Access> access_of_claim(ClientId id, const ClaimRequest& request);
  Status make_room(ClientId id, const Access& access, const std::string& token);
  void attach(ClientId id, const Claimed& claimed);
  void let_go(ClientId id, Client& client, const std::string& why);
  void end_claim(ClientId id, Client& client, const std::string& why);
  void stop_robots(ClientId id, Client& client);
  void watch_claims();
  bool collect(ClientId id, Client& client, const Publication& publication,
               std::span<const std::byte> command);

  // hub_clients.cpp
  void watch_clients();
  Status disconnect(ClientId client) override;

  // hub_publish.cpp
  foxglove::Parameter own_parameter(const std::string& name) const;
  void send_own_parameters();
  void send_graph(ClientId new_looker = 0);

  Session& session_;
  Console& console_;
  const ServerOptions options_;
  const std::shared_ptr<Mailbox> mailbox_;
  const std::shared_ptr<Feed> feed_;
  const wire::Assets assets_;
  Transport* transport_ = nullptr;
  Processes* processes_ = nullptr;
  std::string session_id_;

  std::map<std::uint32_t, Channel> channels_;
  std::array<std::uint32_t, static_cast<std::size_t>(ChannelKind::count_)> fixed_{};
  std::map<std::pair<std::string, std::string>, std::uint32_t> devices_;  ///< channels by topic and type
  std::uint32_t next_channel_ = 1;
  std::map<std::uint32_t, OfferedService> services_;
  std::uint32_t next_service_ = 1;
  std::map<ClientId, Client> clients_;
  std::uint64_t claims_ = 0;
  std::size_t watched_ = 0;
  ClientId calling_ = 0;  ///< whose request makes work for the simulation's thread just now

  Session::Report report_;
  std::shared_ptr<const Inventory> inventory_ = std::make_shared<Inventory>();
  std::deque<QueuedItem> items_;
  std::vector<Waiting> waiting_;
  Memory memory_;
  wire::PoseWriter poses_;
  std::uint64_t poses_epoch_ = 0;
  msg::TFMessage transforms_;

  bool subscriptions_changed_ = false, looking_ = false, draining_ = false;
  InitialSend initial_;
  Payload world_, transforms_static_;  ///< as last sent
  Time now_;                           ///< of the latest batch
  foxglove::Graph graph_;
  bool graph_changed_ = false;
  Clock::time_point flushed_, status_sent_, time_sent_, framed_, looked_, graph_sent_;
  Counts counts_;
  std::deque<std::pair<Time, Payload>> log_lines_;
  Roster roster_;
  Clock::time_point clients_measured_, clients_asked_;
};

}  // namespace sandlot::server
