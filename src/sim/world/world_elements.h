#pragma once
/// World elements: the markers, media and rules of a world, made from what the setup declares, and the view of the world that
/// they share.
///
/// State     of each medium and rule is a part of its own, "media/air", "rules/goals", with the requests of the rule that wait
///           for the next tick. Where nothing is declared there are no bytes.
/// Threads   the simulation's.
/// Cost      nothing where nothing is declared.
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "elements/world_view.h"
#include "markers/marker.h"
#include "media/medium.h"
#include "rules/rule.h"
#include "sim/world/delivery_trace.h"
#include "sim/world/parts.h"

namespace sandlot {

class Simulation;
class ValueExpression;
struct SimulationOptions;

class WorldElements final : public WorldView {
 public:
  /// `simulation` must outlive the elements.
  explicit WorldElements(const Simulation& simulation);
  ~WorldElements() override;

  /// Makes all elements, when the entities are there.
  /// @param restored  names may be gone
  /// @param addresses  of expressions: those that may be written although they name nothing now; new ones are appended
  Status build(const SimulationOptions& options, bool restored, std::vector<std::string>& addresses);
  /// Finds what expressions of rules name, once the scenario's values and criteria are there.
  void look_up();
  /// To be called when entities or devices came or went.
  void entities_changed() { changed_ = true; }

  // Phases.
  /// Asks the engine for the contacts that rules need. Comes before the wrenches of a sub-step.
  void watch(Watch& watch);
  /// Adds the forces of media for a sub-step.
  void push(const MediumContext& context, double h_s, std::vector<Wrench>& wrenches);
  /// Takes over the touches of the sub-step that was.
  void note_touches(std::uint32_t substep, double h_s);
  void begin_tick() {
    touches_.clear();
    trace_.clear();
  }
  /// Hands each medium its emissions of the tick.
  /// @param traced  whether deliveries() shall list what arrives
  void deliver(const MediumContext& context, bool traced = false);
  /// Of this tick; empty unless it was traced.
  std::span<const FrameDelivery> deliveries() const { return trace_.deliveries(); }
  void judge(Time now, Time step);
  /// The first reason of a rule to stop, given when it last judged.
  const std::string* stop_reason() const;

  /// A request of a rule that waits.
  struct Waiting {
    Source source;
    std::uint64_t number;  ///< counts the requests of the rule
    Request request;
  };
  /// The requests of the rules, in the order of the rules; they wait no longer.
  std::vector<Waiting> take_requests();

  /// An element that has State and parameters.
  struct Part {
    std::string path;  ///< "rules/goals"
    std::uint64_t key = 0;
    Element* element = nullptr;
    const char* kind = "";
    const char* help = "";  ///< of the kind
    std::vector<FieldInfo> (*describe)() = nullptr;
    std::vector<std::unique_ptr<TopicBase>> topics = {},
                                            commands = {};  ///< of a rule: what it publishes and takes
  };
  /// Media, then rules, each in the order of the file.
  std::span<const Part> parts() const { return parts_; }
  const Part* find_part(std::string_view path) const;
  /// Topic of a rule, "/rules/referee/state", or "rules/referee" for its first one; null: there is none.
  const TopicBase* find_own_topic(std::string_view name) const;
  /// Slot of a rule for orders to "rules/referee" or "rules/referee/word"; null: there is none of that type.
  TopicBase* command_slot(std::string_view target, std::string_view type);
  void save(const Part& part, ByteWriter& w) const;
  /// False: the bytes do not fit.
  bool load(const Part& part, ByteReader& r);

  struct NamedMarker {
    std::string name;
    std::unique_ptr<Marker> marker;
  };
  std::span<const NamedMarker> markers() const { return markers_; }

  // WorldView
  const Engine& engine() const override;
  std::span<const EntityView> entities() const override;
  const EntityView* find_entity(std::string_view name) const override;
  std::vector<std::string> actuators(const EntityView& entity) const override;
  std::optional<BatteryView> battery(const EntityView& entity) const override;
  const Marker* find_marker(std::string_view name) const override;
  const TopicBase* find_topic(std::string_view name) const override;
  std::optional<double> value(std::uint32_t watched) const override;

 private:
  struct Build;
  struct NamedMedium {
    std::unique_ptr<Medium> medium;
    const MediumKind* kind = nullptr;
    std::vector<Receiver> receivers;
    std::vector<std::uint32_t> receivers_by_key;
    std::vector<Emission> emissions;  ///< of this tick
  };
  struct NamedRule {
    std::unique_ptr<Rule> rule;
    const RuleKind* kind = nullptr;
    RuleActions actions;       ///< of the latest judgement
    std::uint64_t number = 0;  ///< of the next request
  };
  const NamedRule* rule_of(const Part& part) const;
  void gather() const;

  const Simulation& sim_;
  std::vector<NamedMarker> markers_;
  mutable std::vector<NamedMedium> media_;
  std::vector<NamedRule> rules_;
  std::vector<Part> parts_;
  RuleKind::Touches touches_wanted_ = RuleKind::Touches::none;
  std::vector<BodyTouch> touches_;  ///< of this tick
  mutable DeliveryTrace trace_;
  mutable std::vector<ValueExpression> watched_;
  mutable std::vector<EntityView> entities_;
  mutable bool changed_ = true;  ///< entities_ and the receivers have to be listed again
};

}  // namespace sandlot
