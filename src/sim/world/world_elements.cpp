#include "sim/world/world_elements.h"

#include <algorithm>
#include <set>

#include "base/text.h"
#include "sim/watch/parameters.h"
#include "sim/watch/values.h"
#include "sim/world/faults.h"
#include "sim/world/lookup.h"
#include "sim/world/simulation.h"

namespace sandlot {
namespace {

/// The kind of an element: ours, or one that the embedding program brings.
template <class Kind>
Result<const Kind*> find_kind(const model::ElementDecl& decl, std::span<const Kind* const> ours,
                              std::span<const Kind* const> extra, const char* what) {
  std::vector<std::string> names;
  for (const auto& table : {ours, extra})
    for (const Kind* const kind : table) {
      if (decl.kind == kind->name) return kind;
      names.emplace_back(kind->name);
    }
  return Error{"no kind of " + std::string(what) + " '" + decl.kind.substr(0, 60) + "'",
               suggestion(decl.kind, names), decl.place};
}

Status check_element_names(std::span<const model::ElementDecl> declared, const char* list) {
  std::set<std::string> names;
  for (const model::ElementDecl& decl : declared) {
    if (decl.name.empty()) return Error{"the name is empty", "", decl.place};
    if (!names.insert(sanitised(decl.name)).second)
      return Error{"two " + std::string(list) + " are called '" + sanitised(decl.name) + "'",
                   "give each a name of its own", decl.place};
  }
  return {};
}

Error at_declaration(Error error, const model::ElementDecl& decl) {
  if (!error.place.file && error.place.line == 0) error.place = decl.place;
  return error;
}

}  // namespace

/// What elements may ask while they are built.
struct WorldElements::Build final : ElementBuild {
  Build(const model::ElementDecl& declared, std::string its_path, const WorldElements& all,
        bool world_restored, std::span<const std::string> known_before, std::vector<std::string>& known)
      : ElementBuild(declared, std::move(its_path), all),
        elements(all),
        restored(world_restored),
        before(known_before),
        addresses(known) {}

  Status expect_entity(std::string_view name, const char* key) const override {
    if (restored || elements.sim_.find_entity(name)) return {};
    std::vector<std::string> names;
    for (const auto& each : elements.sim_.entities()) names.push_back(each->instance.name);
    return error(key, "there is no robot or object '" + std::string(name.substr(0, 100)) + "'",
                 suggestion(name, names));
  }
  Status expect_marker(std::string_view name, const char* key) const override {
    if (elements.find_marker(name)) return {};
    std::vector<std::string> names;
    for (const NamedMarker& each : elements.markers_) names.push_back(each.name);
    return error(key, "there is no marker '" + std::string(name.substr(0, 100)) + "'",
                 names.empty() ? "declare it: markers: [{kind: disc, name: ...}]" : suggestion(name, names));
  }
  Status expect_property(std::string_view name, const char* key) const override {
    std::vector<std::string> names;
    for (const auto& each : elements.sim_.entities())
      for (const model::PropertyDecl& property : each->instance.properties) {
        if (property.name == name) return {};
        names.push_back(property.name);
      }
    if (restored) return {};
    return error(key, "no robot or object has a property '" + std::string(name.substr(0, 100)) + "'",
                 names.empty() ? "declare it: robots: [{properties: {" + std::string(name.substr(0, 100)) +
                                     ": {value: 100, min: 0}}}]"
                               : suggestion(name, names));
  }
  Result<std::uint32_t> watch(std::string_view expression, const char* key) const override {
    const Node* const node = decl.config.find(key);
    SL_ASSIGN(ValueExpression compiled,
              ValueExpression::compile(elements.sim_, expression, node ? node->place() : decl.place, before));
    for (const std::string& address : compiled.addresses())
      if (std::find(addresses.begin(), addresses.end(), address) == addresses.end())
        addresses.push_back(address);
    elements.watched_.push_back(std::move(compiled));
    return static_cast<std::uint32_t>(elements.watched_.size() - 1);
  }

