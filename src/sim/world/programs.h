#pragma once
/// Programs: the control programs of all robots. They are made for an entity, step in the control phase, and their orders
/// are delivered in the next tick.
///
/// Order     all programs in entity order for their orders; for their steps kind by kind, in batches, in parallel.
/// State     of each program (save, load); the lists here follow from the entities.
/// Errors    an exception from a controller fails the tick and goes no further.
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "sim/world/commands.h"
#include "sim/world/device_pools.h"
#include "sim/world/parts.h"

namespace sandlot {

struct SimulationOptions;

class Programs {
 public:
  using Entity = SimulationParts::Entity;
  using ProgramEntry = SimulationParts::ProgramEntry;
  using Entities = std::span<Owned<Entity>>;

  /// All must outlive the programs.
  Programs(const model::Setup& setup, const DevicePools& devices, Commands& commands)
      : setup_(setup), devices_(devices), commands_(commands) {}

  /// Collects the kinds that `controller:` may name: ours, the embedding program's, then those of the plugins. The entries
  /// of `plugins` become those of the files that were loaded.
  Status gather_kinds(std::vector<model::PluginDecl>& plugins, const SimulationOptions& options,
                      Diagnostics& diagnostics);
  std::span<const ControllerKind* const> kinds() const { return kinds_; }

  Status add(Entity& entity, std::shared_ptr<const model::ControllerDecl> declared);
  /// Gives the programs of an entity the description of its devices as they are now, with their State. On an error nothing
  /// has changed.
  Status describe_again(Entity& entity);
  /// Points readings and orders of an entity's programs at the active levels of its devices.
  void follow_levels(Entity& entity);
  /// To be called when entities were added or removed, and when programs were loaded.
  void entities_changed() { changed_ = true; }

  /// Delivers the orders of the latest step to the devices. @param logged  whether to log them
  void deliver_orders(Entities entities, Time now, bool logged);
  /// Steps all programs. @return the first failure
  std::optional<Error> step(Entities entities, Time now);

  static void save(const ProgramEntry& program, ByteWriter& w);
  static bool load(ProgramEntry& program, ByteReader& r);

 private:
  Result<std::unique_ptr<ProgramEntry>> make(const Entity& entity,
                                             std::shared_ptr<const model::ControllerDecl> declared);
  std::shared_ptr<const Description> describe(const Entity& entity);
  void gather(Entities entities);
  void step_batch(std::span<ProgramEntry* const> batch, Time now) const;

  const model::Setup& setup_;
  const DevicePools& devices_;
  Commands& commands_;
  std::vector<const ControllerKind*> kinds_;
  std::shared_ptr<const Description> described_;  ///< the latest
  /// All programs in entity order, and those that run, kind by kind.
  std::vector<ProgramEntry*> all_, running_;
  std::vector<const Entity*> owners_;  ///< per entry of all_
  bool changed_ = true;                ///< the lists above have to be made again
};

}  // namespace sandlot
