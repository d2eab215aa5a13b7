#pragma once
/// Named values: every number of a running simulation by its address, `rover.pose.x`, `rover/laser.ranges[3]`.
///
///   sim.time|tick|revision|errors                   simulated time [s], tick, revision of the Model, factor on all errors
///   values.NAME or NAME                             a value that the scenario names
///   criterion, red.criterion                        what the run and team red are judged by
///   rover.pose.x|y|z|roll|pitch|yaw                 of the model frame in the world [m, rad]
///   rover.twist.linear.x, .angular.z                of the first link, in the world [m/s, rad/s]
///   rover.errors                                    factor on the errors of all its devices
///   rover.fuel                                      a property that the scenario gives it
///   rover.in.AREA, rover.overlaps.AREA              1 when its origin, a part of its collisions, lies in a marker; else 0
///   rover.links.NAME.pose.x, .twist.linear.x        of a link, in the world
///   rover.joints.NAME.position|velocity|effort      [rad or m, ... per s, Nm or N]
///   rover/laser.PATH                                a device: its reading, else a parameter, else its state, else
///                                                   sample (index of the next one) or count (messages so far)
///   rover/laser.reading.PATH, .parameter.PATH, .state.PATH      where one hides another
///   rover/laser/ranges.PATH                         the message of one level, by the topic's name; also commands
///   media/air.PATH, rules/goals.PATH                an element of the world: a parameter, else its state
///   rover/controller.PATH                           a program: a parameter, else its state, else steps
///   rover/controller/estimate.PATH                  a message that the program publishes, by the topic's name
///   red/coach.PATH                                  a program of team red, and its topics, likewise
///   red*.pose.x, red*/laser.PATH                    in aggregates alone: of every robot or object whose name fits, in the order
///                                                   in which they came into the world
///
/// Reading changes nothing. An address once found follows its thing through spawns, deletions and level changes; what
/// is gone, has not been measured yet or lies beyond the end of a list has no value.
/// Threads   read() belongs to the thread that calls tick(), between ticks or in observers and rules.
/// Cost      read() compares names along the path, and allocates only after the Model has changed, and for overlaps.
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "base/values.h"
#include "sim/watch/expression.h"
#include "sim/world/simulation.h"

namespace sandlot {

class NamedValue {
 public:
  /// An error names the nearest address.
  static Result<NamedValue> find(const Simulation& simulation, std::string_view address);
  /// As find(), but what is not there (any more) has no value instead: after a restore.
  static NamedValue find_or_wait(const Simulation& simulation, std::string_view address);

  const std::string& address() const { return address_; }
  const std::string& unit() const { return unit_; }
  /// The value now, or nothing.
  std::optional<double> read();
  /// Whether the number of the latest read() is an infinity or NaN that the scenario's own expression made, as 1 / 0 does.
  bool is_broken() const;

 private:
  friend class SimulationNames;
  enum class What : std::uint8_t {
    nothing,
    time,
    tick,
    revision,
    all_errors,
    errors,
    property,
    named,
    criterion,
    model_pose,
    body_pose,
    body_twist,
    inside,
    overlap,
    joint,
    topic,
    topic_count,
    topic_stamp,
    topic_waiting,
    parameter,
    state,
    sample,
    program_parameter,
    program_state,
    steps,
    element_parameter,
    element_state,
  };
  NamedValue(const Simulation& simulation, std::string address)
      : simulation_(&simulation), address_(std::move(address)) {}
  /// Finds what the address means now; false: nothing.
  bool resolve();
  bool resolve_thing(const Simulation::Entity& entity);
  bool resolve_device(const Simulation::Device& device);
  bool resolve_program(const Simulation::ProgramEntry& program);
  bool resolve_criterion(std::string_view team);
  /// A topic by its name, or a program by its path.
  bool resolve_topic(const TopicBase& topic);
  bool resolve_programs(const Simulation::ProgramEntries& programs, std::string_view thing);
  bool resolve_element(const Element& element);
  bool take(What what, std::size_t skip, const ValueFound& found);
  ValueFound look() const;

  const Simulation* simulation_;
  std::string address_, unit_;
  ValuePath path_;
  std::size_t skip_ = 0;  ///< steps of the path that chose `what_`
  What what_ = What::nothing;
  std::uint64_t revision_ = 0;
  const Simulation::Entity* entity_ = nullptr;
  const Simulation::Device* device_ = nullptr;
  const Simulation::ProgramEntry* program_ = nullptr;
  const TopicBase* topic_ = nullptr;
  const Element* element_ = nullptr;
  const Marker* marker_ = nullptr;
  std::string team_;         ///< of a criterion
  std::uint32_t index_ = 0;  ///< of a body, joint, property or named value
};

/// Calls `visit` for every address of one entity (a robot or object with all its devices), or of the whole simulation
/// when `entity` is "". Lists of numbers are one entry. Static things are left out of the whole.
void list_values(const Simulation& simulation, std::string_view entity, const ValueVisit& visit);

/// The error for an address that names nothing: what it was meant to be.
Error no_such_value(const Simulation& simulation, std::string_view address);

/// The error for "in.AREA" or "overlaps.AREA" of something, where AREA is not a marker.
std::optional<Error> no_such_marker(const Simulation& simulation, std::string_view path);

/// "rover.pose.x" of "/rover.pose.x": people copy the names of topics.
inline std::string_view without_slash(std::string_view address) {
  return address.substr(0, 1) == "/" ? address.substr(1) : address;
}

/// An expression over a simulation's values.
class ValueExpression {
 public:
  /// @param known  further addresses that may be written, although they may name nothing now
  static Result<ValueExpression> compile(const Simulation& simulation, std::string_view text,
                                         const Place& place = {}, std::span<const std::string> known = {});
  const std::string& text() const { return expression_.text(); }
  int nesting() const { return expression_.nesting(); }
  /// Values that an evaluation reads in the world as it is.
  std::size_t reads() const;
  /// What it reads: addresses, and those of aggregates with their `*`.
  std::vector<std::string> addresses() const;
  /// The unit when the expression is nothing but an address; "" else.
  std::string unit() const;
  /// Nothing when one of the addresses has no value now.
  std::optional<Expression::Evaluated> evaluate();
  /// Finds its addresses again, where some were known before what they name was there.
  void look_up();

 private:
  /// Values of the things of a pattern, found anew when the Model has changed.
  struct Population {
    std::optional<std::uint64_t> revision;
    std::size_t things = 0;
    std::vector<NamedValue> values;
    std::vector<double> numbers;
  };
  ValueExpression(const Simulation& simulation, Expression expression);
  void look(const Expression::Pattern& pattern, Population& population) const;

  const Simulation* simulation_;
  Expression expression_;
  std::vector<NamedValue> inputs_;
  std::vector<double> numbers_;
  std::vector<Population> populations_;  ///< one per pattern
  std::vector<Expression::Table> tables_;
};

}  // namespace sandlot
