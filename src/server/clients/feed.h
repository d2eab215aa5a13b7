#pragma once
/// The server's observer of the run: takes out of each tick what somebody has subscribed to, and pushes it to the mailbox.
///
/// Threads   everything belongs to the simulation's thread (Session::post brings calls there), but stale().
/// Cost      without clients it observes nothing. Frames with links are requested `poses_hz` times a second of the wall
///           clock; messages are written once, only those with subscribers. Pictures: server/clients/preview.h.
#include <atomic>
#include <chrono>
#include <string>
#include <unordered_map>
#include <vector>

#include "server/clients/decision_log.h"
#include "server/clients/inventory.h"
#include "server/clients/mailbox.h"
#include "server/clients/match_track.h"
#include "server/clients/step_feed.h"
#include "server/http/transport.h"
#include "sim/session/session.h"
#include "sim/watch/values.h"
#include "wire/scene.h"

namespace sandlot::programs::remote {
class Link;
}

namespace sandlot::server {

/// Values that the expressions a viewer watches may read at each sample, those of aggregates counted.
inline constexpr std::size_t most_reads = 20'000;

/// What all clients together have subscribed to.
struct SubscriptionSummary {
  bool clients = false;  ///< there are clients
  bool frames = false, contacts = false, commands = false, parameters = false, world = false,
       transforms_static = false;
  std::uint32_t deliveries = 0, batteries = 0, step_times = 0;  ///< their channels; 0: nobody has subscribed
  std::vector<std::pair<std::uint32_t, std::string>> topics;    ///< channels of devices
};

/// What new subscribers get at once, whether it has changed or not.
struct InitialSend {
  bool frame = false, world = false, transforms_static = false;
  std::vector<std::uint32_t> latest;  ///< channels of device topics, watches and batteries
};

/// The world as it is now; parts without a subscriber, or without a change, are null.
struct WorldUpdate {
  std::shared_ptr<const Inventory> inventory;
  Payload world, transforms_static;
  Time now;
};

class Feed final : public Observer {
 public:
  Feed(Session& session, std::shared_ptr<Mailbox> mailbox, wire::Assets assets, double poses_hz);

  void set_subscriptions(std::shared_ptr<const SubscriptionSummary> summary);
  void send_initial(const InitialSend& initial);
  /// Ends it: the run is no longer observed.
  void detach();
  /// Viewers do not know the latest tick yet, and no frame is coming. From any thread.
  bool stale() const { return stale_; }

  /// @param viewer   whose aggregates go over at most most_reads values together
  /// @param channel  that the numbers go to. An error names the nearest address
  Status watch(ClientId viewer, std::uint32_t channel, const std::vector<std::string>& values,
               double rate_hz);
  void unwatch(std::uint32_t channel);

  DecisionLog& decisions() { return decisions_; }
  MatchTrack& match() { return match_; }

  /// A program whose client is told of each step behind the messages of its tick.
  void add_link(std::shared_ptr<programs::remote::Link> link);
  void remove_link(const std::shared_ptr<programs::remote::Link>& link);

  Wants wants() const override;
  void on_frame(const std::shared_ptr<const Frame>& frame) override;

 private:
  using Clock = std::chrono::steady_clock;
  struct SubscribedTopic {
    std::uint32_t channel = 0;
    const TopicBase* topic = nullptr;  ///< null: it is not there now
    std::uint64_t count = 0;           ///< of the message that was sent last
    bool preview = false;              ///< a small JPEG of the topic's image
    Clock::time_point next;            ///< previews: none before
    std::optional<double> look_hz;     ///< its device samples on request: at this rate it is looked through
    Time next_look;
  };
  struct Watch {
    ClientId viewer = 0;
    std::uint32_t channel = 0;
    std::size_t reads = 0;  ///< when it was compiled
    double rate_hz = 0;
    Time begin;
    std::int64_t sample = 0;
    std::optional<Time> sampled_at;  ///< time of its last sample in this world
    std::vector<std::string> texts;
    std::vector<std::vector<std::string>> addresses;
    std::vector<std::optional<ValueExpression>> values;
  };
  /// Follows the Session to another revision or world.
  void follow_session();
  void find_topics();
  void send_world_if_changed(bool again_world, bool again_static);
  /// @param seen  what the topic has: its message, or what was seen through its device
  ChannelMessage message(SubscribedTopic& topic, const TopicBase& seen) const;
  void look_through(SubscribedTopic& topic, Batch& batch) const;
  ChannelMessage sample(Watch& watch);
  void add_samples(Batch& batch);
  void note_deliveries(const Frame& frame);
  void add_deliveries(Batch& batch, std::uint64_t tick);
  /// Null: they are as they were sent.
  Payload changed_batteries();
  void send_parameters(const Frame& frame);

  Session& session_;
  const std::shared_ptr<Mailbox> mailbox_;
  wire::WorldJsonWriter world_writer_;
  const Clock::duration period_;
  bool watching_ = false;  ///< it is an observer
  std::shared_ptr<const SubscriptionSummary> subscribed_ = std::make_shared<SubscriptionSummary>();
  std::uint64_t epoch_ = 0, revision_ = 0;  ///< that it follows
  std::vector<SubscribedTopic> topics_;
  std::size_t previews_ = 0;  ///< of them
  std::vector<Watch> watches_;
  std::vector<std::shared_ptr<programs::remote::Link>> links_;
  StepFeed step_feed_;
  DecisionLog decisions_;
  MatchTrack match_;
  std::vector<std::byte> scratch_;
  std::vector<FrameDelivery> deliveries_;  ///< that were not sent yet
  Payload batteries_;                      ///< as last sent

  bool inventory_sent_ = false, world_sent_ = false, static_sent_ = false;  ///< in their present form
  Payload world_, transforms_static_;                                       ///< as last sent
  Clock::time_point next_world_update_, next_frame_, next_deliveries_, next_batteries_;
  mutable bool due_ = false;
  std::atomic<bool> stale_ = false;
};

}  // namespace sandlot::server
