#include "sim/world/publisher.h"

#include <algorithm>

#include "base/hash_each.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

/// Pool of shared objects: one is handed out again once nobody else holds it. They are handed out in the order in which they
/// were made, which is the order in which a queue gives them back.
template <class T>
class Ring {
 public:
  /// @return one that nobody else holds
  template <class Make>
  std::shared_ptr<T> take(Make&& make) {
    if (!items_.empty() && items_[next_].use_count() == 1) {
      const std::size_t taken = next_;
      next_ = (next_ + 1) % items_.size();
      return items_[taken];
    }
    std::shared_ptr<T> made = make();
    // Of a queue that grew while a disk stood still no more than this stays for good.
    constexpr std::size_t most = 64;
    if (items_.size() < most) {
      items_.insert(items_.begin() + static_cast<std::ptrdiff_t>(next_), made);
      next_ = (next_ + 1) % items_.size();
    }
    return made;
  }

 private:
  std::vector<std::shared_ptr<T>> items_;
  std::size_t next_ = 0;  ///< the one that was handed out first
};

/// Resizes without giving the memory of elements back: those cut off are kept in `spare` and used again.
template <class T>
void resize_keeping(std::vector<T>& items, std::size_t size, std::vector<T>& spare) {
  while (items.size() > size) {
    spare.push_back(std::move(items.back()));
    items.pop_back();
  }
  while (items.size() < size) {
    if (spare.empty()) spare.emplace_back();
    items.push_back(std::move(spare.back()));
    spare.pop_back();
  }
}

}  // namespace

/// What is kept from frame to frame.
struct Publisher::Memory {
  Ring<Frame> frames;
  std::vector<LogEntry> spare_log;

  /// Copies of the topics' messages, by their place in creation order.
  std::vector<Ring<TopicBase>> copies;

  struct Part {
    std::uint64_t version = 0;  ///< see fill_hashes
    std::uint64_t hash = 0;
  };
  std::vector<Part> parts;
  std::uint64_t hashed_tick = ~std::uint64_t{0};  ///< tick of `parts`
  std::uint64_t hashed_revision = 0;
  std::shared_ptr<const std::vector<std::string>> part_names;
  std::uint64_t part_names_revision = 0;

  struct Waiting {
    std::size_t part, begin, end;  ///< its bytes in `bytes`
    std::uint64_t key;
  };
  ByteWriter bytes;
  std::vector<Waiting> waiting;
  std::vector<HashJob> jobs;

  void hash_waiting() {
    jobs.clear();
    for (const Waiting& each : waiting)
      jobs.push_back(
          {bytes.bytes().subspan(each.begin, each.end - each.begin), each.key, &parts[each.part].hash});
    hash64_each(jobs);
    waiting.clear();
    bytes.clear();
  }
};

Publisher::Publisher(const Simulation& simulation) : sim_(simulation) {}
Publisher::~Publisher() = default;

void Publisher::begin_tick() {
  wants_ = {.instances = false};
  for (const Observer* observer : observers_) {
    const Observer::Wants wants = observer->wants();
    wants_.messages = wants_.messages || wants.messages;
    wants_.log = wants_.log || wants.log;
    wants_.input = wants_.input || wants.input || wants.log;
    wants_.hash = wants_.hash || wants.hash;
    wants_.links = wants_.links || wants.links;
    wants_.contacts = wants_.contacts || wants.contacts;
    wants_.deliveries = wants_.deliveries || wants.deliveries;
    wants_.instances = wants_.instances || wants.instances || wants.links;
  }
}

void Publisher::publish() {
  if (observers_.empty()) return;
  if (!memory_) memory_ = std::make_unique<Memory>();
  const std::shared_ptr<Frame> frame = memory_->frames.take([] { return std::make_shared<Frame>(); });
  fill_time(*frame);
  if (wants_.instances) fill_instances(*frame, wants_.links);
  else frame->instances.clear();
  fill_topics(*frame);
  fill_log(*frame);
  fill_hashes(*frame);
  frame->contacts.clear();
  if (wants_.contacts) fill_contacts(*frame);
  const std::span<const FrameDelivery> deliveries = sim_.elements_.deliveries();
  frame->deliveries.assign(deliveries.begin(), deliveries.end());
  const std::shared_ptr<const Frame> shown = frame;
  for (Observer* observer : observers_) observer->on_frame(shown);
}

std::shared_ptr<const Frame> Publisher::look(const Observer::Wants& wants) const {
  auto frame = std::make_shared<Frame>();
  fill_time(*frame);
  fill_instances(*frame, wants.links);
  if (wants.contacts) fill_contacts(*frame);
  return frame;
}

void Publisher::fill_time(Frame& frame) const {
  frame.tick = sim_.tick_;
  frame.now = sim_.now_;
  frame.step = sim_.step_;
  frame.revision = sim_.revision_;
}

void Publisher::fill_log(Frame& frame) {
  const std::span<const LogEntry> log = sim_.commands_.tick_log();
  resize_keeping(frame.log, log.size(), memory_->spare_log);
  std::copy(log.begin(), log.end(), frame.log.begin());
}

void Publisher::fill_contacts(Frame& frame) const {
  const std::span<const Contact> contacts = sim_.engine_->contacts();
  frame.contacts.assign(contacts.begin(), contacts.end());
}

