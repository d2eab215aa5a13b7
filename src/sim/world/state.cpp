/// State as bytes: the hash of a tick, and snapshots.
///
/// A snapshot holds the Model (setup and instances in creation order) and the State of each entity. Restoring
/// always builds a new world from the Model and then loads the State, so the same process and a new one take the
/// same path.
#include <tbb/task_arena.h>

#include <algorithm>

#include "model/model_bytes.h"
#include "sim/load/plugin.h"
#include "sim/watch/monitor.h"
#include "sim/world/controller_manager.h"
#include "sim/world/faults.h"
#include "sim/world/simulation.h"
#include "sim/world/snapshot.h"

namespace sandlot {
namespace {

/// Keeps each part of a snapshot readable on its own: a part that reads too much or too little is noticed there.
template <class Fill>
void write_block(ByteWriter& w, Fill&& fill) {
  const std::size_t at = w.size();
  write(w, std::uint64_t{0});
  fill(w);
  const std::uint64_t size = w.size() - at - 8;
  w.patch(at, size);
}

ByteReader read_block(ByteReader& r) {
  std::uint64_t size = 0;
  read(r, size);
  return ByteReader(r.take(size));
}

Error damaged(const std::string& what) { return {"the snapshot is damaged: " + what, "take it again"}; }

/// A snapshot that is whole, read up to the State.
struct Opened {
  std::string profile;
  model::Setup setup;
  std::vector<std::uint64_t> serials;
  ByteReader states{std::span<const std::byte>()};  ///< the blocks of State
};

Result<Opened> open(std::span<const std::byte> snapshot) {
  ByteReader r(snapshot);
  std::array<char, 8> magic{};
  std::uint32_t version = 0;
  read(r, magic);
  if (!r.ok() || magic != snapshot_magic) return Error{"this is not a Sandlot snapshot"};
  read(r, version);
  if (!r.ok()) return damaged("it is cut short");
  if (version != snapshot_version)
    return Error{"the snapshot has version " + std::to_string(version),
                 "this Sandlot reads version " + std::to_string(snapshot_version)};
  Opened out;
  read(r, out.profile);
  if (!r.ok() || r.remaining() < 8) return damaged("it is cut short");
  std::uint64_t checksum = 0;
  ByteReader tail(snapshot.last(8));
  read(tail, checksum);
  if (checksum != hash64(snapshot.first(snapshot.size() - 8))) return damaged("its checksum does not fit");
  r = ByteReader(r.take(r.remaining() - 8));
  ByteReader block = read_block(r);
  if (!r.ok() || !read_setup(block, out.setup)) return damaged("the model cannot be read");
  out.serials.resize(out.setup.instances.size());
  for (std::uint64_t& serial : out.serials) read(block, serial);
  if (!block.ok() || block.remaining() != 0) return damaged("the model cannot be read");
  out.states = r;
  return out;
}

}  // namespace

bool is_snapshot(std::span<const std::byte> bytes) {
  return bytes.size() >= snapshot_magic.size() &&
         std::memcmp(bytes.data(), snapshot_magic.data(), snapshot_magic.size()) == 0;
}

Result<SnapshotInfo> examine_snapshot(std::span<const std::byte> bytes) {
  SL_ASSIGN(Opened opened, open(bytes));
  SnapshotInfo info{snapshot_version, std::move(opened.profile), std::move(opened.setup), {}, 0, 0};
  // These begin the run's own State, see Simulation::save_run.
  ByteReader run = read_block(opened.states);
  read(run, info.now);
  read(run, info.tick);
  read(run, info.revision);
  if (!run.ok()) return damaged("the run's own state cannot be read");
  return info;
}

/// A part of the run's own State that most runs do not have. Its block is there where it, or one behind it in the list, is not
/// empty: the bytes of a run that nobody touches are those of before there were any.
struct Simulation::RunBlock {
  bool (*any)(const Simulation&);
  void (*save)(const Simulation&, ByteWriter&);
  /// False: the bytes are not such State.
  bool (*load)(Simulation&, ByteReader&);

  static std::span<const RunBlock> all();

 private:
  static bool load_overrides(Simulation& sim, ByteReader& r) {
    std::vector<ManualOverride> overrides;
    read(r, overrides);
    if (!r.ok() || r.remaining() != 0) return false;
    sim.commands_.restore(std::move(overrides));
    return true;
  }

  static bool any_errors(const Simulation& sim) {
    return sim.setup_.errors != 1 || std::any_of(sim.entities_.begin(), sim.entities_.end(),
                                                 [](const auto& each) { return each->instance.errors != 1; });
  }
  static void save_errors(const Simulation& sim, ByteWriter& w) {
    write(w, sim.setup_.errors);
    for (const auto& entity : sim.entities_)
      if (entity->instance.errors != 1) write(w, entity->serial), write(w, entity->instance.errors);
  }

