#include "controllers/soccer_player/soccer_player.h"

#include <gtest/gtest.h>

#include "base/math.h"
#include "base/random.h"
#include "controllers/soccer_player/game.h"
#include "controllers/soccer_player/localisation.h"
#include "controllers/soccer_player/packet.h"
#include "controllers/soccer_player/tracking.h"

namespace sandlot::controllers::soccer_player {
namespace {

/// A robot whose eye reports objects, with drive, kicker, radio and link to the referee.
struct Rig {
  SoccerPlayer player;
  Topic<msg::Odometry> odometry{"/cyan2/drive/ideal"};
  Topic<msg::ObjectArray> eye{"/cyan2/eye/objects"};
  Topic<msg::Float64> compass{"/cyan2/compass/heading"};
  Topic<msg::RadioReceptionArray> radio{"/cyan2/radio/packets"};
  Topic<msg::RefereeState> referee{"/cyan2/referee/state"};
  std::vector<std::uint64_t> seen{0, 0, 0, 0, 0};
  Command cmd;
  Outputs outputs{"cyan2/player"};
  double now_s = 0;

  explicit Rig(Keys keys, const std::string& name = "cyan2") {
    Description robot;
    robot.robot = name;
    robot.control_period_s = 0.04;
    robot.readings = {{"drive", "ideal", msg::Odometry::ros_type, 0, {}},
                      {"eye", "objects", msg::ObjectArray::ros_type, 1, {}},
                      {"compass", "heading", msg::Float64::ros_type, 2, {}},
                      {"radio", "packets", msg::RadioReceptionArray::ros_type, 3, {}},
                      {"referee", "state", msg::RefereeState::ros_type, 4, {}}};
    robot.actuators = {{"drive", "ideal", msg::Twist::ros_type, 0, {}},
                       {"kicker", "kick", msg::Float64::ros_type, 1, {}},
                       {"radio", "send", msg::RadioPacket::ros_type, 2, {}}};
    player.spec = std::move(keys);
    const Status ready = player.init(robot, outputs);
    EXPECT_TRUE(static_cast<bool>(ready)) << (ready ? "" : ready.error().text());
    cmd.bind(&outputs);
  }
  static Keys placed(double x, double y, double yaw) {
    Keys keys;
    keys.placed = true;
    keys.start = {x, y, yaw};
    return keys;
  }
  void put(const std::string& label, double x_B, double y_B) {
    msg::Object& object = eye.message.objects.emplace_back();
    object.label = label;
    object.position = {x_B, y_B, 0};
    object.range = math::hypot(x_B, y_B);
  }
  void step() {
    now_s += 0.04;
    const Time now = Time::from_s(now_s);
    odometry.publish(now);
    eye.publish(now);
    compass.message.data = player.state.begun ? compass.message.data : player.spec.start[2];
    compass.publish(now);
    if (!radio.message.packets.empty()) radio.publish(now);
    if (!referee.message.phase.empty()) referee.publish(now);
    const TopicBase* const topics[] = {&odometry, &eye, &compass, &radio, &referee};
    cmd.clear();
    player.step(Observation(now, topics, seen, Stream(1, 2, Purpose::controller, 0)), cmd);
    seen = {odometry.count, eye.count, compass.count, radio.count, referee.count};
    radio.message.packets.clear();
  }
  template <class M>
  std::optional<M> order(std::uint32_t slot) const {
    for (const Command::Order& each : cmd.orders()) {
      if (each.slot != slot) continue;
      M message;
      ByteReader r(cmd.bytes(each));
      read(r, message);
      return message;
    }
    return {};
  }
  msg::Twist twist() const { return order<msg::Twist>(0).value_or(msg::Twist{.linear = {-99, 0, 0}}); }
};

TEST(SoccerPlayer, FindsItsPlaceByAGoalAndACompass) {
  Keys keys;
  Rig rig(keys);
  // At (3, 2), looking along y: the goal at (11.3, 0) is 8.3 m to the right and 2 m behind.
  rig.compass.message.data = math::pi / 2;
  rig.player.spec.start[2] = math::pi / 2;
  rig.put("goal_magenta", -2, -8.3);
  rig.step();
  EXPECT_TRUE(rig.player.state.self.known);
  EXPECT_NEAR(rig.player.state.self.at.x, 3, 1e-9);
  EXPECT_NEAR(rig.player.state.self.at.y, 2, 1e-9);
}

TEST(SoccerPlayer, RefusesAFixThatIsFarOffUntilTenSayTheSame) {
  Self self;
  fix_heading(self, 0, 0.01);
  fix_place(self, {{1, 1, 0}, 0.01, 0, 0.01});
  for (int i = 0; i < 9; ++i) fix_place(self, {{5, 1, 0}, 0.01, 0, 0.01});
  EXPECT_EQ(self.at.x, 1);
  fix_place(self, {{5, 1, 0}, 0.01, 0, 0.01});
  fix_place(self, {{5, 1, 0}, 0.01, 0, 0.01});
  EXPECT_EQ(self.at.x, 5);
}

TEST(SoccerPlayer, TwoFixesWeighByTheirVariances) {
  Self self;
  fix_place(self, {{0, 0, 0}, 0.04, 0, 0.09});
  fix_place(self, {{0.1, 0.1, 0}, 0.04, 0, 0.01});
  EXPECT_NEAR(self.at.x, 0.05, 1e-12);  // equal variances: the middle
  EXPECT_NEAR(self.at.y, 0.09, 1e-12);  // 0.09 / (0.09 + 0.01)
  EXPECT_NEAR(self.var_xx, 0.02, 1e-12);
  EXPECT_NEAR(self.var_yy, 0.009, 1e-12);
}

TEST(SoccerPlayer, TracksABallThatRollsAndStartsAnewAfterAKick) {
  Ball ball;
  double now_s = 0;
  for (; now_s < 2; now_s += 0.04) {
    predict_ball(ball, 0.04);
    see_ball(ball, {2 * now_s, 1, 0}, 0.05, now_s);
  }
  EXPECT_NEAR(ball.velocity.x, 2, 0.4);
  EXPECT_NEAR(ball.velocity.y, 0, 0.1);
  // Kicked away: two sightings far off.
  for (int i = 0; i < 2; ++i) see_ball(ball, {4, 4, 0}, 0.05, now_s);
  EXPECT_EQ(ball.at, (Vec3{4, 4, 0}));
}

TEST(SoccerPlayer, ARollingBallStopsAfterItsWay) {
  // v^2 / (2 a) = 1 / 0.5
  EXPECT_NEAR(ball_after({}, {1, 0, 0}, 100).x, 2, 1e-12);
  EXPECT_NEAR(ball_after({}, {1, 0, 0}, 1).x, 1 - 0.125, 1e-12);
}

TEST(SoccerPlayer, PacketsComeBackAsTheyWereAndForgedOnesAreRefused) {
  Mate mate;
  mate.number = 3;
  mate.role = Role::supporter;
  mate.at = {-10.998, 6.5, 0};
  mate.ball = {1.25, -0.5, 0};
  mate.ball_known = true;
  mate.cost_s = 2.5;
  mate.ball_seen_s = 9;
  std::vector<std::uint8_t> bytes;
  write_packet(bytes, mate, 10);
  EXPECT_EQ(bytes.size(), 32u);
  const auto back = read_packet(bytes, 20);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->number, 3);
  EXPECT_EQ(back->role, Role::supporter);
  EXPECT_NEAR(back->at.x, -10.998, 0.002);
  EXPECT_NEAR(back->ball.y, -0.5, 0.002);
  EXPECT_NEAR(back->cost_s, 2.5, 0.01);
  EXPECT_NEAR(back->ball_seen_s, 19, 0.01);
  bytes[4] = 77;
  EXPECT_FALSE(read_packet(bytes, 20));
  bytes[4] = 1;
  bytes[3] = 0;
  EXPECT_FALSE(read_packet(bytes, 20));
  bytes.pop_back();
  EXPECT_FALSE(read_packet(bytes, 20));
}

TEST(SoccerPlayer, GoesForTheBallAndKicksItAtTheGoal) {
  Rig rig(Rig::placed(6, 0, 0));
  rig.put("ball", 0.34, 0);
  rig.step();
  const auto kick = rig.order<msg::Float64>(1);
  ASSERT_TRUE(kick);
  EXPECT_NEAR(kick->data, ball_mass_kg * rig.player.spec.shot_speed_mps, 0.1);
  EXPECT_EQ(rig.player.state.memory.role, Role::attacker);
}

TEST(SoccerPlayer, DoesNotKickAtItsOwnGoal) {
  Rig rig(Rig::placed(-6, 0, math::pi));
  rig.put("ball", 0.34, 0);
  for (int i = 0; i < 5; ++i) {
    rig.step();
    EXPECT_FALSE(rig.order<msg::Float64>(1));
  }
}

TEST(SoccerPlayer, LeavesTheBallToATeamMateThatIsNearer) {
  Rig rig(Rig::placed(-3, 0, 0));
  Mate mate;
  mate.number = 3;
  mate.at = {1.4, 0, 0};
  mate.cost_s = 0.2;
  msg::RadioReception& packet = rig.radio.message.packets.emplace_back();
  packet.from = "cyan3", packet.to = "cyan";
  write_packet(packet.data, mate, 0);
  rig.put("ball", 5, 0);
  rig.step();
  EXPECT_EQ(rig.player.state.memory.role, Role::supporter);
  // Of the other team's packets none counts.
  Rig other(Rig::placed(-3, 0, 0));
  msg::RadioReception& foreign = other.radio.message.packets.emplace_back();
  foreign.from = "magenta3", foreign.to = "magenta";
  write_packet(foreign.data, mate, 0);
  other.put("ball", 5, 0);
  other.step();
  EXPECT_EQ(other.player.state.memory.role, Role::attacker);
}

TEST(SoccerPlayer, StandsStillAtStopAndPlaysWithoutAReferee) {
  Rig rig(Rig::placed(-3, 0, 0));
  rig.put("ball", 2, 0);
  rig.step();
  EXPECT_GT(rig.twist().linear.x, 0);
  rig.referee.message.phase = "stopped";
  for (int i = 0; i < 50; ++i) rig.step();
  EXPECT_NEAR(norm(rig.twist().linear), 0, 1e-6);
}

TEST(SoccerPlayer, KeepsItsDistanceAtASetPieceOfTheOpponents) {
  Rig rig(Rig::placed(-1.5, 0, 0));
  rig.put("ball", 1.5, 0);
  rig.referee.message.phase = "preparing";
  rig.referee.message.set_piece = "kickoff";
  rig.referee.message.team = "magenta";
  for (int i = 0; i < 5; ++i) rig.step();
  EXPECT_LT(rig.twist().linear.x, 0);  // away from it, backwards
}

TEST(SoccerPlayer, ChangesSidesAtHalfTime) {
  Rig rig(Rig::placed(-3, 0, 0));
  rig.put("ball", 3, 0);
  rig.referee.message.phase = "running";
  rig.referee.message.in_play = true;
  rig.referee.message.teams.resize(1);
  rig.referee.message.teams[0].name = "cyan";
  rig.referee.message.teams[0].attacks_positive_x = false;
  rig.step();
  EXPECT_FALSE(rig.player.state.game.positive);
  EXPECT_LT(rig.player.state.memory.at.x, 0);  // the goal is at negative x now
}

TEST(SoccerPlayer, TheKeeperMeetsAShotWhereItCrosses) {
  Rig rig(Rig::placed(-10.5, 0, 0), "cyan1");
  // Straight at a point 0.8 m to the left of the keeper, with 5 m/s.
  for (int i = 0; i < 12; ++i) {
    rig.eye.message.objects.clear();
    rig.put("ball", 6 - 5 * 0.04 * i, 0.8);
    rig.step();
  }
  EXPECT_EQ(rig.player.state.memory.role, Role::keeper);
  EXPECT_GT(rig.twist().linear.y, 0.5);
  EXPECT_LT(std::abs(rig.twist().linear.x), 0.5);
}

TEST(SoccerPlayer, WordsOfTheRefereeMakeTheGame) {
  Game game;
  msg::RefereeCommand word;
  word.sequence = 1, word.command = "STOP";
  hear_command(game, word, "cyan", 2, {}, 1);
  EXPECT_EQ(game.phase, Phase::stopped);
  word.sequence = 2, word.command = "THROWIN", word.team = "cyan";
  hear_command(game, word, "cyan", 2, {3, 7, 0}, 2);
  EXPECT_EQ(game.piece, Piece::throw_in);
  EXPECT_EQ(game.whose, Whose::ours);
  EXPECT_FALSE(is_open(game, {3, 7, 0}, 2));
  word.sequence = 3, word.command = "START", word.team = "";
  hear_command(game, word, "cyan", 2, {3, 7, 0}, 3);
  EXPECT_FALSE(is_open(game, {3, 7, 0}, 4));
  EXPECT_TRUE(is_open(game, {3, 6, 0}, 4));   // the ball moved
  EXPECT_TRUE(is_open(game, {3, 7, 0}, 11));  // 7 s are over
}

TEST(SoccerPlayer, GoesAroundWhatIsInTheWay) {
  const Moving disc{{1, 0, 0}, {}, 0.5};
  const Vec3 v = around({}, {2, 0, 0}, {&disc, 1});
  EXPECT_GT(std::abs(v.y), 0.5);
  EXPECT_EQ(around({}, {-2, 0, 0}, {&disc, 1}), (Vec3{-2, 0, 0}));
}

TEST(SoccerPlayer, ADriveThatCannotMoveSidewaysTurnsFirst) {
  Self self;
  const msg::Twist sideways = drive(self, {0, 1, 0}, 0, {}, true);
  EXPECT_NEAR(sideways.linear.y, 1, 1e-12);
  const msg::Twist turning = drive(self, {0, 1, 0}, 0, {}, false);
  EXPECT_EQ(turning.linear.y, 0);
  EXPECT_EQ(turning.linear.x, 0);
  EXPECT_GT(turning.angular.z, 1);
}

TEST(SoccerPlayer, StateComesBackFromBytesAndTooLongListsAreRefused) {
  Rig rig(Rig::placed(-3, 0, 0));
  rig.put("ball", 2, 0);
  rig.put("robot", 1, 1);
  rig.step();
  ByteWriter w;
  write(w, rig.player.state);
  State back;
  ByteReader r(w.bytes());
  read(r, back);
  ASSERT_TRUE(r.ok());
  ByteWriter again;
  write(again, back);
  EXPECT_TRUE(std::ranges::equal(w.bytes(), again.bytes()));
  EXPECT_EQ(back.robots.size(), 1u);
  EXPECT_TRUE(rig.player.fits());
  rig.player.state.robots.resize(most_obstacles + 1);
  EXPECT_FALSE(rig.player.fits());
}

TEST(SoccerPlayer, ADeviceThatIsNamedMustBeThere) {
  SoccerPlayer player;
  player.spec.handler = "jaws";
  Description robot;
  robot.robot = "cyan2";
  robot.actuators = {{"drive", "ideal", msg::Twist::ros_type, 0, {}}};
  Outputs outputs("cyan2/player");
  const Status ready = player.init(robot, outputs);
  ASSERT_FALSE(ready);
  EXPECT_NE(ready.error().text().find("jaws"), std::string::npos);
}

}  // namespace
}  // namespace sandlot::controllers::soccer_player
