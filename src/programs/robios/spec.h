#pragma once
/// Keys and State of a RoBIOS program.
#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "base/fields.h"
#include "programs/budget.h"
#include "programs/outside_program.h"
#include "programs/robios/slot.h"

namespace sandlot::programs::robios {

struct Spec {
  std::string program, folder, output;
  int api = 0;
  std::vector<std::string> flags;
  double slot_s = 0.05;
  bool delays = true, supervisor = false;
  double deadline_s = 10;
  AfterRestore after_restore = AfterRestore::restart;
  std::vector<std::string> distances;
  std::optional<double> wheel_diameter_m, track_m;
  double servo_range_rad = 3.14159265358979;
  Budget budget;

  static void fields(auto& s, auto&& visit) {
    visit(Field{"program", "",
                "Program of the robot: a .c or .cpp file, which is compiled, a .py file, a library (.so) or "
                "an executable.",
                0, 0, Field::required, 4096},
          s.program);
    visit(
        Field{
            "folder", "",
            "Folder of the program and its data, all it sees of the machine's files; by default that of the "
            "scenario's file.",
            0, 0, Field::none, 4096},
        s.folder);
    visit(Field{"output", "",
                "Folder for files that the program writes, relative to `folder`; none: they are gone when it "
                "ends.",
                0, 0, Field::none, 4096},
          s.output);
    visit(Field{"api", "1", "Generation of RoBIOS, 6 or 7; 0: by the text of the program, else 7.", 0, 7},
          s.api);
    visit(Field{"flags", "", "Further words for the compiler, such as -DBLUE or a second source.", 0, 0,
                Field::none, 100},
          s.flags);
    visit(Field{"slot", "s", "Time slot: the program senses and orders once in each.", 1e-3, 10}, s.slot_s);
    visit(Field{"delays", "",
                "Whether calls of RoBIOS take the time that they took on the controller; off: none."},
          s.delays);
    visit(Field{"supervisor", "", "Whether the program may look at all robots and objects and move them."},
          s.supervisor);
    visit(Field{"deadline", "s",
                "Wall time that a slot may take; a program that takes longer spins, and is ended.", 1e-2, 600,
                Field::tunable},
          s.deadline_s);
    visit(Field{"after_restore", "",
                "Reaction to a restored or rewound run. restart: the program begins once more; detach: no "
                "orders."},
          s.after_restore);
    visit(Field{"distances", "",
                "Distance sensors by name, in the order of their numbers from 1; an empty name leaves a "
                "number out, "
                "NUMBER=NAME gives another one; by default all, in the order of the robot's description.",
                0, 0, Field::none, sandlot::robios::most_distances},
          s.distances);
    visit(Field{"wheel_diameter", "m", "Diameter of the wheels; by default that of the drive.", 1e-4, 100},
          s.wheel_diameter_m);
    visit(Field{"track", "m", "Distance between left and right wheels; by default that of the drive.", 1e-3,
                1000},
          s.track_m);
    visit(Field{"servo_range", "rad", "Angle between the ends of a servo; 0 lies in the middle.", 1e-3, 100},
          s.servo_range_rad);
    Budget::fields(s.budget, visit);
  }
};

/// A radio message that waits for the program's next turn.
struct Received {
  std::uint32_t from = 0;
  std::vector<std::uint8_t> data;
  static void fields(auto& s, auto&& visit) {
    visit(Field{"from", "1", "Number of the sender."}, s.from);
    visit(Field{"data", "", "Content."}, s.data);
  }
};

struct State {
  std::uint64_t turns = 0, refused = 0;
  std::uint8_t running = 0, ended = 0;
  std::int32_t exit_code = 0;
  std::int64_t now_ns = 0, until_ns = 0;
  std::uint32_t events = 0;
  std::uint64_t keys = 0, pictures = 0;
  std::uint64_t receptions = 0;
  std::uint32_t offered = 0, dropped = 0;
  std::vector<Received> inbox;
  std::vector<std::byte> held;
  std::uint32_t number = 0;
  std::vector<std::string> robots;
  std::array<double, 3> odometry{}, origin{};
  std::array<double, 4> wheels{};

  static void fields(auto& s, auto&& visit) {
    visit(Field{"turns", "1", "Number of turns that the program took."}, s.turns);
    visit(Field{"refused", "1", "Number of orders that could not be carried out."}, s.refused);
    visit(Field{"running", "1", "Whether the program has the turn (1)."}, s.running);
    visit(Field{"ended", "1",
                "Whether the program has ended: 1 by itself, 2 it was killed or crashed, 3 it spun."},
          s.ended);
    visit(Field{"exit_code", "1", "Code with which it ended by itself."}, s.exit_code);
    visit(Field{"now", "ns", "Beginning of its latest turn."}, s.now_ns);
    visit(Field{"until", "ns", "Time until which it waits at the longest."}, s.until_ns);
    visit(Field{"events", "1", "Events that end the wait: 1 key, 2 radio, 4 drive, 8 picture."}, s.events);
    visit(Field{"keys", "1", "Number of key presses that it has seen."}, s.keys);
    visit(Field{"pictures", "1", "Number of pictures that it has seen."}, s.pictures);
    visit(Field{"receptions", "1", "Number of the radio's messages that were looked at."}, s.receptions);
    visit(Field{"offered", "1", "Number of waiting messages that its turn has brought."}, s.offered);
    visit(Field{"dropped", "1", "Number of messages since its turn that found no room."}, s.dropped);
    visit(Field{"inbox", "", "Messages that wait."}, s.inbox);
    visit(Field{"held", "", "Orders of its latest turn that act at the end of its slot."}, s.held);
    visit(Field{"number", "1", "Number of the robot, and of its radio."}, s.number);
    visit(Field{"robots", "", "Names of the robots, by number."}, s.robots);
    visit(Field{"odometry", "", "Odometry at its latest turn: x [m], y [m], heading [rad]."}, s.odometry);
    visit(Field{"origin", "", "Place that its own odometry counts from: x [m], y [m], heading [rad]."},
          s.origin);
    visit(Field{"wheels", "m/s", "Speeds ordered of the motors that are wheels of the drive."}, s.wheels);
  }
};

}  // namespace sandlot::programs::robios
