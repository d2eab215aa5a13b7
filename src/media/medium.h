#pragma once
/// Medium: something that spreads between robots, such as sound, radio or smell, or that pushes them, such as wind.
///
/// A kind is one folder under media/ and one line in media/kinds.h. It writes a struct
///   struct Shout {
///     using Spec = ...; using State = ...;             // with field lists; State is saved and hashed: what is under way
///     Spec spec; State state;
///     Status init(const ElementBuild&);                // checks what ranges alone cannot
///     void deliver(const MediumContext&);              // and/or:
///     void push(const MediumContext&, double h_s, std::vector<Wrench>&);      // once per sub-step
///     bool fits() const;                               // only where sizes in State are trusted: false refuses a snapshot
///   };
/// and `const MediumKind kind = make_medium<Shout>({...})`.
///
/// A medium decides who receives what, when and how weak. Devices emit while they act (Context::emissions); in the media phase,
/// after the scene and before sensing, it puts deliveries into the inboxes of receivers, which read them when they sense.
/// Emitters and receivers name their medium by its name in the world, or leave it out where there is one of the kind.
#include <algorithm>
#include <memory>
#include <vector>

#include "base/describe.h"
#include "base/element.h"
#include "elements/world_view.h"
#include "geometry/rays.h"
#include "media/emission.h"
#include "media/inbox.h"

namespace sandlot {

/// A device that receives.
struct Receiver {
  Inbox* inbox = nullptr;
  std::uint64_t key = 0;  ///< of the device
  BodyId body;            ///< that carries it
  Pose X_LS;              ///< of the device in its link
};

struct MediumContext {
  Time now;   ///< end of the tick
  Time step;  ///< its length
  std::uint64_t tick_index = 0;
  std::uint64_t seed = 0;
  const WorldView& world;
  const RayCaster& rays;                            ///< the world as it is at `now`; many rays per call
  std::span<const Emission> emissions;              ///< of this medium in this tick, in a stable order
  const EmissionBuffer& buffer;                     ///< with their payloads
  std::span<const Receiver> receivers;              ///< of this medium, in creation order
  std::span<const std::uint32_t> receivers_by_key;  ///< indices into `receivers`

  Pose pose(const Receiver& receiver) const {
    return world.engine().states()[receiver.body.index].X_WB * receiver.X_LS;
  }
  /// Null: the receiver is gone.
  const Receiver* find_receiver(std::uint64_t key) const {
    const auto found = std::lower_bound(
        receivers_by_key.begin(), receivers_by_key.end(), key,
        [&](std::uint32_t index, std::uint64_t wanted) { return receivers[index].key < wanted; });
    return found != receivers_by_key.end() && receivers[*found].key == key ? &receivers[*found] : nullptr;
  }
};

class Medium : public Element {
 public:
  /// Reads the keys.
  virtual Status init(const ElementBuild& build) = 0;
  virtual void deliver(const MediumContext& context) = 0;
  /// Adds forces on bodies for the next sub-step of `h_s`. The context has no emissions and no receivers.
  virtual void push(const MediumContext& context, double h_s, std::vector<Wrench>& wrenches) = 0;
};

struct MediumKind {
  const char* name;
  const char* help;
  // Filled by make_medium:
  bool delivers = false, pushes = false;
  std::vector<FieldInfo> (*describe)() = nullptr;
  std::unique_ptr<Medium> (*create)() = nullptr;
};

template <class M>
class MediumAdapter final : public ElementAdapter<Medium, M> {
 public:
  Status init(const ElementBuild& build) override {
    SL_ASSIGN(this->element_.spec, read_spec<typename M::Spec>(build.decl.config));
    return this->element_.init(build);
  }
  void deliver([[maybe_unused]] const MediumContext& context) override {
    if constexpr (requires { &M::deliver; }) this->element_.deliver(context);
  }
  void push([[maybe_unused]] const MediumContext& context, [[maybe_unused]] double h_s,
            [[maybe_unused]] std::vector<Wrench>& wrenches) override {
    if constexpr (requires { &M::push; }) this->element_.push(context, h_s, wrenches);
  }
};

template <class M>
constexpr MediumKind make_medium(MediumKind kind) {
  kind.delivers = requires { &M::deliver; };
  kind.pushes = requires { &M::push; };
  kind.describe = [] { return describe_fields<typename M::Spec>(); };
  kind.create = []() -> std::unique_ptr<Medium> { return std::make_unique<MediumAdapter<M>>(); };
  return kind;
}

std::span<const MediumKind* const> medium_kinds();

}  // namespace sandlot
