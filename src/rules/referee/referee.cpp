/// referee: the automatic referee of a match of robot soccer.
///
/// Judges    by truth, with the machine of src/soccer: see docs/soccer_rules.md for the rules as implemented.
/// Robots    of the two teams, with numbers at the end of their names. Each with a device of kind `referee_link` is sent the
///           words and how the game stands. One that is out of play is put beside the field, and its actuators fail as with
///           the failure `dead`; when it may come back, they follow their planned failures again.
/// Topics    `state` a few times a second and when something has changed; `decision` and `word` one per tick while there are
///           any. Orders: `word`, sandlot_msgs/RefereeCommand, from a person or a referee box.
/// Limits    no error of sight. What a robot shows by its ball handler (topic of BallHandlerState) counts as a touch.
/// Cost      a look at all touches of robots, and a few microseconds.
#include <algorithm>
#include <utility>

#include "base/log.h"
#include "base/math.h"
#include "messages/command.h"
#include "messages/messages.h"
#include "rules/rule.h"
#include "soccer/referee.h"

namespace sandlot::rules::referee {
namespace {

constexpr double ball_radius_m = 0.11;
constexpr std::size_t most_pending = 1000, most_words = 100;

struct Spec {
  std::string ball = "ball";
  std::vector<std::string> teams{"cyan", "magenta"};
  std::vector<std::string> titles;
  int kickoff = 0;
  soccer::FieldSize size = soccer::FieldSize::m22x14;
  std::optional<soccer::Dimensions> field;
  std::string link = "referee", handler = "handler";
  double rate_hz = 5;
  bool stop_run = true;
  soccer::Rules rules;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"ball", "", "Name of the ball.", 0, 0, Field::none, 100}, s.ball);
    visit(Field{"teams", "", "Names of the two teams; the first one begins at negative x.", 0, 0, Field::none,
                2, 2},
          s.teams);
    visit(Field{"titles", "", "Names of the teams' software.", 0, 0, Field::none, 2}, s.titles);
    visit(Field{"kickoff", "1", "Team with the first kick-off: 0 or 1.", 0, 1}, s.kickoff);
    visit(Field{"size", "", "Size of the field by the rule book, in metres."}, s.size);
    visit(Field{"field", "", "Dimensions of the field, in place of `size`."}, s.field);
    visit(Field{"link", "", "Name of the device of each robot that receives words.", 0, 0, Field::none, 100},
          s.link);
    visit(
        Field{"handler", "", "Name of the device of each robot that holds the ball.", 0, 0, Field::none, 100},
        s.handler);
    visit(Field{"rate", "Hz", "Reports of the game per second.", 0.01, 1000}, s.rate_hz);
    visit(Field{"stop_run", "", "Whether the end of the game ends the run."}, s.stop_run);
    soccer::Rules::fields(s.rules, visit);
  }
};

struct State {
  soccer::State game;
  Time reported;
  bool reports = false;                         ///< has reported yet
  std::vector<msg::RefereeDecision> decisions;  ///< that wait for their ticks
  std::vector<msg::RefereeCommand> words;

  static void fields(auto& s, auto&& visit) {
    soccer::State::fields(s.game, visit);
    visit(Field{"reported", "s", "Time of the latest report."}, s.reported);
    visit(Field{"reports", "", "Whether there was a report."}, s.reports);
    visit(Field{"waiting_decisions", "", "Decisions that are published in the next ticks."}, s.decisions);
    visit(Field{"waiting_words", "", "Words that are published in the next ticks."}, s.words);
  }
};

/// The digits at the end of a name; 0: none.
int number_of(std::string_view name) {
  std::size_t begin = name.size();
  while (begin > 0 && name[begin - 1] >= '0' && name[begin - 1] <= '9') --begin;
  constexpr std::size_t most_digits = 6;
  int number = 0;
  for (const char digit : name.substr(begin, most_digits)) number = 10 * number + (digit - '0');
  return number;
}

struct Referee {
  using Spec = referee::Spec;
  using State = referee::State;
  Spec spec;
  State state;
  soccer::Dimensions dimensions;
  CommandQueue<msg::RefereeCommand>* orders = nullptr;
  Topic<msg::RefereeState>* state_topic = nullptr;
  Topic<msg::RefereeDecision>* decision_topic = nullptr;
  Topic<msg::RefereeCommand>* word_topic = nullptr;
  // Of this tick
  struct Player {
    soccer::Who who;
    const EntityView* entity = nullptr;
  };
  std::vector<Player> players;
  bool warned = false;  ///< of robots with one number
  std::string name;     ///< of the rule
  soccer::Input input;
  soccer::Output output;

