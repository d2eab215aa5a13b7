#pragma once
/// What viewers say and are told: channels, subscriptions, services, parameters, publishing. docs/viewer_protocol.md.
///
/// Threads   the transport's, for everything. The run is reached through Session's orders, submit() and post(); what comes
///           back lies in the Mailbox.
/// Limits    of docs/viewer_protocol.md; what goes beyond is refused with a status of level 2 and counted.
#include <array>
#include <atomic>
#include <chrono>
#include <map>
#include <set>
#include <string>
#include <unordered_map>
#include <vector>

#include "console/console.h"
#include "messages/tf2_msgs.h"
#include "server/clients/call.h"
#include "server/clients/feed.h"
#include "server/server.h"
#include "wire/foxglove.h"
#include "wire/scene.h"

namespace sandlot::server {

inline constexpr std::size_t most_subscriptions = 10'000, most_publications = 1000, most_calls = 100,
                             most_watched = 200, most_watched_by_all = 2000;
inline constexpr double most_requests_per_s = 500;

class Hub {
 public:
  Hub(Session& session, Console& console, const ServerOptions& options, std::shared_ptr<Mailbox> mailbox,
      std::shared_ptr<Feed> feed, wire::Assets assets);
  /// Before anything else is called.
  void use(Transport& transport) { transport_ = &transport; }

  // --- what the transport hands over ---
  void connected(ClientId id, bool may_steer);
  void message(ClientId id, std::span<const std::byte> bytes, bool text);
  void disconnected(ClientId id);
  void timer();
  /// What the simulation's thread has mailed.
  void drain();
  void state_changed();

  // --- errands ---
  void tell(const Told& told);
  /// The latest messages to those who have just subscribed; from now on they get what comes.
  void tell_latest(std::span<const ChannelMessage> latest, std::span<const std::uint32_t> channels);
  void tell_parameters(std::span<const foxglove::Parameter> changed);
  void answer(ClientId client, const Payload& response, bool text);
  void answer_parameters(ClientId client, const std::string& id, std::span<const foxglove::Parameter> values,
                         std::span<const std::string> complaints);
  void answer_watch(ClientId client, std::uint32_t channel, std::size_t values, const Status& status,
                    const std::shared_ptr<Call>& call);
  void complain(ClientId client, const std::string& why);
  /// A line for /rosout; levels of rcl_interfaces/msg/Log.
  void send_log(std::uint8_t level, const std::string& text);

  struct Counts {
    std::atomic<std::uint64_t> refused = 0, dropped = 0;
    std::atomic<bool> log_read = false;  ///< somebody has subscribed to /rosout
  };
  const Counts& counts() const { return counts_; }

 private:
  using Clock = std::chrono::steady_clock;
  enum class What : std::uint8_t {
    device,
    transforms,
    transforms_static,
    clock,
    log,
    world,
    poses,
    status,
    commands,
    contacts,
    watch,
    count_
  };
  struct Subscriber {
    ClientId client = 0;
    std::uint32_t id = 0;
    bool primed = false;  ///< it has had what it gets at once; until then it gets nothing else
  };
  struct Channel {
    What what = What::device;
    foxglove::Channel said;
    ClientId owner = 0;  ///< of a watch; 0: everybody may subscribe
    std::size_t numbers = 0;
    Clock::time_point unused_since;  ///< of a watch without its subscriber
    std::vector<Subscriber> subscribers;
  };
  struct Publication {
    std::string topic, type;
    bool json = false;
    std::shared_ptr<const Inventory> world;  ///< that `target` is of
    Inventory::Target target;
  };
  struct Client {
    bool may_steer = false;
    std::unordered_map<std::uint32_t, std::uint32_t> subscriptions;  ///< id: channel
    std::map<std::uint32_t, Publication> publications;
    std::set<std::string> parameters;
    bool all_parameters = false, graph = false;
    std::size_t calls = 0, watched = 0;
    std::uint32_t told_channels = 0;  ///< it knows the public ones below this number
    double budget = most_requests_per_s;
    Clock::time_point budgeted;
    std::uint64_t kept_quiet = 0;  ///< complaints of this second that were not sent
    int complaints = 0;
    Clock::time_point complained;
  };
  struct Waiting {  ///< a call that ends when the run has got somewhere
    /// Whether it has, or why it never will; empty: not yet.
    std::function<std::optional<Status>(const Session::Report&)> there;
    std::function<void(const Status&)> end;
    std::uint64_t tick = 0;  ///< of the run at `since`
    Clock::time_point since;
  };
  struct Service {
    const char* name;
    const ServiceInfo* type;
    bool steers;
    void (Hub::*act)(ClientId, const std::shared_ptr<Call>&, const AnyMessage&);
  };

