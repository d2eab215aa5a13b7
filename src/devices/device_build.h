#pragma once
/// Inputs of a device's construction, and the topics and frames it makes.
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "base/bytes.h"
#include "base/check.h"
#include "base/result.h"
#include "base/time.h"
#include "devices/energy.h"
#include "devices/scene_light.h"
#include "media/inbox.h"
#include "messages/command_queue.h"
#include "messages/topic.h"
#include "model/model.h"
#include "physics/engine.h"

namespace sandlot {

/// One level of abstraction of a kind. The first level of a kind is its default.
struct LevelInfo {
  const char* name;     ///< "ranges"
  const char* message;  ///< ROS type published on <device>/<level>, or ""
  const char* command;  ///< ROS type accepted on <device>/<level>/command, or ""
  const char* help;
};

/// Ready-made keys of a kind under a name, mostly a product's: `preset: sick_lms200`. The user's own keys
/// take precedence.
struct Preset {
  const char* name;  ///< "sick_lms200"
  const char* help;  ///< one sentence, with the source of the numbers
  const char* keys;  ///< a map in YAML
};

/// Destination of a device's orders; the simulation gives it.
class OrderSink {
 public:
  virtual ~OrderSink() = default;
  /// Takes a command as if a program had given it. @return false: the device has failed, takes no more now, or is under manual
  /// override
  virtual bool take(std::span<const std::byte> message, Time now) = 0;
  /// The latest command that the device took, from anyone; null: it takes none now, because it has failed.
  virtual const TopicBase* latest(Time now) const = 0;
};

/// Orders of one device to another of its robot, such as a pan-tilt unit's to the zoom of its camera: declared while the
/// first one is built (DeviceBuild::order), checked and connected when the robot is complete. The other device is not
/// unloaded meanwhile.
class DeviceOrder {
 public:
  DeviceOrder(std::string device, std::string slot, const char* type, Place place, std::string key)
      : device_(std::move(device)),
        slot_(std::move(slot)),
        type_(type),
        place_(std::move(place)),
        key_(std::move(key)) {}
  const std::string& device() const { return device_; }  ///< "robot1/eye"
  const std::string& slot() const { return slot_; }      ///< "/robot1/eye/zoom/command"
  const char* type() const { return type_; }
  /// Place and key at which the other device was named.
  const Place& place() const { return place_; }
  const std::string& key() const { return key_; }

  /// @return false: refused; the simulation counts it
  template <class M>
  bool give(const M& message, Time now) {
    SL_CHECK(std::string_view(type_) == M::ros_type);
    bytes_.clear();
    write(bytes_, message);
    return sink_ && sink_->take(bytes_.bytes(), now);
  }
  const TopicBase* latest(Time now) const { return sink_ ? sink_->latest(now) : nullptr; }
  void connect(std::unique_ptr<OrderSink> sink) { sink_ = std::move(sink); }

 private:
  std::string device_, slot_;
  const char* type_;
  Place place_;
  std::string key_;
  std::unique_ptr<OrderSink> sink_;
  ByteWriter bytes_;
};

/// Level of the topics and command slots that a device has at every level and that are State only once they have held a
/// message.
inline constexpr std::uint32_t late_level = ~0u;

/// Creates topics and command slots while a device is built; they live as long as the device.
class TopicMaker {
 public:
  virtual ~TopicMaker() = default;
  virtual void adopt_topic(std::unique_ptr<TopicBase> topic, std::uint32_t level) = 0;
  virtual void adopt_command(std::unique_ptr<TopicBase> slot, std::uint32_t level) = 0;
  virtual void adopt_frame(std::string, const Pose&) {}
  virtual void adopt_order(std::unique_ptr<DeviceOrder> order) = 0;
  virtual void adopt_inbox(std::unique_ptr<Inbox> inbox) = 0;
  virtual void adopt_light(std::unique_ptr<SceneLight> light) = 0;
};

/// Pixels (rows from the top, 1 or 3 channels) as a file's bytes; given by sim, which knows the formats.
/// @param quality  of JPEG, 1 to 100; 0: PNG
using ImageEncoder = std::string (*)(int width, int height, int channels,
                                     std::span<const std::uint8_t> pixels, int quality);

/// Inputs of a device's construction.
struct DeviceBuild {
  const model::DeviceDecl& decl;
  const model::Instance& instance;
  std::string path;       ///< "robot1/laser"
  std::uint64_t key = 0;  ///< entity_key(path), for Stream
  std::uint64_t seed = 0;
  std::span<const BodyId> bodies;  ///< one per link of the instance's model
  std::span<const JointId> joints;
  Capabilities engine;
  Time tick;                 ///< length of a tick
  std::uint32_t levels = 1;  ///< bit i: level i is active
  TopicMaker& topics;
  Vec3 gravity_mps2{0, 0, -9.81};
  std::optional<model::Geography> geography = {};  ///< where the world lies on the Earth, if a file gives it
  Vec3 magnetic_field_T{};                         ///< of the Earth, in W
  double errors = 1;                               ///< factor on the errors, in addition to the device's own
  ImageEncoder encode_image = nullptr;             ///< null in tests of kinds alone
  std::span<const model::ElementDecl> media = {};  ///< of the world
  EnergyMeter* energy = nullptr;                   ///< null: the robot has no battery
  EnergyAccount* account = nullptr;  ///< of the robot, for its battery; null for all other kinds