  static void save_failures(const Simulation& sim, ByteWriter& w) {
    for (const auto& entity : sim.entities_)
      for (const auto& device : entity->devices) {
        if (!is_ordered(*device)) continue;
        write(w, device->path);
        write(w, device->faults->order.kind);
        write(w, device->faults->order.factor);
      }
  }
  static bool load_failures(Simulation& sim, ByteReader& r) {
    while (r.ok() && r.remaining() > 0) {
      std::string path;
      FailureOrder order;
      read(r, path);
      read(r, order.kind);
      read(r, order.factor);
      Device* const device = r.ok() ? sim.find_device(path) : nullptr;
      if (!device || order.kind > FailureOrder::Kind::noisy || !(order.factor >= 0 && order.factor <= 1000))
        return false;
      if (!sim.devices_.order_failure(*device, order)) return false;
    }
    return r.ok();
  }

  static bool any_loaded(const Simulation& sim) {
    return std::any_of(sim.entities_.begin(), sim.entities_.end(),
                       [](const auto& entity) { return !entity->loaded.empty(); });
  }
};

/// In the order of their bytes: a new one goes to the end.
std::span<const Simulation::RunBlock> Simulation::RunBlock::all() {
  static constexpr RunBlock blocks[] = {
      // Pulls.
      {[](const Simulation& sim) { return !sim.pulls_.empty(); },
       [](const Simulation& sim, ByteWriter& w) { sim.pulls_.save(w); },
       [](Simulation& sim, ByteReader& r) { return sim.pulls_.load(sim.entities_, r); }},
      // Devices that are driven from outside.
      {[](const Simulation& sim) { return !sim.commands_.overrides().empty(); },
       [](const Simulation& sim, ByteWriter& w) { write(w, sim.commands_.overrides()); }, load_overrides},
      // Factors on errors: for the hash; at a restore the Model has brought them.
      {any_errors, save_errors, [](Simulation&, ByteReader&) { return true; }},
      // Failures that were ordered.
      {[](const Simulation& sim) { return sim.devices_.any_failure_ordered(); }, save_failures,
       load_failures},
      // Controllers that came while the run went on.
      {any_loaded, ControllerManager::save_loaded, ControllerManager::load_loaded},
  };
  return blocks;
}

void Simulation::save_run(ByteWriter& w) const {
  write(w, now_);
  write(w, tick_);
  write(w, revision_);
  write(w, next_serial_);
  write(w, commands_.refused());
  write_block(w, [](ByteWriter&) {});  // of the stop time, which is not State: empty, with and without one
  monitor_->save(w);
  const std::span<const RunBlock> blocks = RunBlock::all();
  std::size_t count = blocks.size();
  while (count > 0 && !blocks[count - 1].any(*this)) --count;
  for (const RunBlock& each : blocks.first(count))
    write_block(w, [&](ByteWriter& block) { each.save(*this, block); });
}

bool Simulation::load_run(ByteReader& r) {
  read(r, now_);
  read(r, tick_);
  read(r, revision_);
  read(r, next_serial_);
  std::uint64_t refused = 0;
  read(r, refused);
  commands_.restore(refused);
  constexpr std::int64_t most_ns = std::int64_t{1} << 61;  // 73 years, and far from an overflow
  if (now_.ns < 0 || now_.ns > most_ns) return false;
  if (read_block(r).remaining() != 0) return false;
  monitor_->load(r);
  for (const RunBlock& each : RunBlock::all()) {
    if (!r.ok() || r.remaining() == 0) break;
    ByteReader block = read_block(r);
    if (!r.ok() || !each.load(*this, block)) return false;
  }
  return r.ok();
}

/// Calls visit(path, key, fill) for each part of the State after the run's own: media, rules, then entities in creation order.
template <class Visit>
void Simulation::for_each_state(Visit&& visit) const {
  for (const WorldElements::Part& part : elements_.parts())
    visit(part.path, part.key, [&](ByteWriter& w) { elements_.save(part, w); });
  for (const auto& entity : entities_) {
    visit(entity->instance.name, entity->key, [&](ByteWriter& w) {
      engine_->save(entity->id, w);
      for (const model::PropertyDecl& each : entity->instance.properties) write(w, each.value);
    });
    for (const auto& device : entity->devices)
      visit(device->path, device->key, [&](ByteWriter& w) { devices_.save(*device, w); });
    for (const auto& program : entity->programs)
      visit(program->path, program->key, [&](ByteWriter& w) { Programs::save(*program, w); });
  }
  for (const Team& team : teams())
    for (const auto& program : team.programs)
      visit(program->path, program->key, [&](ByteWriter& w) { Programs::save(*program, w); });
}

/// Fills the hash of each part, the run's own first. @return the hash of all
std::uint64_t Simulation::hash_parts(std::vector<std::uint64_t>& parts) const {
  parts.clear();
  scratch_.clear();
  save_run(scratch_);
  std::uint64_t hash = hash64(scratch_.bytes());
  parts.push_back(hash);
  for_each_state([&](const std::string&, std::uint64_t key, auto&& fill) {
    scratch_.clear();
    fill(scratch_);
    parts.push_back(hash64(scratch_.bytes(), key));
    hash = hash_combine(hash, parts.back());
  });
  return hash;
}

std::shared_ptr<const std::vector<std::string>> Simulation::name_parts() const {
  auto names = std::make_shared<std::vector<std::string>>(1, "sim");
  for_each_state([&](const std::string& path, std::uint64_t, auto&&) { names->push_back(path); });
  return names;
}

std::uint64_t Simulation::state_hash() const {
  std::vector<std::uint64_t> parts;
  return hash_parts(parts);
}

std::vector<SubHash> Simulation::sub_hashes() const {
  std::vector<std::uint64_t> parts;
  hash_parts(parts);
  const auto names = name_parts();
  std::vector<SubHash> out;
  for (std::size_t i = 0; i < parts.size(); ++i) out.push_back({(*names)[i], parts[i]});
  return out;
}

const std::string& Simulation::profile() {
  static const std::string text = [] {
    // The ray scene says what Embree was pinned to; the rest is fixed at build time.
    const RayScene scene;
#if defined(__AVX2__)
    const char* const march = "x86-64-v3";
#else
    const char* const march = "baseline";
#endif
    return std::string("sandlot-1 ") + march + " fp-contract-off sleef-cinz ode-double embree-" + scene.isa();
  }();
  return text;
}

std::vector<std::byte> Simulation::snapshot() const {
  ByteWriter w;
  write(w, snapshot_magic);
  write(w, snapshot_version);
  write(w, profile());
  write_block(w, [&](ByteWriter& block) {
    std::vector<const model::Instance*> instances;
    std::vector<model::Instance> declared;  // those that differ from what is in the world
    declared.reserve(entities_.size());
    for (const auto& entity : entities_)
      instances.push_back(entity->declared_model ? &declared.emplace_back(entity->declared())
                                                 : &entity->instance);
    write_setup(block, setup_, instances);
    for (const auto& entity : entities_) write(block, entity->serial);
  });
  write_block(w, [&](ByteWriter& block) { save_run(block); });
  for_each_state([&](const std::string&, std::uint64_t, auto&& fill) { write_block(w, fill); });
  const std::uint64_t checksum = hash64(w.bytes());
  write(w, checksum);
  return std::move(w.buffer());
}

Result<std::unique_ptr<Simulation>> Simulation::restore(std::span<const std::byte> snapshot,
                                                        const SimulationOptions& options,
                                                        Diagnostics& diagnostics) {
  SL_ASSIGN(Opened opened, open(snapshot));
  if (opened.profile != profile())
    diagnostics.warn({"the snapshot was taken with another numeric profile (" + opened.profile + ")",
                      "this one is " + profile() + "; the run will go on, but with other last bits"});
  ByteReader& r = opened.states;
  const auto whole = [](const ByteReader& block) { return block.ok() && block.remaining() == 0; };

  for (model::PluginDecl& decl : opened.setup.plugins) {
    SL_ASSIGN(const Plugin* const plugin, load_plugin(decl, options.paths, diagnostics));
    decl = {plugin->file, plugin->name, plugin->hash, decl.place};
  }
  std::unique_ptr<Simulation> sim(new Simulation(std::move(opened.setup), options));
  Diagnostics given_before;  // these warnings were given when the run began
  SL_TRY(sim->build(given_before, true));
  for (std::size_t i = 0; i < sim->entities_.size(); ++i) sim->entities_[i]->serial = opened.serials[i];
  ByteReader run = read_block(r);
  if (!sim->load_run(run) || !whole(run)) return damaged("the run's own state cannot be read");
  for (const WorldElements::Part& part : sim->elements_.parts()) {
    ByteReader state = read_block(r);
    if (!sim->elements_.load(part, state) || !whole(state))
      return damaged("the state of '" + part.path + "' cannot be read");
  }
  const auto load_programs = [&](ProgramEntries& programs) -> Status {
    for (auto& program : programs) {
      ByteReader state = read_block(r);
      if (!Programs::load(*program, state, sim->now_) || !whole(state))
        return damaged("the program '" + program->path + "' cannot be read");
    }
    return {};
  };
  for (std::size_t i = 0; i < sim->entities_.size(); ++i) {
    Entity& entity = *sim->entities_[i];
    ByteReader bodies = read_block(r);
    bool fits = sim->engine_->load(entity.id, bodies);
    for (model::PropertyDecl& each : entity.instance.properties) {
      read(bodies, each.value);
      fits = fits && each.value >= each.min && each.value <= each.max;
    }
    if (!fits || !whole(bodies))
      return damaged("the bodies of '" + entity.instance.name + "' cannot be read");
    for (auto& device : entity.devices) {
      ByteReader state = read_block(r);
      sim->devices_.load(*device, state, sim->now_);
      if (!whole(state)) return damaged("the device '" + device->path + "' cannot be read");
    }
    SL_TRY(load_programs(entity.programs));
    sim->programs_.follow_levels(sim->entities_, entity);
  }
  for (Team& team : sim->programs_.teams()) SL_TRY(load_programs(team.programs));
  sim->programs_.entities_changed();
  if (!whole(r)) return damaged("there is more in it than belongs there");
  sim->arena_->execute([&] {
    sim->update_scene();
    sim->find_stop_reason();  // rules have judged this tick: what they found is State
  });
  return sim;
}

}  // namespace sandlot