  // hub.cpp
  std::uint32_t add_channel(What what, const char* topic, const char* encoding, const char* schema);
  Channel& channel(What what) { return channels_.at(fixed_[static_cast<std::size_t>(what)]); }
  bool subscribed(What what) { return !channel(what).subscribers.empty(); }
  Client* find(ClientId id);
  bool may_ask(ClientId id, Client& client);
  bool refuse(ClientId id, const std::string& why, std::string_view about = {});
  void obey(ClientId id, Client& client, const foxglove::ClientMessage& message);
  void subscribe(ClientId id, Client& client, const foxglove::Subscribe& request);
  void unsubscribe(ClientId id, Client& client, std::uint32_t subscription);
  void leave_channel(ClientId id, std::uint32_t channel_id, std::uint32_t subscription);
  void remove_channel(std::uint32_t id);
  void advertise_waiting(ClientId id, Client& client);
  void fetch(ClientId id, const foxglove::FetchAsset& request);
  void flush();
  bool post(std::function<void(Session&)> task);

  // hub_send.cpp
  bool send(Subscriber& to, Time stamp, const Payload& bytes, bool droppable);
  void send_to_all(Channel& channel, Time stamp, const Payload& bytes, bool droppable = true);
  void send_time(Time now);
  void send_status();
  void send_batch(Batch& batch);
  void send_poses(const Batch& batch);
  void adopt(const Inventory& inventory);

  // hub_calls.cpp
  void add_services();
  void call(ClientId id, Client& client, const foxglove::CallService& request);
  void on_console(ClientId id, const std::shared_ptr<Call>& call, const AnyMessage& request);
  void on_complete(ClientId id, const std::shared_ptr<Call>& call, const AnyMessage& request);
  void on_watch(ClientId id, const std::shared_ptr<Call>& call, const AnyMessage& request);
  void on_features(ClientId id, const std::shared_ptr<Call>& call, const AnyMessage& request);
  void on_get_state(ClientId id, const std::shared_ptr<Call>& call, const AnyMessage& request);
  void on_set_state(ClientId id, const std::shared_ptr<Call>& call, const AnyMessage& request);
  void on_step(ClientId id, const std::shared_ptr<Call>& call, const AnyMessage& request);
  void on_reset(ClientId id, const std::shared_ptr<Call>& call, const AnyMessage& request);
  void on_entities(ClientId id, const std::shared_ptr<Call>& call, const AnyMessage& request);
  void on_get_entity(ClientId id, const std::shared_ptr<Call>& call, const AnyMessage& request);
  void on_set_entity(ClientId id, const std::shared_ptr<Call>& call, const AnyMessage& request);
  void on_delete_entity(ClientId id, const std::shared_ptr<Call>& call, const AnyMessage& request);
  void wait(std::function<std::optional<Status>(const Session::Report&)> there,
            std::function<void(const Status&)> end);
  void end_waiting();

  // hub_steer.cpp
  void get_parameters(ClientId id, Client& client, const foxglove::GetParameters& request);
  void set_parameters(ClientId id, Client& client, const foxglove::SetParameters& request);
  foxglove::Parameter own_parameter(const std::string& name) const;
  void tell_own_parameters();
  void advertise(ClientId id, Client& client, const foxglove::Advertise& request);
  void publish(ClientId id, Client& client, const foxglove::ClientData& data);
  void send_graph(bool to_everybody);
  foxglove::Graph graph() const;

  Session& session_;
  Console& console_;
  const ServerOptions options_;
  const std::shared_ptr<Mailbox> mailbox_;
  const std::shared_ptr<Feed> feed_;
  const wire::Assets assets_;
  Transport* transport_ = nullptr;
  std::string session_id_;

  std::map<std::uint32_t, Channel> channels_;
  std::array<std::uint32_t, static_cast<std::size_t>(What::count_)> fixed_{};
  std::map<std::pair<std::string, std::string>, std::uint32_t> devices_;  ///< channels by topic and type
  std::uint32_t next_channel_ = 1;
  std::vector<Service> services_;
  std::map<ClientId, Client> clients_;
  std::size_t watched_ = 0;

  Session::Report report_;
  std::shared_ptr<const Inventory> inventory_ = std::make_shared<Inventory>();
  std::deque<Mail> mail_;
  std::vector<Waiting> waiting_;
  wire::PoseWriter poses_;
  std::uint64_t poses_epoch_ = 0;
  msg::TFMessage transforms_;

  bool interest_changed_ = false, looking_ = false, draining_ = false;
  Demand demand_;
  Payload world_, transforms_static_;  ///< as told last
  Time now_;                           ///< of the latest batch
  foxglove::Graph graph_;
  bool graph_changed_ = false;
  Clock::time_point flushed_, status_sent_, time_sent_, framed_, looked_, graph_sent_;
  Counts counts_;
};

}  // namespace sandlot::server