void Publisher::fill_instances(Frame& frame, bool links) const {
  frame.instances.resize(sim_.entities_.size());
  const auto states = sim_.engine_->states();
  for (std::size_t i = 0; i < sim_.entities_.size(); ++i) {
    const SimulationParts::Entity& entity = *sim_.entities_[i];
    FrameInstance& out = frame.instances[i];
    // Frames are filled again and again: of the entity that it showed before, what stays is there already.
    if (out.serial != entity.serial || out.model != entity.instance.model) {
      out.name = entity.instance.name;
      out.serial = entity.serial;
      out.model = entity.instance.model;
    }
    out.id = entity.id;
    out.is_robot = entity.instance.is_robot;
    out.X_WM = sim_.engine_->pose(entity.id);
    const std::span<const BodyId> bodies = sim_.engine_->bodies(entity.id);
    out.V_WB = states[bodies.front().index].V_WB;
    out.X_WL.resize(links ? bodies.size() : 0);
    for (std::size_t l = 0; l < out.X_WL.size(); ++l) out.X_WL[l] = states[bodies[l].index].X_WB;
  }
}

void Publisher::fill_topics(Frame& frame) {
  frame.topics.clear();  // before copies are taken: those that this frame held are free now
  if (!wants_.messages) return;
  std::size_t place = 0;
  sim_.for_each_topic([&](const TopicBase& topic, const std::string&) {
    const std::size_t own = place++;
    if (topic.count == 0 || topic.stamp != sim_.now_) return;
    if (memory_->copies.size() <= own) memory_->copies.resize(own + 1);
    Ring<TopicBase>& ring = memory_->copies[own];
    const auto clone = [&] { return std::shared_ptr<TopicBase>(topic.clone()); };
    std::shared_ptr<TopicBase> copy = ring.take(clone);
    // Devices come and go, and with them the places.
    if (copy->name() != topic.name() || std::string_view(copy->type()) != topic.type()) {
      ring = {};
      copy = ring.take(clone);
    }
    copy->copy_from(topic);
    frame.topics.push_back(std::move(copy));
  });
}

/// A device that only senses or counts its other changes, without a meter and common keys, changes when it takes a sample; a
/// program when it runs and when its orders are carried out; both also by requests. Between those their hashes stay.
void Publisher::fill_hashes(Frame& frame) {
  frame.hash = 0;
  frame.parts.clear();
  if (!wants_.hash) return;
  Memory& p = *memory_;
  const bool goes_on = p.hashed_tick + 1 == sim_.tick_ && p.hashed_revision == sim_.revision_ &&
                       sim_.outcomes().empty() && !p.parts.empty();
  std::size_t count = 0;
  constexpr std::uint64_t always = ~std::uint64_t{0};
  const auto add = [&](std::uint64_t key, std::uint64_t version, auto&& fill) {
    const std::size_t part = count++;
    if (part == p.parts.size()) p.parts.emplace_back();
    if (goes_on && version != always && p.parts[part].version == version) return;
    p.parts[part].version = version;
    const std::size_t begin = p.bytes.size();
    fill(p.bytes);
    p.waiting.push_back({part, begin, p.bytes.size(), key});
    // Not all at once: what was written should still be in the cache when it is read.
    constexpr std::size_t enough = 64 * 1024;
    if (p.bytes.size() > enough) p.hash_waiting();
  };
  const auto add_programs = [&](const SimulationParts::ProgramEntries& programs) {
    for (const auto& program : programs)
      add(program->key, 2 * program->steps + (program->command.orders().empty() ? 0 : 1),
          [&](ByteWriter& w) { Programs::save(*program, w); });
  };
  add(0, always, [&](ByteWriter& w) { sim_.save_run(w); });
  for (const WorldElements::Part& part : sim_.elements_.parts())
    add(part.key, always, [&](ByteWriter& w) { sim_.elements_.save(part, w); });
  for (const auto& entity : sim_.entities_) {
    add(entity->key, always, [&](ByteWriter& w) { sim_.engine_->save(entity->id, w); });
    for (const auto& device : entity->devices) {
      // Meters and messages on their way change between samples, too.
      const std::optional<std::uint64_t> changes = sim_.devices_.changes(*device);
      const bool is_kept = (sim_.devices_.kind(*device).phases == phase_sense || changes) &&
                           !device->energy && !device->keys;
      // Samples, changes, commands and deliveries only become more, and so does their sum.
      std::uint64_t version = sim_.timing(*device).sample + changes.value_or(0);
      if (device->inbox()) version += device->inbox()->arrived();
      for (const SimulationParts::Slot& slot : device->commands) version += slot.topic->count;
      add(device->key, is_kept ? version : always, [&](ByteWriter& w) { sim_.devices_.save(*device, w); });
    }
    add_programs(entity->programs);
  }
  for (const SimulationParts::Team& team : sim_.teams()) add_programs(team.programs);
  p.hash_waiting();
  p.parts.resize(count);
  p.hashed_tick = sim_.tick_;
  p.hashed_revision = sim_.revision_;
  frame.hash = p.parts.front().hash;
  frame.parts.push_back(frame.hash);
  for (std::size_t i = 1; i < count; ++i) {
    frame.parts.push_back(p.parts[i].hash);
    frame.hash = hash_combine(frame.hash, p.parts[i].hash);
  }
  // Which parts there are changes with the Model alone.
  if (!p.part_names || p.part_names_revision != sim_.revision_) {
    p.part_names = sim_.name_parts();
    p.part_names_revision = sim_.revision_;
  }
  frame.part_names = p.part_names;
}

}  // namespace sandlot