  Status init(const ElementBuild& build) {
    SL_TRY(build.expect_entity(spec.ball, "ball"));
    if (spec.teams[0] == spec.teams[1])
      return build.error("teams", "both teams are called '" + spec.teams[0] + "'",
                         "give each a name of its own");
    dimensions = spec.field ? *spec.field : soccer::dimensions_of(spec.size);
    if (dimensions.goal_width_m >= dimensions.width_m || 2 * dimensions.penalty_mark_m >= dimensions.length_m)
      return build.error("field", "goals or penalty marks do not fit into the field",
                         "enlarge width or length");
    spec.titles.resize(2);
    name = build.decl.name;
    state.game.first_kickoff = static_cast<std::int8_t>(spec.kickoff);
    orders = build.accept_queue<msg::RefereeCommand>("word", most_words);
    state_topic = build.publish<msg::RefereeState>("state");
    decision_topic = build.publish<msg::RefereeDecision>("decision");
    word_topic = build.publish<msg::RefereeCommand>("word");
    return {};
  }
  bool fits() const {
    return state.game.fits() && state.decisions.size() <= most_pending && state.words.size() <= most_pending;
  }

  const std::string& team_name(int team) const {
    static const std::string none;
    return team < 0 ? none : spec.teams[static_cast<std::size_t>(team)];
  }
  std::string robot_name(soccer::Who who) const {
    if (!who) return {};
    const Player* const player = find(who);
    return player ? player->entity->instance->name : team_name(who.team) + std::to_string(who.number);
  }
  const Player* find(soccer::Who who) const {
    for (const Player& each : players)
      if (each.who == who) return &each;
    return nullptr;
  }
  const Player* find(std::string_view name) const {
    for (const Player& each : players)
      if (each.entity->instance->name == name) return &each;
    return nullptr;
  }

  // ------------------------------------------------------------------------------------------------------ input

  void look(const RuleContext& context) {
    const WorldView& world = context.world;
    input.dt_s = context.step.s();
    input.tick = context.tick_index;
    const EntityView* const ball = world.find_entity(spec.ball);
    input.has_ball = ball != nullptr;
    if (ball) {
      const BodyState& body = world.engine().states()[world.engine().bodies(ball->id).front().index];
      input.ball_m = body.X_WB.p;
      input.ball_mps = body.V_WB.linear;
    }
    players.clear();
    for (const EntityView& entity : world.entities()) {
      const model::Instance& instance = *entity.instance;
      if (!instance.is_robot) continue;
      const bool first = instance.team == spec.teams[0];
      if (!first && instance.team != spec.teams[1]) continue;
      players.push_back({{first ? std::int8_t{0} : std::int8_t{1}, number_of(instance.name)}, &entity});
    }
    std::stable_sort(players.begin(), players.end(), [](const Player& a, const Player& b) {
      return std::pair(a.who.team, a.who.number) < std::pair(b.who.team, b.who.number);
    });
    // Two robots with one number: the second one is nobody's.
    const auto same = [](const Player& a, const Player& b) { return a.who == b.who; };
    if (const auto two = std::adjacent_find(players.begin(), players.end(), same); two != players.end()) {
      if (!std::exchange(warned, true)) warn_of_twins(two[0], two[1]);
      players.erase(std::unique(two, players.end(), same), players.end());
    }
    input.robots.clear();
    for (const Player& player : players) input.robots.push_back(seen(world, player));
    touches(context);
    input.words.clear();
    for (; !orders->empty(); orders->pop()) {
      const msg::RefereeCommand& order = orders->front();
      std::int8_t team = order.team.empty() ? std::int8_t{-1} : std::int8_t{2};  // 2: unknown
      for (const std::int8_t each : {std::int8_t{0}, std::int8_t{1}})
        if (order.team == team_name(each)) team = each;
      input.words.push_back({order.command, team, order.robot});
    }
  }

  void warn_of_twins(const Player& known, const Player& unknown) const {
    log::warning(
        "rule '" + name + "': robots '" + known.entity->instance->name + "' and '" +
        unknown.entity->instance->name + "' of team '" + team_name(known.who.team) +
        "' have the same number, " + std::to_string(known.who.number) +
        ", so that the second one is not judged; a number is the digits at the end of a name, such as " +
        team_name(known.who.team) + "2");
  }