  BodyId body() const { return bodies[decl.link]; }
  /// Frame of the sensor in messages: "robot1/laser".
  const std::string& frame_id() const { return path; }

  /// One more frame of the sensor, such as "optical", for /tf. @return its name: "robot1/camera_optical"
  std::string frame(const char* name, const Pose& X_SF) const {
    std::string full = path + "_" + name;
    topics.adopt_frame(full, X_SF);
    return full;
  }

  /// The topic of a level, `/robot1/laser/<level>`; the first level's is also what `/robot1/laser` names.
  template <class M>
  Topic<M>* publish(std::uint32_t level, const char* level_name) const {
    auto made = std::make_unique<Topic<M>>("/" + path + "/" + level_name);
    Topic<M>* const topic = made.get();
    topics.adopt_topic(std::move(made), level);
    return topic;
  }
  /// The command slot of a level, `/robot1/drive/<level>/command`.
  template <class M>
  Topic<M>* accept(std::uint32_t level, const char* level_name) const {
    auto made = std::make_unique<Topic<M>>("/" + path + "/" + level_name + "/command");
    Topic<M>* const slot = made.get();
    topics.adopt_command(std::move(made), level);
    return slot;
  }
  /// A command slot that keeps up to `limit` orders until the device takes them, first in, first out.
  template <class M>
  CommandQueue<M>* accept_queue(std::uint32_t level, const char* level_name, std::size_t limit) const {
    auto made = std::make_unique<CommandQueue<M>>("/" + path + "/" + level_name + "/command", limit);
    CommandQueue<M>* const queue = made.get();
    topics.adopt_command(std::move(made), level);
    return queue;
  }
  /// Declares that this device gives orders to another device of its robot. Valid as long as this device.
  /// @param device    its path, "robot1/eye"
  /// @param part      its slot: "zoom" of <device>/zoom/command
  /// @param spec_key  key that names the device, for errors
  template <class M>
  DeviceOrder* order(const std::string& device, const char* part, const char* spec_key) const {
    const Node* const node = decl.config.find(spec_key);
    auto made = std::make_unique<DeviceOrder>(device, "/" + device + "/" + part + "/command", M::ros_type,
                                              node && node->place().file ? node->place() : decl.place,
                                              std::string("/") + spec_key);
    DeviceOrder* const order = made.get();
    topics.adopt_order(std::move(made));
    return order;
  }
  /// Index of a medium for Emission::medium: that of this name and kind, or "": the only one of the kind. Errors name what
  /// there is.
  Result<std::uint32_t> medium(std::string_view name, const char* kind, const char* spec_key) const;
  /// The inbox of the device, for deliveries of a medium; it lives as long as the device. Once per device.
  /// @param limit  number of deliveries that it holds until the device senses
  Inbox* receive(std::uint32_t medium, std::size_t limit) const {
    auto made = std::make_unique<Inbox>(medium, limit);
    Inbox* const inbox = made.get();
    topics.adopt_inbox(std::move(made));
    return inbox;
  }
  /// A light of the scene on the device's link, off until it is set; it lives as long as the device. Once per device.
  SceneLight* shine(model::Light light) const {
    auto made = std::make_unique<SceneLight>(decl.link, std::move(light));
    SceneLight* const shining = made.get();
    topics.adopt_light(std::move(made));
    return shining;
  }
  /// Error about a key of the spec: at the key's place in its file, or at the device's where the key is not
  /// written.
  Error error(const char* spec_key, std::string what, std::string fix) const;
  /// The joint a spec names, or an error with the nearest name.
  Result<JointId> joint(std::string_view name, const char* spec_key) const;
  /// As above, and its place in the model.
  Result<std::uint32_t> joint_index(std::string_view name, const char* spec_key) const;
};

}  // namespace sandlot
