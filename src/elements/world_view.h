#pragma once
/// World view: the true state of the world as rules and media read it. It changes nothing.
///
/// Names are looked up when they are needed, since entities come and go; a pointer from here holds for one phase of one tick.
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "base/result.h"
#include "base/time.h"
#include "messages/command_queue.h"
#include "model/model.h"
#include "physics/engine.h"

namespace sandlot {

class Marker;  // markers/marker.h

/// Limit of coordinates in the keys of elements.
inline constexpr double max_distance_m = 1e6;

/// An entity: a robot or an object.
struct EntityView {
  const model::Instance* instance = nullptr;
  InstanceId id;
  std::uint64_t serial = 0;  ///< creation order over the whole run: nothing else ever has it
};

/// The battery of a robot.
struct BatteryView {
  double energy_J = 0, fraction = 0;  ///< left; the charge as a share of the whole
  bool empty = false;
};

class WorldView {
 public:
  virtual ~WorldView() = default;
  virtual const Engine& engine() const = 0;
  /// All entities in creation order.
  virtual std::span<const EntityView> entities() const = 0;
  /// Null: there is none of that name now.
  virtual const EntityView* find_entity(std::string_view name) const = 0;
  virtual const Marker* find_marker(std::string_view name) const = 0;
  /// Paths of the devices of an entity that take commands: "robot1/drive".
  virtual std::vector<std::string> actuators(const EntityView& entity) const = 0;
  /// Nothing: it has no battery.
  virtual std::optional<BatteryView> battery(const EntityView&) const { return std::nullopt; }
  /// Present value of a property that the scenario gives an entity. Nothing: it has none of that name.
  static std::optional<double> property(const EntityView& entity, std::string_view name) {
    const model::PropertyDecl* const found = entity.instance->find_property(name);
    return found ? std::optional(found->value) : std::nullopt;
  }
  /// "/robot1/laser/ranges", or "robot1/laser" for a device's first topic; null: there is none.
  virtual const TopicBase* find_topic(std::string_view name) const = 0;
  /// The present value of an expression that was compiled for an element while it was built (ElementBuild::watch). Nothing:
  /// one of its addresses has no value now.
  virtual std::optional<double> value(std::uint32_t watched) const = 0;

  Pose pose(const EntityView& entity) const { return engine().pose(entity.id); }
  /// Of the canonical link, in W.
  const Velocity& velocity(const EntityView& entity) const {
    return engine().states()[engine().bodies(entity.id).front().index].V_WB;
  }
};

/// Inputs of an element's construction.
class ElementBuild {
 public:
  /// @param path  "rules/referee"
  ElementBuild(const model::ElementDecl& declared, std::string its_path, const WorldView& view)
      : decl(declared), world(view), own_path(std::move(its_path)) {}
  virtual ~ElementBuild() = default;
  const model::ElementDecl& decl;
  const WorldView& world;
  std::string own_path;  ///< of the element

  /// A topic of a rule, `/rules/referee/<name>`; it lives as long as the rule, and is part of its State.
  template <class M>
  Topic<M>* publish(const char* name) const {
    auto made = std::make_unique<Topic<M>>("/" + own_path + "/" + name);
    Topic<M>* const topic = made.get();
    made_.topics.push_back(std::move(made));
    return topic;
  }
  /// Orders to a rule, `/rules/referee/<name>/command`: a command slot that keeps several of them.
  template <class M>
  CommandQueue<M>* accept_queue(const char* name, std::size_t limit) const {
    auto made = std::make_unique<CommandQueue<M>>("/" + own_path + "/" + name + "/command", limit);
    CommandQueue<M>* const slot = made.get();
    made_.commands.push_back(std::move(made));
    return slot;
  }
  /// What the element has made of these.
  struct Made {
    std::vector<std::unique_ptr<TopicBase>> topics, commands;
  };
  Made take_made() const { return std::move(made_); }

  /// Errors name the nearest entity. An entity may be gone when a world is restored: then there is none.
  virtual Status expect_entity(std::string_view name, const char* key) const = 0;
  virtual Status expect_marker(std::string_view name, const char* key) const = 0;
  /// Some robot or object has a property of that name.
  virtual Status expect_property(std::string_view name, const char* key) const = 0;
  /// Compiles an expression over the world's values (docs/values.md), for WorldView::value.
  virtual Result<std::uint32_t> watch(std::string_view expression, const char* key) const = 0;
  /// The parts of a parameter's address, "red1/drive.failure", for a ParameterRequest. Errors: there is no such parameter, or it
  /// does not take the value.
  /// @param value  "": not known yet
  struct ParameterName {
    std::string target, field;
  };
  virtual Result<ParameterName> expect_parameter(std::string_view address, const std::string& value,
                                                 const char* key) const = 0;
  /// Error about a key of the spec, at the key's place in its file.
  Error error(const char* key, std::string what, std::string fix) const {
    const Node* const node = decl.config.find(key);
    return {std::move(what), std::move(fix), node && node->place().file ? node->place() : decl.place,
            std::string("/") + key};
  }

 private:
  mutable Made made_;
};

/// Two bodies that touched in a sub-step of the tick.
struct BodyTouch {
  BodyId a, b;        ///< a created before b
  Vec3 point_W;       ///< [m]
  Vec3 normal_W;      ///< unit, from a towards b
  Vec3 impulse_W_Ns;  ///< on b during the sub-step, friction included; zero unless a rule asks for impulses
  std::uint32_t substep = 0;
};

}  // namespace sandlot