  soccer::SeenRobot seen(const WorldView& world, const Player& player) const {
    soccer::SeenRobot robot;
    robot.who = player.who;
    const Pose X_WM = world.pose(*player.entity);
    robot.position_m = X_WM.p;
    robot.yaw_rad = yaw_of(X_WM.q);
    robot.tilt_rad = math::acos(std::clamp(rotate(X_WM.q, {0, 0, 1}).z, -1.0, 1.0));
    robot.velocity_mps = world.velocity(*player.entity).linear;
    const auto battery = world.battery(*player.entity);
    robot.out_of_order = battery && battery->empty;
    const TopicBase* const handler = world.find_topic(player.entity->instance->name + "/" + spec.handler);
    if (const auto* const held = topic_cast<msg::BallHandlerState>(handler); held && held->count > 0)
      robot.holds_ball = held->message.engaged &&
                         (held->message.object.empty() || held->message.object == spec.ball);
    return robot;
  }

  void touches(const RuleContext& context) {
    input.touches.clear();
    input.blows.clear();
    const Engine& engine = context.world.engine();
    for (const BodyTouch& touch : context.touches) {
      const std::string_view a = engine.name(touch.a).instance, b = engine.name(touch.b).instance;
      const Player *const at_a = find(a), *const at_b = find(b);
      if (at_a && b == spec.ball) input.touches.push_back({at_a->who});
      else if (at_b && a == spec.ball) input.touches.push_back({at_b->who});
      else if (at_a && at_b && at_a->who.team != at_b->who.team)
        input.blows.push_back({at_a->who, at_b->who, touch.impulse_W_Ns});
    }
  }

  // ----------------------------------------------------------------------------------------------------- output

  void judge(const RuleContext& context, RuleActions& actions) {
    look(context);
    const std::uint64_t words_before = state.game.words;
    soccer::Referee(spec.rules, dimensions, state.game).step(input, output);
    std::uint64_t number = words_before;
    for (const soccer::Word& word : output.words) tell(context, word, ++number, actions);
    for (const soccer::Decision& each : output.decisions)
      if (state.decisions.size() < most_pending) state.decisions.push_back(message_of(context, each));
    for (const soccer::Placement& each : output.placements) put(each, actions);
    for (const soccer::Exclusion& each : output.exclusions) exclude(context, each, actions);
    const bool had_more = !state.decisions.empty() || !state.words.empty();
    publish(context, actions);
    // One decision and one word are published in a tick: the run ends with the last one.
    const bool ends = output.ended || had_more;
    if (ends && state.game.stage == soccer::Stage::ended && state.decisions.empty() && state.words.empty() &&
        spec.stop_run)
      actions.stop("the game has ended: " + result_text());
  }

  std::string result_text() const {
    const auto line = [&](std::uint32_t a, std::uint32_t b) {
      return spec.teams[0] + " " + std::to_string(a) + " : " + std::to_string(b) + " " + spec.teams[1];
    };
    const soccer::TeamRecord &a = state.game.teams[0], &b = state.game.teams[1];
    std::string text = line(state.game.score[0], state.game.score[1]);
    if (a.shots + b.shots > 0)
      text += ", penalty kicks " + std::to_string(a.shots_in) + " : " + std::to_string(b.shots_in);
    return text;
  }

  /// The path of a robot's link; empty: it has none.
  std::string link_of(const WorldView& world, const Player& player) const {
    std::string path = player.entity->instance->name + "/" + spec.link;
    return topic_cast<msg::RefereeCommand>(world.find_topic(path)) ? path : std::string();
  }

  void tell(const RuleContext& context, const soccer::Word& word, std::uint64_t number,
            RuleActions& actions) {
    msg::RefereeCommand message;
    message.header.stamp = context.now;
    message.sequence = number;
    message.command = word.text;
    message.team = team_name(word.team);
    message.robot = word.robot;
    for (const Player& player : players)
      if (const std::string link = link_of(context.world, player); !link.empty())
        actions.request(CommandRequest{link, msg::RefereeCommand::ros_type, command_bytes(message)});
    if (state.words.size() < most_pending) state.words.push_back(std::move(message));
  }