  Result<ParameterName> expect_parameter(std::string_view address, const std::string& value,
                                         const char* key) const override {
    const std::string quoted = "'" + std::string(address.substr(0, 100)) + "'";
    const auto parameter = parse_parameter(address);
    if (!parameter)
      return error(key, quoted + " is not the address of a parameter",
                   "write it as in rover/laser.noise[0].white");
    const auto& [target, field, unit, in_list] = *parameter;
    ParameterName name{target, field};
    if (restored || is_element(target) || target == "sim" || elements.sim_.find_entity(target)) return name;
    Parameters parameters(elements.sim_);
    std::vector<Parameter> settable = parameters.list(target);
    if (settable.empty() && !is_program(target))
      if (auto device = device_named(elements.sim_, target); !device)
        return error(key, device.error().what, device.error().fix);
    if (field == failure_field && !is_program(target)) return name;
    std::vector<std::string> known;
    for (const Parameter& each : settable) known.push_back(each.address());
    if (std::find(known.begin(), known.end(), parameter->address()) == known.end())
      return error(key, quoted + " is not a parameter that can be set while the run goes on",
                   suggestion(address, known));
    if (Status fits = value.empty() ? Status() : parameters.check(*parameter, Node::scalar(value)); !fits)
      return error(key, quoted + ": " + fits.error().what, fits.error().fix);
    return name;
  }
  bool is_program(std::string_view path) const {
    const auto* const programs = elements.sim_.programs_of(first_part(path));
    return programs && std::any_of(programs->begin(), programs->end(),
                                   [&](const auto& each) { return each->path == path; });
  }
  /// Media and rules may be named before they are made.
  bool is_element(std::string_view target) const {
    const auto lists = [&](const char* list, std::span<const model::ElementDecl> declared) {
      return std::any_of(declared.begin(), declared.end(), [&](const model::ElementDecl& each) {
        return target == list + sanitised(each.name);
      });
    };
    return lists("media/", elements.sim_.setup().media) || lists("rules/", elements.sim_.setup().rules);
  }

