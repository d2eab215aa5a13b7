#include "controllers/sequence/sequence.h"

#include <cmath>

#include "base/text.h"

namespace sandlot::controllers::sequence {
namespace {

/// A packet as it is written in a file.
struct Letter {
  std::string to, data;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"to", "", "Robot or team that it is for; empty: all."}, s.to);
    visit(Field{"data", "", "Content, as a text."}, s.data);
  }
};

/// A maneuver as it is written in a file.
enum class Maneuver : std::uint8_t { straight, turn, curve, to_point, stop };
inline constexpr EnumName<Maneuver> maneuver_names[] = {{"straight", Maneuver::straight},
                                                        {"turn", Maneuver::turn},
                                                        {"curve", Maneuver::curve},
                                                        {"to_point", Maneuver::to_point},
                                                        {"stop", Maneuver::stop}};
constexpr std::span<const EnumName<Maneuver>> enum_names(Maneuver) { return maneuver_names; }
static_assert(static_cast<std::uint8_t>(Maneuver::stop) == msg::DriveManeuver::stop);

struct Piece {
  Maneuver maneuver = Maneuver::straight;
  msg::DriveManeuver message;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"maneuver", "", "Kind of the piece of way.", 0, 0, Field::required}, s.maneuver);
    visit(Field{"distance", "m", "Length of a straight or a curve; negative: backward.", -1e6, 1e6},
          s.message.distance);
    visit(Field{"angle", "rad", "Change of heading of a turn or a curve.", -1e6, 1e6}, s.message.angle);
    visit(Field{"x", "m", "Point ahead.", -1e6, 1e6}, s.message.x);
    visit(Field{"y", "m", "Point to the left.", -1e6, 1e6}, s.message.y);
    visit(Field{"speed", "m/s", "Speed along the way; 0: the drive's largest.", 0, 1e4}, s.message.speed);
    visit(Field{"turning_rate", "rad/s", "Turning rate of a turn; 0: the drive's largest.", 0, 1e4},
          s.message.turning_rate);
  }
};

Result<double> number_of(const Node& node, const std::string& device) {
  double value = 0;
  if (!node.is_scalar() || !parse_number(node.text(), value) || !std::isfinite(value))
    return node.error("the order for '" + device + "' is not a number",
                      "write a number, true, false or [forward, left, turn]", "/steps");
  return value;
}

Result<Sequence::Order> order_of(const Description& robot, double at_s, const Node::Entry& entry) {
  const auto at_key = [&](Error error) {
    error.place = entry.key_place;
    error.path = "/steps";
    return error;
  };
  if (const auto to = robot.actuator<msg::String>(entry.key); to && entry.value.is_scalar())
    return Sequence::Order{at_s, Sequence::Words{*to, {entry.value.text()}}};
  if (const auto to = robot.actuator<msg::RadioPacket>(entry.key)) {
    Letter letter;
    if (entry.value.is_scalar()) letter.data = entry.value.text();
    else if (entry.value.is_map()) SL_TRY(read_fields(entry.value, letter, "/steps"));
    else
      return entry.value.error("the order for '" + entry.key + "' is not a packet",
                               "write a text, or {to: robot or team, data: text}", "/steps");
    return Sequence::Order{at_s,
                           Sequence::Packet{*to, {letter.to, {letter.data.begin(), letter.data.end()}}}};
  }
  if (entry.value.is_map()) {
    Sequence::Way way;
    auto to = robot.actuator<msg::DriveManeuver>(entry.key);
    if (!to) return at_key(std::move(to.error()));
    Piece piece;
    SL_TRY(read_fields(entry.value, piece, "/steps"));
    way.to = *to;
    way.value = piece.message;
    way.value.kind = static_cast<std::uint8_t>(piece.maneuver);
    return Sequence::Order{at_s, way};
  }
  if (entry.value.is_scalar() && (entry.value.text() == "true" || entry.value.text() == "false")) {
    Sequence::Switch order{.value = {entry.value.text() == "true"}};
    auto to = robot.actuator<msg::Bool>(entry.key);
    if (!to) return at_key(std::move(to.error()));
    order.to = *to;
    return Sequence::Order{at_s, order};
  }
  if (!entry.value.is_sequence()) {
    Sequence::Number number;
    SL_ASSIGN(number.value.data, number_of(entry.value, entry.key));
    auto to = robot.actuator<msg::Float64>(entry.key);
    if (!to) return at_key(std::move(to.error()));
    number.to = *to;
    return Sequence::Order{at_s, number};
  }
  const std::vector<Node>& items = entry.value.items();
  if (const auto to = robot.actuator<msg::SpeedHeading>(entry.key); to && items.size() == 2) {
    Sequence::Course course{.to = *to, .value = {}};
    SL_ASSIGN(course.value.speed, number_of(items[0], entry.key));
    SL_ASSIGN(course.value.heading, number_of(items[1], entry.key));
    return Sequence::Order{at_s, course};
  }
  if (items.empty() || items.size() > 3)
    return entry.value.error(
        "the order for '" + entry.key + "' has " + std::to_string(items.size()) + " numbers",
        "write [forward, left, turn]", "/steps");
  Sequence::Motion motion;
  double* const parts[] = {&motion.value.linear.x, &motion.value.linear.y, &motion.value.angular.z};
  for (std::size_t i = 0; i < items.size(); ++i) { SL_ASSIGN(*parts[i], number_of(items[i], entry.key)); }
  auto to = robot.actuator<msg::Twist>(entry.key);
  if (!to) return at_key(std::move(to.error()));
  motion.to = *to;
  return Sequence::Order{at_s, motion};
}

}  // namespace

Status Sequence::init(const Description& robot) {
  double latest_s = 0;
  if (!spec.steps.is_sequence()) return wrong_type(spec.steps, "a list of {at, orders}", "/steps");
  for (const Node& item : spec.steps.items()) {
    Step each;
    SL_TRY(read_fields(item, each, "/steps"));
    if (!each.orders.is_map())
      return each.orders.error("the orders of a step are a map of devices", "write orders: {device: value}",
                               "/steps");
    if (each.at_s < latest_s)
      return each.orders.error("this step comes before the one above it", "give the steps in order of time",
                               "/steps");
    latest_s = each.at_s;
    for (const Node::Entry& entry : each.orders.entries()) {
      SL_ASSIGN(Order order, order_of(robot, each.at_s, entry));
      orders.push_back(order);
    }
  }
  return {};
}

void Sequence::step(const Observation& obs, Command& cmd) {
  // Rounds are counted, not measured: time is integer nanoseconds and the length of a round need not be.
  double into_s = obs.now().s() - static_cast<double>(state.round) * spec.repeat_s;
  while (spec.repeat_s > 0 && into_s >= spec.repeat_s - 1e-9) {
    ++state.round;
    state.next = 0;
    into_s = obs.now().s() - static_cast<double>(state.round) * spec.repeat_s;
  }
  for (; state.next < orders.size() && orders[state.next].at_s <= into_s + 1e-9; ++state.next)
    std::visit([&](const auto& order) { cmd.set(order.to, order.value); }, orders[state.next].what);
}

extern const ControllerKind kind;
constinit const ControllerKind kind = make_controller<Sequence>({
    .name = "sequence",
    .help = "Sends commands to joints, drives, grippers, voices and radios at set times.",
});

}  // namespace sandlot::controllers::sequence