  msg::RefereeDecision message_of(const RuleContext& context, const soccer::Decision& made) const {
    msg::RefereeDecision out;
    out.header.stamp = context.now;
    out.sequence = made.sequence;
    out.tick = made.tick;
    out.stage = name_of(made.stage);
    out.clock = made.clock_s;
    out.rule = name_of(made.law);
    out.command = made.command;
    out.team = team_name(made.team);
    out.robot = robot_name(made.robot);
    out.reason = made.reason;
    out.point = made.point_m;
    out.ball = made.ball_m;
    out.score.assign(made.score.begin(), made.score.end());
    for (const Player& player : players) {
      const Pose X_WM = context.world.pose(*player.entity);
      out.players.push_back({player.entity->instance->name, team_name(player.who.team), player.who.number,
                             X_WM.p.x, X_WM.p.y, yaw_of(X_WM.q)});
    }
    return out;
  }

  void put(const soccer::Placement& placement, RuleActions& actions) const {
    if (!placement.who) {
      const double z = ball_radius_m;
      return actions.request(
          PoseRequest{spec.ball, {{placement.position_m.x, placement.position_m.y, z}, {}}});
    }
    const Player* const player = find(placement.who);
    if (!player) return;
    const model::Instance& instance = *player->entity->instance;
    actions.request(PoseRequest{instance.name,
                                {{placement.position_m.x, placement.position_m.y, instance.X_WM.p.z},
                                 quat_from_rpy(0, 0, placement.yaw_rad)}});
  }

  void exclude(const RuleContext& context, const soccer::Exclusion& exclusion, RuleActions& actions) const {
    const Player* const player = find(exclusion.who);
    if (!player) return;
    const std::string link = link_of(context.world, *player);
    for (const std::string& device : context.world.actuators(*player->entity))
      if (device != link)
        actions.request(
            ParameterRequest{device, "failure", Node::scalar(exclusion.out ? "dead" : "planned")});
  }

  // -------------------------------------------------------------------------------------------------- publishing

  void publish(const RuleContext& context, RuleActions& actions) {
    // What is decided at the beginning waits for the first tick: a message is of a tick, and recordings hold those of ticks.
    if (!state.decisions.empty() && context.tick_index > 0) {
      decision_topic->message = std::move(state.decisions.front());
      state.decisions.erase(state.decisions.begin());
      decision_topic->publish(context.now);
    }
    if (!state.words.empty()) {
      word_topic->message = std::move(state.words.front());
      state.words.erase(state.words.begin());
      word_topic->publish(context.now);
    }
    const bool due = !state.reports || context.now - state.reported >= Time::from_s(1 / spec.rate_hz);
    if (!due && !output.changed) return;
    state.reports = true;
    state.reported = context.now;
    fill(state_topic->message);
    state_topic->publish(context.now);
    for (const Player& player : players)
      if (const std::string link = link_of(context.world, player); !link.empty())
        actions.request(
            CommandRequest{link, msg::RefereeState::ros_type, command_bytes(state_topic->message)});
  }

  void fill(msg::RefereeState& out) const {
    const soccer::State& game = state.game;
    out.stage = name_of(game.stage);
    out.phase = name_of(game.phase);
    out.set_piece = name_of(game.piece);
    out.team = team_name(game.piece == soccer::SetPiece::none ? -1 : game.team);
    out.in_play = game.in_play;
    out.clock = game.clock_s;
    out.remaining = soccer::Referee::remaining_s(spec.rules, game);
    out.last_touch = robot_name(game.touches.last);
    out.commands = game.words;
    out.decisions = game.decisions;
    out.teams.resize(2);
    for (const std::size_t t : {std::size_t{0}, std::size_t{1}}) {
      msg::RefereeTeam& team = out.teams[t];
      team.name = spec.teams[t];
      team.title = spec.titles[t];
      team.score = game.score[t];
      team.attacks_positive_x = game.attacks(static_cast<int>(t)) > 0;
      team.possession = game.teams[t].possession_s;
      team.robots = team.yellow_cards = team.red_cards = 0;
      for (const soccer::RobotRecord& each : game.robots) {
        if (each.who.team != static_cast<int>(t)) continue;
        team.robots += each.absence == soccer::Absence::none && find(each.who);
        team.yellow_cards += each.yellows;
        team.red_cards += each.reds;
      }
    }
  }
};

}  // namespace

extern const RuleKind kind;
constinit const RuleKind kind = make_rule<Referee>({
    .name = "referee",
    .help = "Automatic referee of a match of robot soccer.",
    .touches = RuleKind::Touches::impulses,
});

}  // namespace sandlot::rules::referee
