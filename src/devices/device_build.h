#pragma once
/// Inputs of a device's construction, and the topics and frames it makes.
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "base/result.h"
#include "base/time.h"
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

/// Creates topics and command slots while a device is built; they live as long as the device.
class TopicMaker {
 public:
  virtual ~TopicMaker() = default;
  virtual void adopt_topic(std::unique_ptr<TopicBase> topic, std::uint32_t level) = 0;
  virtual void adopt_command(std::unique_ptr<TopicBase> slot, std::uint32_t level) = 0;
  virtual void adopt_frame(std::string, const Pose&) {}
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
  /// Error about a key of the spec: at the key's place in its file, or at the device's where the key is not
  /// written.
  Error error(const char* spec_key, std::string what, std::string fix) const;
  /// The joint a spec names, or an error with the nearest name.
  Result<JointId> joint(std::string_view name, const char* spec_key) const;
  /// As above, and its place in the model.
  Result<std::uint32_t> joint_index(std::string_view name, const char* spec_key) const;
};

}  // namespace sandlot
