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
  if (!r.ok() || magic != snapshot_magic) return Error{"this is no Sandlot snapshot"};
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

void Simulation::save_run(ByteWriter& w) const {
  write(w, now_);
  write(w, tick_);
  write(w, revision_);
  write(w, next_serial_);
  write(w, commands_.refused());
  write(w, std::uint64_t{
               0});  // the block of the stop time, which is no State: empty, and there with and without one
  monitor_->save(w);
  // Only where there are some: the bytes of a run that nobody touches are those of before there were any.
  const bool scaled = errors_scaled();
  const bool ordered = devices_.any_failure_ordered();
  const bool loaded = std::any_of(entities_.begin(), entities_.end(),
                                  [](const auto& entity) { return !entity->loaded.empty(); });
  const std::vector<ManualOverride>& overrides = commands_.overrides();
  if (!pulls_.empty() || !overrides.empty() || scaled || ordered || loaded)
    write_block(w, [&](ByteWriter& block) { pulls_.save(block); });
  if (!overrides.empty() || scaled || ordered || loaded)
    write_block(w, [&](ByteWriter& block) { write(block, overrides); });
  if (scaled || ordered || loaded) write_block(w, [&](ByteWriter& block) { save_errors(block); });
  if (!ordered && !loaded) return;
  write_block(w, [&](ByteWriter& block) {
    for (const auto& entity : entities_)
      for (const auto& device : entity->devices) {
        if (!is_ordered(*device)) continue;
        write(block, device->path);
        write(block, device->faults->order.kind);
        write(block, device->faults->order.factor);
      }
  });
  if (loaded) write_block(w, [&](ByteWriter& block) { ControllerManager::save_loaded(*this, block); });
}

bool Simulation::errors_scaled() const {
  return setup_.errors != 1 || std::any_of(entities_.begin(), entities_.end(),
                                           [](const auto& each) { return each->instance.errors != 1; });
}

void Simulation::save_errors(ByteWriter& w) const {
  write(w, setup_.errors);
  for (const auto& entity : entities_)
    if (entity->instance.errors != 1) write(w, entity->serial), write(w, entity->instance.errors);
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
  if (!r.ok() || r.remaining() == 0) return r.ok();
  ByteReader pulls = read_block(r);
  if (!r.ok() || !pulls_.load(entities_, pulls)) return false;
  if (r.remaining() == 0) return true;
  ByteReader block = read_block(r);
  std::vector<ManualOverride> overrides;
  read(block, overrides);
  if (!r.ok() || !block.ok() || block.remaining() != 0) return false;
  commands_.restore(std::move(overrides));
  if (r.remaining() == 0) return true;
  read_block(r);  // factors on errors: for the hash; the Model has brought them
  if (!r.ok() || r.remaining() == 0) return r.ok();
  ByteReader failures = read_block(r);
  while (failures.ok() && failures.remaining() > 0) {
    std::string path;
    FailureOrder order;
    read(failures, path);
    read(failures, order.kind);
    read(failures, order.factor);
    Device* const device = failures.ok() ? find_device(path) : nullptr;
    if (!device || order.kind > FailureOrder::Kind::noisy || !(order.factor >= 0 && order.factor <= 1000))
      return false;
    if (!devices_.order_failure(*device, order)) return false;
  }
  if (!r.ok() || !failures.ok()) return false;
  if (r.remaining() == 0) return true;
  ByteReader loaded = read_block(r);
  return r.ok() && ControllerManager::load_loaded(*this, loaded);
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
  for (const WorldElements::Part& part : elements_.parts()) names->push_back(part.path);
  for (const auto& entity : entities_) {
    names->push_back(entity->instance.name);
    for (const auto& device : entity->devices) names->push_back(device->path);
    for (const auto& program : entity->programs) names->push_back(program->path);
  }
  for (const Team& team : teams())
    for (const auto& program : team.programs) names->push_back(program->path);
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