  const WorldElements& elements;
  bool restored;
  std::span<const std::string> before;
  std::vector<std::string>& addresses;
};

WorldElements::WorldElements(const Simulation& simulation) : sim_(simulation) {}
WorldElements::~WorldElements() = default;

Status WorldElements::build(const SimulationOptions& options, bool restored,
                            std::vector<std::string>& addresses) {
  const model::Setup& setup = sim_.setup();
  std::vector<std::string> before = addresses;
  // Values and criteria come later, as they may read rules; rules may name them all the same.
  for (const model::ValueDecl& value : setup.values) {
    before.push_back(value.name);
    before.push_back("values." + value.name);
  }
  if (setup.criterion) before.emplace_back("criterion");
  for (const model::TeamDecl& team : setup.teams)
    if (team.criterion) before.push_back(team.name + ".criterion");
  SL_TRY(check_element_names(setup.markers, "markers"));
  SL_TRY(check_element_names(setup.media, "media"));
  SL_TRY(check_element_names(setup.rules, "rules"));
  ElementBuild::Made made;  // of the element that was made last
  const auto init = [&](const char* list, auto& element, const model::ElementDecl& decl) -> Status {
    const Build build(decl, std::string(list) + "/" + sanitised(decl.name), *this, restored, before,
                      addresses);
    Status status = element.init(build);
    if (!status) return at_declaration(std::move(status.error()), decl);
    made = build.take_made();
    return {};
  };
  const auto add_part = [&](const char* list, const model::ElementDecl& decl, Element& element,
                            const auto& kind) {
    Part part{
        std::string(list) + "/" + sanitised(decl.name), 0, &element, kind.name, kind.help, kind.describe};
    part.key = entity_key(part.path);
    part.topics = std::move(made.topics);
    part.commands = std::move(made.commands);
    parts_.push_back(std::move(part));
  };
  for (const model::ElementDecl& decl : setup.markers) {
    SL_ASSIGN(const MarkerKind* const kind, find_kind<MarkerKind>(decl, marker_kinds(), {}, "marker"));
    NamedMarker marker{sanitised(decl.name), kind->create()};
    SL_TRY(init("markers", *marker.marker, decl));
    markers_.push_back(std::move(marker));
  }
  for (const model::ElementDecl& decl : setup.media) {
    SL_ASSIGN(const MediumKind* const kind, find_kind(decl, medium_kinds(), options.extra_media, "medium"));
    media_.push_back({kind->create(), kind, {}, {}, {}});
    SL_TRY(init("media", *media_.back().medium, decl));
    add_part("media", decl, *media_.back().medium, *kind);
  }
  for (const model::ElementDecl& decl : setup.rules) {
    SL_ASSIGN(const RuleKind* const kind, find_kind(decl, rule_kinds(), options.extra_rules, "rule"));
    rules_.push_back({kind->create(), kind, {}, 0});
    SL_TRY(init("rules", *rules_.back().rule, decl));
    add_part("rules", decl, *rules_.back().rule, *kind);
    touches_wanted_ = std::max(touches_wanted_, kind->touches);
  }
  return {};
}

void WorldElements::look_up() {
  for (ValueExpression& each : watched_) each.look_up();
}

// -------------------------------------------------------------------------------------------------------- the view

const Engine& WorldElements::engine() const { return sim_.engine(); }

/// Lists entities and receivers again when some came or went.
void WorldElements::gather() const {
  if (!changed_) return;
  changed_ = false;
  entities_.clear();
  trace_.devices_changed();
  for (NamedMedium& each : media_) each.receivers.clear();
  for (const auto& entity : sim_.entities()) {
    entities_.push_back({&entity->instance, entity->id, entity->serial});
    for (const auto& device : entity->devices)
      if (device->inbox())
        media_[device->inbox()->medium()].receivers.push_back(
            {device->inbox(), device->key, sim_.engine().bodies(entity->id)[device->decl.link],
             device->decl.X_LS});
  }
  for (NamedMedium& each : media_) {
    each.receivers_by_key.resize(each.receivers.size());
    for (std::uint32_t i = 0; i < each.receivers.size(); ++i) each.receivers_by_key[i] = i;
    std::sort(
        each.receivers_by_key.begin(), each.receivers_by_key.end(),
        [&](std::uint32_t a, std::uint32_t b) { return each.receivers[a].key < each.receivers[b].key; });
  }
}

std::span<const EntityView> WorldElements::entities() const {
  gather();
  return entities_;
}

const EntityView* WorldElements::find_entity(std::string_view name) const {
  const SimulationParts::Entity* const entity = sim_.find_entity(name);
  if (!entity) return nullptr;
  gather();
  // Creation order is that of the serials.
  const auto found = std::lower_bound(
      entities_.begin(), entities_.end(), entity->serial,
      [](const EntityView& each, std::uint64_t serial) { return each.serial < serial; });
  return found != entities_.end() && found->serial == entity->serial ? &*found : nullptr;
}

std::vector<std::string> WorldElements::actuators(const EntityView& view) const {
  std::vector<std::string> out;
  const SimulationParts::Entity* const entity = sim_.find_entity(view.instance->name);
  if (!entity) return out;
  for (const auto& device : entity->devices)
    if (!device->commands.empty()) out.push_back(device->path);
  return out;
}

std::optional<BatteryView> WorldElements::battery(const EntityView& view) const {
  const auto entities = sim_.entities();
  const auto found = std::lower_bound(
      entities.begin(), entities.end(), view.serial,
      [](const auto& each, std::uint64_t serial) { return each->serial < serial; });
  if (found == entities.end() || (*found)->serial != view.serial || !(*found)->energy) return std::nullopt;
  const EnergyAccount& account = *(*found)->energy;
  return BatteryView{account.energy_J, account.fraction, account.empty};
}

const Marker* WorldElements::find_marker(std::string_view name) const {
  for (const NamedMarker& each : markers_)
    if (each.name == name) return each.marker.get();
  return nullptr;
}

const TopicBase* WorldElements::find_topic(std::string_view name) const { return sim_.find_topic(name); }

std::optional<double> WorldElements::value(std::uint32_t watched) const {
  const auto found = watched_[watched].evaluate();
  return found && found->finite ? std::optional(found->value) : std::nullopt;
}

// --------------------------------------------------------------------------------------------------------- phases

void WorldElements::watch(Watch& watch) {
  if (touches_wanted_ != RuleKind::Touches::impulses) return;
  for (const EntityView& entity : entities()) {
    if (!entity.instance->is_robot) continue;
    const auto bodies = engine().bodies(entity.id);
    watch.contacts.insert(watch.contacts.end(), bodies.begin(), bodies.end());
  }
}

void WorldElements::push(const MediumContext& context, double h_s, std::vector<Wrench>& wrenches) {
  for (NamedMedium& each : media_)
    if (each.kind->pushes) each.medium->push(context, h_s, wrenches);
}

void WorldElements::note_touches(std::uint32_t substep, double h_s) {
  if (touches_wanted_ == RuleKind::Touches::none) return;
  for (const Contact& contact : engine().contacts())
    touches_.push_back(
        {contact.a, contact.b, contact.point_W, contact.normal_W, h_s * contact.force_W, substep});
}

void WorldElements::deliver(const MediumContext& context, bool traced) {
  if (media_.empty()) return;
  gather();
  const bool only_one = media_.size() == 1;
  for (NamedMedium& each : media_) each.emissions.clear();
  if (!only_one)
    for (const Emission& emission : context.buffer.emissions)
      media_[emission.medium].emissions.push_back(emission);
  for (NamedMedium& each : media_) {
    if (!each.kind->delivers) continue;
    if (traced) trace_.begin(each.receivers);
    each.medium->deliver({.now = context.now,
                          .step = context.step,
                          .tick_index = context.tick_index,
                          .seed = context.seed,
                          .world = *this,
                          .rays = context.rays,
                          .emissions = only_one ? std::span<const Emission>(context.buffer.emissions)
                                                : std::span<const Emission>(each.emissions),
                          .buffer = context.buffer,
                          .receivers = each.receivers,
                          .receivers_by_key = each.receivers_by_key});
    if (traced) trace_.end(static_cast<std::uint32_t>(&each - media_.data()), each.receivers, sim_);
  }
}

void WorldElements::judge(Time now, Time step) {
  const RuleContext context{now, step, sim_.tick_index(), sim_.setup().seed, *this, touches_};
  for (NamedRule& each : rules_) {
    each.actions = {};
    each.rule->judge(context, each.actions);
  }
}

const std::string* WorldElements::stop_reason() const {
  for (const NamedRule& each : rules_)
    if (each.actions.reason) return &*each.actions.reason;
  return nullptr;
}

std::vector<WorldElements::Waiting> WorldElements::take_requests() {
  std::vector<Waiting> out;
  for (std::size_t i = 0; i < rules_.size(); ++i) {
    NamedRule& rule = rules_[i];
    for (Request& request : rule.actions.requests)
      out.push_back({{Source::Kind::rule, i}, rule.number++, std::move(request)});
    rule.actions.requests.clear();
  }
  return out;
}

// ---------------------------------------------------------------------------------------------------------- State

const WorldElements::Part* WorldElements::find_part(std::string_view path) const {
  for (const Part& part : parts_)
    if (part.path == path) return &part;
  return nullptr;
}

const TopicBase* WorldElements::find_own_topic(std::string_view name) const {
  const std::string_view bare = name.substr(name.substr(0, 1) == "/" ? 1 : 0);
  for (const Part& part : parts_)
    for (const auto& topic : part.topics)
      if (std::string_view(topic->name()).substr(1) == bare || part.path == bare) return topic.get();
  return nullptr;
}

TopicBase* WorldElements::command_slot(std::string_view target, std::string_view type) {
  for (const Part& part : parts_)
    for (const auto& slot : part.commands) {
      const std::string_view name = std::string_view(slot->name()).substr(1);
      const bool named = part.path == target || name.substr(0, name.rfind('/')) == target;
      if (named && type == slot->type()) return slot.get();
    }
  return nullptr;
}

const WorldElements::NamedRule* WorldElements::rule_of(const Part& part) const {
  const auto found = std::find_if(rules_.begin(), rules_.end(),
                                  [&](const NamedRule& each) { return each.rule.get() == part.element; });
  return found == rules_.end() ? nullptr : &*found;
}

void WorldElements::save(const Part& part, ByteWriter& w) const {
  part.element->save(w);
  for (const auto* const slots : {&part.topics, &part.commands})
    for (const auto& slot : *slots) slot->save(w);
  const NamedRule* const rule = rule_of(part);
  if (!rule) return;
  write(w, rule->number);
  write(w, rule->actions.reason);
  write(w, static_cast<std::uint32_t>(rule->actions.requests.size()));
  for (const Request& request : rule->actions.requests) {
    ByteWriter one;
    write_request(one, request);
    write(w, one.buffer());
  }
}

bool WorldElements::load(const Part& part, ByteReader& r) {
  part.element->load(r);
  for (const auto* const slots : {&part.topics, &part.commands})
    for (const auto& slot : *slots) slot->load(r);
  const NamedRule* const rule = rule_of(part);
  if (!rule) return r.ok();
  NamedRule& loaded = rules_[static_cast<std::size_t>(rule - rules_.data())];
  loaded.actions = {};
  read(r, loaded.number);
  read(r, loaded.actions.reason);
  std::uint32_t count = 0;
  read(r, count);
  for (std::uint32_t i = 0; i < count && r.ok(); ++i) {
    std::vector<std::byte> bytes;
    read(r, bytes);
    ByteReader one(bytes);
    Request request;
    if (!r.ok() || !read_request(one, request)) return false;
    loaded.actions.requests.push_back(std::move(request));
  }
  return r.ok();
}

}  // namespace sandlot
