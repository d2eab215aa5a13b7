#include "controllers/soccer_player/soccer_player.h"

#include <gtest/gtest.h>

#include "base/math.h"
#include "base/random.h"
#include "controllers/soccer_player/aims.h"
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

// ------------------------------------------------------------------------------------------------------------ aims

/// A player with the ball at `at` in a game that runs, looking at the goal of the opponents.
struct WithBall {
  Keys keys;
  Scene scene;
  Memory memory;

  explicit WithBall(Play play, Vec3 at) {
    keys.play = play;
    scene.keys = &keys;
    scene.field = soccer::dimensions_of(keys.size);
    scene.style = style_of(play);
    scene.now_s = 100;
    scene.number = 2;
    scene.ball = at;
    scene.me = at - Vec3{keys.front_m, 0, 0};
    scene.ball_known = scene.holds = scene.has_handler = true;
    memory.held_at = at;
  }
  WithBall& opponent(double x, double y) {
    scene.opponents.push_back({{x, y, 0}, {}, 2 * robot_radius_m});
    return *this;
  }
  WithBall& mate(std::int32_t number, double x, double y) {
    Mate& each = scene.mates.emplace_back();
    each.number = number;
    each.at = {x, y, 0};
    return *this;
  }
  Aim aim() {
    choose_aim(scene, memory);
    return memory.aim;
  }
};

TEST(SoccerPlayer, RoomBesideABallIsWhatOpponentsDoNotReach) {
  WithBall one(Play::passing, {});
  one.opponent(2, 1);
  // The ball is beside it after 2 m / 4 m/s = 0.5 s, of which 0.15 s pass before it starts with 1.2 m/s^2.
  EXPECT_NEAR(room_beside(one.scene, {}, {5, 0, 0}, 4, 0.36, 1.2), 1 - 0.36 - 0.6 * 0.35 * 0.35, 1e-12);
  EXPECT_EQ(room_beside(one.scene, {}, {-5, 0, 0}, 4, 0.36, 1.2), 2) << "it stands behind";
  EXPECT_EQ(room_beside(one.scene, {}, {1, 0, 0}, 4, 0.36, 1.2), 2) << "it stands beyond the end";
}

TEST(SoccerPlayer, AShotGoesPastTheKeeperAndIsBetterFromNear) {
  WithBall empty(Play::passing, {8, 0, 0});
  EXPECT_EQ(best_shot(empty.scene, empty.scene.ball).at.y, 0);
  EXPECT_EQ(best_shot(empty.scene, empty.scene.ball).chance, 1);
  WithBall kept(Play::passing, {8, 0, 0});
  kept.opponent(10.5, 0.4);
  const Shot near = best_shot(kept.scene, {8, 0, 0}), far = best_shot(kept.scene, {1, 0, 0});
  EXPECT_LT(near.at.y, -0.2) << "on the side that the keeper leaves free";
  EXPECT_GT(near.chance, 0.9);
  EXPECT_LT(far.chance, 0.5 * near.chance) << "from far the keeper has time";
}

TEST(SoccerPlayer, WaysOfPlayingDoDifferentThingsWithTheSameBall) {
  const auto midfield = [](Play play) {
    WithBall one(play, {-2, 0, 0});
    one.opponent(-0.6, 0.1).mate(3, 2, 4);
    return one.aim();
  };
  EXPECT_EQ(midfield(Play::run_and_kick), Aim::shot);
  EXPECT_EQ(midfield(Play::passing), Aim::pass);
  EXPECT_NE(midfield(Play::dribbling), Aim::pass);
  for (const Play play : {Play::passing, Play::dribbling, Play::pressing, Play::run_and_kick}) {
    WithBall free(play, {8, 0.5, 0});
    EXPECT_EQ(free.aim(), Aim::shot) << "an open goal";
  }
}

TEST(SoccerPlayer, CarriesTheBallWhereThereIsRoomButNotTooFar) {
  WithBall one(Play::passing, {-3, 0, 0});
  EXPECT_EQ(one.aim(), Aim::dribble);
  EXPECT_GT(one.memory.at.x, one.scene.ball.x);
  // With 2.5 m of the 3 m behind it, it is kicked as it is.
  one.memory.held_at = one.scene.ball - Vec3{2.6, 0, 0};
  EXPECT_NE(one.aim(), Aim::dribble);
  EXPECT_GT(one.memory.tolerance_rad, 1);
}

TEST(SoccerPlayer, SetPiecesArePlayedToOthersSinceGoalsFromThemDoNotCount) {
  WithBall one(Play::passing, {2, 0, 0});
  one.scene.holds = false;
  one.scene.game.piece = Piece::free_kick;
  one.scene.game.whose = Whose::ours;
  one.mate(3, 3, 3);
  one.scene.mates[0].role = Role::supporter;
  one.scene.mates[0].target = {2.5, 3, 0};
  aim_of_piece(one.scene, one.memory);
  EXPECT_EQ(one.memory.aim, Aim::pass);
  EXPECT_EQ(one.memory.at, (Vec3{2.5, 3, 0}));
  one.scene.game.piece = Piece::penalty;
  aim_of_piece(one.scene, one.memory);
  EXPECT_EQ(one.memory.aim, Aim::shot);
}

