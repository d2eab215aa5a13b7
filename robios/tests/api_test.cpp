/// Every function of both headers is called by a program in tests/programs that checks what it did; here is what the simulator
/// got to see of it.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>

#include "fake_simulator.h"

namespace {

using fake::OrderKind;

std::string text_of(const std::string& path) {
  std::ifstream file(path);
  std::stringstream text;
  text << file.rdbuf();
  return text.str();
}

std::set<std::string> functions_of(const std::string& generation) {
  const std::string header = text_of("robios/include/robios" + generation + "/eyebot.h");
  const std::regex declared(R"(\n[A-Za-z][A-Za-z ]*[ *]+([A-Z]+[A-Za-z0-9]*)\()");
  std::set<std::string> names;
  for (std::sregex_iterator i(header.begin(), header.end(), declared), end; i != end; ++i)
    names.insert((*i)[1]);
  return names;
}

TEST(RobiosApi, EveryFunctionIsTriedAndHasACost) {
  const std::string costs = text_of("robios/src/costs.def");
  for (const std::string g : {"6", "7"}) {
    std::string programs = text_of("robios/tests/programs/supervisor.c");
    const auto names = functions_of(g);
    EXPECT_GT(names.size(), 100u);
    for (const std::string part : {"screen", "drive", "devices", "camera", "system", "tasks"})
      programs += text_of("robios/tests/programs/r" + g + "_" + part + ".c");
    for (const std::string& name : names) {
      std::string called = name, priced = name;
      if (name == "RADIOCheckAny" || name == "RADIOCheckID") called = priced = "RADIOCheck";
      EXPECT_NE(programs.find(called + "("), std::string::npos) << name << " of RoBIOS " << g;
      EXPECT_NE(costs.find("(" + priced + ", "), std::string::npos) << name << " has no cost";
    }
  }
}

TEST(RobiosApi, HeadersCompileAsEveryKindOfC) {
  const std::string file = fake::scratch() + "/header";
  for (const std::string ending : {".c", ".cpp"})
    std::ofstream(file + ending) << "#include \"eyebot.h\"\nint main(void) { return 0; }\n";
  for (const std::string compiler : {"gcc", "clang"}) {
    if (!fake::compiles("command -v " + compiler)) continue;
    for (const std::string g : {"6", "7"}) {
      for (const std::string kind : {"c89", "c99", "gnu99", "c17", "c2x", "c++98", "c++17", "c++20"}) {
        std::string errors;
        const bool cpp = kind.starts_with("c++");
        EXPECT_TRUE(
            fake::compiles(compiler + " -std=" + kind +
                               " -Wall -Wextra -Werror -pedantic -fsyntax-only -Irobios/include/robios" + g +
                               " " + file + (cpp ? ".cpp" : ".c"),
                           &errors))
            << compiler << " " << kind << " " << g << "\n"
            << errors;
      }
    }
  }
}

/// A program of checks that must all hold.
fake::Result check(fake::Simulator& sim, const std::string& source, int generation, int exit_code = 0) {
  const std::string program = fake::compile(source, generation);
  fake::Result r = sim.run(program);
  EXPECT_EQ(r.exit_code, exit_code) << source << "\n" << program << "\n" << r.output << r.errors;
  return r;
}

void paint(fake::Simulator& sim) {
  sim.paint(640, 480, [](int x, int y) { return std::array<int, 3>{x / 4, y / 4, 7}; });
}

TEST(RobiosApi, ScreenOf7) {
  fake::Simulator sim;
  check(sim, "r7_screen.c", 7);
  EXPECT_EQ(sim.pixel(7, 300), 0x00FF00);
  EXPECT_EQ(sim.pixel(200, 300), 0x008080);
  EXPECT_EQ(sim.lines.at(3), "n = 42");
  EXPECT_EQ(sim.lines.at(4), "next");
  EXPECT_EQ(sim.menu, (std::vector<std::string>{"ONE", "2", "THREE", "FOUR"}));
}

TEST(RobiosApi, ScreenIsShownWhenRefreshed) {
  fake::Simulator sim;
  std::int64_t refreshed = 0;
  sim.on_slot = [&](std::int64_t now) {
    if (refreshed == 0 && sim.pixel(0, 0) == 0xFFFFFF) refreshed = now;
  };
  const auto r = check(sim, "r7_screen.c", 7);
  // Drawing costs some 30 ms, then 0.1 + 0.1 + 0.2 s pass before the refresh.
  EXPECT_GE(refreshed, 300 * fake::millisecond);
  EXPECT_LE(refreshed, r.end_ns);
}

TEST(RobiosApi, DriveOf7) {
  fake::Simulator sim;
  sim.senses().stalled = 2;
  const auto r = check(sim, "r7_drive.c", 7);
  const auto ways = r.of(OrderKind::maneuver);
  ASSERT_EQ(ways.size(), 6u);
  const auto curve = ways[2].as<fake::ManeuverOrder>();
  EXPECT_EQ(curve.kind, 2u);
  EXPECT_DOUBLE_EQ(curve.distance_m, 0.5);
  EXPECT_NEAR(curve.angle_rad, 1.570796, 1e-6);
  EXPECT_DOUBLE_EQ(curve.speed_mps, 0.25);
  const auto point = ways[3].as<fake::ManeuverOrder>();
  EXPECT_EQ(point.kind, 3u);
  EXPECT_DOUBLE_EQ(point.x_m, 0.4);
  EXPECT_DOUBLE_EQ(ways[4].as<fake::ManeuverOrder>().speed_mps, 0.1);
  const auto control = r.of(OrderKind::control);
  ASSERT_EQ(control.size(), 2u);
  EXPECT_DOUBLE_EQ(control[0].as<fake::ControlOrder>().vv, 0.7);
  EXPECT_DOUBLE_EQ(control[0].as<fake::ControlOrder>().tw, 0.1);
  EXPECT_EQ(control[1].as<fake::ControlOrder>().on, 0u);
}

void scan(fake::Simulator& sim) {
  fake::Senses& s = sim.senses();
  s.distance_m[3] = INFINITY;
  s.beams = 360;
  s.lidar_first_rad = -3.14159265358979;
  s.lidar_step_rad = 3.14159265358979 / 180;
  for (int i = 0; i < 360; i++) s.beam_m[i] = static_cast<float>(1 + 0.001 * (i - 180));
}

TEST(RobiosApi, DevicesOf7) {
  fake::Simulator sim;
  scan(sim);
  const auto r = check(sim, "r7_devices.c", 7);
  const auto motors = r.of(OrderKind::motor);
  ASSERT_EQ(motors.size(), 4u);
  EXPECT_EQ(motors[1].as<fake::MotorOrder>().number, 1u);
  EXPECT_DOUBLE_EQ(motors[1].as<fake::MotorOrder>().value, -1);
  EXPECT_DOUBLE_EQ(motors[2].as<fake::MotorOrder>().value, 0.25);
  EXPECT_EQ(motors[3].as<fake::MotorOrder>().mode, 1u);
  EXPECT_NEAR(motors[3].as<fake::MotorOrder>().value, 62.83185, 1e-4);
  const auto servos = r.of(OrderKind::servo);
  ASSERT_EQ(servos.size(), 4u);
  EXPECT_DOUBLE_EQ(servos[0].as<fake::MotorOrder>().value, 1);
  EXPECT_DOUBLE_EQ(servos[1].as<fake::MotorOrder>().value, 0.8);
  EXPECT_DOUBLE_EQ(servos[2].as<fake::MotorOrder>().value, 0.2);
  EXPECT_DOUBLE_EQ(servos[3].as<fake::MotorOrder>().value, 0);
}

TEST(RobiosApi, CameraAndPicturesOf7) {
  fake::Simulator sim;
  paint(sim);
  const auto r = check(sim, "r7_camera.c", 7);
  EXPECT_EQ(r.of(OrderKind::picture).size(), 3u);
}

void answer(fake::Simulator& sim) {
  sim.senses().peers = 2;
  sim.senses().peer[0] = 8;
  sim.senses().peer[1] = 9;
  sim.on_slot = [&sim, sent = false](std::int64_t now) mutable {
    if (sent || !std::ifstream(fake::scratch() + "/out").good()) return;
    if (text_of(fake::scratch() + "/out").find("radio\n") == std::string::npos) return;
    sent = true;
    sim.receive(now + 1000 * fake::millisecond, 9, "answer");
    sim.receive(now + 1000 * fake::millisecond, 8, "second");
    sim.receive(now + 1000 * fake::millisecond, 5, "third");
  };
  sim.receive(500 * fake::millisecond, 9, "before the radio is on");
}

TEST(RobiosApi, SystemOf7) {
  fake::Simulator sim;
  answer(sim);
  sim.senses().bumper[1] = 1;
  sim.senses().battery_V = 9;
  sim.press(0, 4);  // before the program has begun
  sim.press(1700 * fake::millisecond, 1);
  sim.press(1000 * fake::millisecond, 2);
  sim.press(1200 * fake::millisecond, 3);
  sim.press(1200 * fake::millisecond, 4);
  sim.press(1400 * fake::millisecond, 0, 30, 40);
  sim.press(1600 * fake::millisecond, 0, 310, 470);
  const auto r = check(sim, "r7_system.c", 7);
  const auto sent = r.of(OrderKind::radio);
  ASSERT_EQ(sent.size(), 2u);
  EXPECT_EQ(sent[0].as<fake::RadioOrder>().to, 5u);
  EXPECT_EQ(sent[0].payload.substr(sizeof(fake::RadioOrder)), "hello");
  EXPECT_EQ(sent[1].as<fake::RadioOrder>().to, 0u);
  const auto sounds = r.of(OrderKind::sound);
  ASSERT_EQ(sounds.size(), 2u);
  EXPECT_DOUBLE_EQ(sounds[0].as<fake::SoundOrder>().frequency_Hz, 1000);
  EXPECT_EQ(sounds[1].payload.substr(sizeof(fake::SoundOrder)), "song.wav");
}

TEST(RobiosApi, Supervisor) {
  for (const int g : {6, 7}) {
    fake::Simulator sim;
    sim.robot().supervisor = 1;
    sim.senses().entities = 3;
    sim.senses().entity[0] = {1, 1, -0.001, 0, 0, 0};
    sim.senses().entity[1] = {2, 0, 5, 6, 0, 0};
    sim.senses().entity[2] = {3, 1, 1, 2, 0, 1.5707963};
    const auto r = check(sim, "supervisor.c", g);
    const auto moved = r.of(OrderKind::set_entity);
    ASSERT_EQ(moved.size(), 2u);
    EXPECT_EQ(moved[0].as<fake::EntityPose>().id, 1u);
    EXPECT_NEAR(moved[0].as<fake::EntityPose>().phi_rad, 0.785398, 1e-6);
    EXPECT_EQ(moved[1].as<fake::EntityPose>().is_robot, 0u);
    EXPECT_DOUBLE_EQ(moved[1].as<fake::EntityPose>().y_m, 0.4);
  }
}

TEST(RobiosApi, OthersThanSupervisorsMoveNothing) {
  fake::Simulator sim;
  sim.senses().entities = 1;
  sim.senses().entity[0] = {3, 1, 1, 2, 0, 0};
  const auto r = sim.run(fake::compile("supervisor.c", 7));
  EXPECT_TRUE(r.of(OrderKind::set_entity).empty());
}

TEST(RobiosApi, ScreenOf6) {
  fake::Simulator sim;
  sim.robot().screen_width = 128;
  sim.robot().screen_height = 64;
  std::vector<std::string> lines, menu;
  sim.on_slot = [&](std::int64_t now) {
    if (now == 100 * fake::millisecond) lines = sim.lines, menu = sim.menu;
  };
  check(sim, "r6_screen.c", 6);
  EXPECT_EQ(sim.pixel(16, 3), 0);
  EXPECT_EQ(sim.pixel(17, 3), 0xFFFFFF);
  EXPECT_EQ(lines, (std::vector<std::string>{"a12       99", "c", "               x", "text -5",
                                             "hex 0000BEEF34", "   422.50 3.142", "wrap"}));
  EXPECT_EQ(menu, (std::vector<std::string>{"GO", "LONG", "3rd", "END"}));
}

TEST(RobiosApi, DriveOf6) {
  fake::Simulator sim;
  sim.senses().stalled = 1;
  const auto r = check(sim, "r6_drive.c", 6);
  const auto control = r.of(OrderKind::control);
  ASSERT_EQ(control.size(), 2u);
  EXPECT_NEAR(control[0].as<fake::ControlOrder>().vv, 7, 1e-6);
  EXPECT_NEAR(control[0].as<fake::ControlOrder>().tw, 0.1, 1e-6);
  // The drive that is given back stands.
  ASSERT_FALSE(r.of(OrderKind::speed).empty());
  EXPECT_EQ(r.of(OrderKind::speed).back().as<fake::SpeedOrder>().v_mps, 0);
}

TEST(RobiosApi, DevicesOf6) {
  fake::Simulator sim;
  scan(sim);
  sim.robot().bumpers = 3;
  std::string("IR_LF").copy(sim.robot().bumper_names[2], 6);
  sim.senses().bumper[1] = sim.senses().bumper[2] = 1;
  sim.senses().compass_rad = 1.5707963;
  sim.on_slot = [&](std::int64_t now) {
    for (int i = 0; i < 4; i++)
      sim.senses().distance_count[i] = static_cast<std::uint32_t>(now / (50 * fake::millisecond));
  };
  const auto r = check(sim, "r6_devices.c", 6);
  const auto servos = r.of(OrderKind::servo);
  ASSERT_EQ(servos.size(), 2u);
  EXPECT_DOUBLE_EQ(servos[0].as<fake::MotorOrder>().value, 0.2);
  EXPECT_EQ(servos[1].as<fake::MotorOrder>().number, 1u);
  const auto motors = r.of(OrderKind::motor);
  ASSERT_EQ(motors.size(), 3u);
  EXPECT_DOUBLE_EQ(motors[1].as<fake::MotorOrder>().value, -0.5);
  EXPECT_DOUBLE_EQ(motors[2].as<fake::MotorOrder>().value, 0);  // released
}

TEST(RobiosApi, CameraAndPicturesOf6) {
  fake::Simulator sim;
  paint(sim);
  check(sim, "r6_camera.c", 6);
}

TEST(RobiosApi, SystemOf6) {
  fake::Simulator sim;
  answer(sim);
  sim.senses().bumper[1] = sim.senses().bumper[2] = 1;
  sim.press(1000 * fake::millisecond, 2);
  sim.press(1200 * fake::millisecond, 3);
  sim.press(1200 * fake::millisecond, 4);
  sim.press(1700 * fake::millisecond, 1);
  const auto r = check(sim, "r6_system.c", 6, 1);  // OSError ends it
  EXPECT_EQ(r.output, "radio\n0\n");
  EXPECT_NE(r.errors.find("end 7"), std::string::npos);
  EXPECT_EQ(sim.lines.at(1), "careful 5") << sim.lines.at(0);
  ASSERT_EQ(r.of(OrderKind::radio).size(), 1u);
  EXPECT_EQ(r.of(OrderKind::radio)[0].payload.substr(sizeof(fake::RadioOrder)), "abc");
}

}  // namespace