// ------------------------------------------------------------------------------------------------- robots and goals

TEST(SoccerPlayer, TracksARobotThatDrivesByWithoutMuchLag) {
  std::vector<Obstacle> robots;
  for (int i = 0; i <= 25; ++i) {  // 1.5 m/s for a second
    if (i > 0) predict_robots(robots, 0.04, 0.04 * i);
    see_robot(robots, {0.06 * i, 2, 0}, 0.06, 0.04 * i);
  }
  ASSERT_EQ(robots.size(), 1u);
  EXPECT_NEAR(robots[0].at.x, 1.5, 0.03);
  EXPECT_NEAR(robots[0].velocity.x, 1.5, 0.15);
  // One that is seen 10 m away, by 0.8 m, is the same one; beside it stands another.
  std::vector<Obstacle> far;
  see_robot(far, {10, 0, 0}, 0.44, 0);
  see_robot(far, {10.8, 0, 0}, 0.44, 0.04);
  EXPECT_EQ(far.size(), 1u);
  see_robot(far, {10, 2, 0}, 0.44, 0.08);
  EXPECT_EQ(far.size(), 2u);
}

TEST(SoccerPlayer, KnowsWhichGoalItStandsBeside) {
  Self self;
  self.at = {11.5, 2.8, 0};
  self.yaw_known = self.known = true;
  self.var_xx = self.var_yy = 0.01;
  // The middle of the goal at (11.3, 0) lies behind it there.
  const double goal_x = 11 + 0.5 * soccer::dimensions_of(soccer::FieldSize::m22x14).goal_depth_m;
  const auto fix = place_from_goal(self, soccer::dimensions_of(soccer::FieldSize::m22x14),
                                   {goal_x - 11.5, -2.8, 0});
  ASSERT_TRUE(fix);
  EXPECT_NEAR(fix->at.x, 11.5, 1e-9);
  EXPECT_NEAR(fix->at.y, 2.8, 1e-9);
}

TEST(SoccerPlayer, ComesOutFromBesideAGoalStraight) {
  const auto field = soccer::dimensions_of(soccer::FieldSize::m22x14);
  EXPECT_EQ(beside_goals(field, {11.4, 1.6, 0}, {5, 0, 0}), (Vec3{10.3, 1.6, 0}));
  EXPECT_EQ(beside_goals(field, {-11.4, 0.2, 0}, {-9, 3, 0}), (Vec3{-10.3, 0.2, 0}));
  EXPECT_EQ(beside_goals(field, {10.5, 1.6, 0}, {5, 0, 0}), (Vec3{5, 0, 0}));
  EXPECT_EQ(beside_goals(field, {11.2, 6.5, 0}, {10, 5, 0}), (Vec3{10, 5, 0})) << "at the corner";
}

TEST(SoccerPlayer, MeetsRobotsOfTheOtherTeamSlowly) {
  const auto speed_towards = [](double gap_m) {
    Rig rig(Rig::placed(0, 0, 0));
    rig.put("ball", 4, 0);
    rig.put("robot", gap_m, 0);
    // The robot is where the odometry says: it does not get nearer.
    for (int i = 0; i < 40; ++i) rig.step();
    return norm(rig.player.state.ordered_mps.x * Vec3{1, 0, 0});
  };
  EXPECT_LT(speed_towards(0.6), 0.4) << "it stands before it";
  EXPECT_GT(speed_towards(3), 1.5);
}

TEST(SoccerPlayer, LeavesTheBallAfterItsSetPieceUntilAnotherHasTouchedIt) {
  Rig rig(Rig::placed(-0.34, 0, 0));
  rig.put("ball", 0.34, 0);
  rig.referee.message.phase = "running";
  rig.referee.message.set_piece = "free_kick";
  rig.referee.message.team = "cyan";
  for (int i = 0; i < 3 && rig.player.state.memory.kicks == 0; ++i) rig.step();
  ASSERT_EQ(rig.player.state.memory.kicks, 1u);
  EXPECT_TRUE(rig.player.state.memory.taken);
  rig.referee.message.in_play = true;
  rig.eye.message.objects.clear();
  rig.put("ball", 1.5, 0);
  for (int i = 0; i < 50; ++i) rig.step();
  EXPECT_TRUE(rig.player.state.memory.taken) << "nobody was at the ball for two seconds";
  rig.put("robot", 1.8, 0.1);
  for (int i = 0; i < 5; ++i) rig.step();
  EXPECT_FALSE(rig.player.state.memory.taken);
}

TEST(SoccerPlayer, TheSpotOfASetPieceFollowsTheBallUntilPlayMayGoOn) {
  Game game;
  game.phase = Phase::preparing;
  game.spot = {5, 5, 0};
  settle(game, {1, 1, 0.11});
  EXPECT_EQ(game.spot, (Vec3{1, 1, 0})) << "it was put there";
  settle(game, {1.1, 1, 0.11});
  EXPECT_NEAR(game.spot.x, 1.01, 1e-12) << "a tenth of what is noise";
  game.phase = Phase::running;
  settle(game, {3, 1, 0.11});
  EXPECT_NEAR(game.spot.x, 1.01, 1e-12);
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
