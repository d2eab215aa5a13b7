"""Programs and files as they are found elsewhere: what public programs for EyeSim do that ours do not. All texts are our own."""
import csv
import math
import os
import subprocess
import tempfile
import unittest

import sandbox

ROOT = os.path.dirname(os.path.dirname(os.path.abspath(__file__)))
SANDLOT = os.path.abspath(os.environ.get("SANDLOT_BIN", os.path.join(ROOT, "build/release/sandlot")))


class Found(unittest.TestCase):
    def setUp(self):
        sandbox.skip_without(self)
        self.scratch = tempfile.TemporaryDirectory()
        self.addCleanup(self.scratch.cleanup)
        os.chmod(self.scratch.name, 0o755)  # programs of root run as nobody
        self.write("room.wld", "floor 4000 4000\n0 0 4000 0\n4000 0 4000 4000\n4000 4000 0 4000\n0 4000 0 0\n")

    def path(self, name):
        return os.path.join(self.scratch.name, name)

    def write(self, name, text):
        os.makedirs(os.path.dirname(self.path(name)), exist_ok=True)
        with open(self.path(name), "w") as file:
            file.write(text)
        return self.path(name)

    def run_sim(self, sim, duration_s, *arguments, robot="S4"):
        """@return what the program printed, and rows of x, y, yaw [m, rad], 20 per second"""
        log = self.path("log.csv")
        values = ",".join(f"{robot}.pose.{part}" for part in ("x", "y", "yaw"))
        done = subprocess.run([SANDLOT, "run", sim, "--duration", f"{duration_s}s", "--log", log, "--log-values", values,
                               "--log-rate", "20 Hz", *arguments], capture_output=True, text=True, timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)
        mark = f"info: {robot}/controller: "
        printed = [line[len(mark):] for line in done.stderr.splitlines() if line.startswith(mark)]
        with open(log, newline="") as file:
            rows = [[float(cell) for cell in row[1:]] for row in list(csv.reader(file))[1:]]
        return printed, rows

    def run_program(self, name, text, duration_s=2.0, *arguments):
        self.write(name, text)
        return self.run_sim(self.write("x.sim", f"world room.wld\nS4 1000 1000 0 {name}\n"), duration_s, *arguments)


class Files(Found):
    PROGRAM = r"""
#include "eyebot.h"
int main() {
  FILE* log = fopen("curve.csv", "w");  /* nobody looks whether it is open */
  for (int i = 1; i <= 10; i++) fprintf(log, "%d\n", i * i);
  fclose(log);
  log = fopen("./way.txt", "a");
  fprintf(log, "30 40\n");
  fclose(log);
  log = fopen("/home/pi/speed.csv", "w");
  fprintf(log, "1\n");
  fclose(log);
  int sum = 0, n, x, y, points = 0;
  log = fopen("curve.csv", "r");
  while (fscanf(log, "%d", &n) == 1) sum += n;
  fclose(log);
  log = fopen("way.txt", "r");
  while (fscanf(log, "%d %d", &x, &y) == 2) points++;
  fclose(log);
  printf("sum %d points %d\n", sum, points);
  remove("curve.csv");
  printf("%s\n", fopen("curve.csv", "r") ? "still there" : "gone");
  printf("%s\n", fopen("gone/never.txt", "r") ? "there" : "not there");
  return 0;
}
"""

    def test_that_are_written_can_be_read_again(self):
        self.write("way.txt", "10 20\n")
        printed, _ = self.run_program("logs.c", self.PROGRAM)
        # 1 + 4 + ... + 100 = 385; one point of ours, one that was added.
        self.assertEqual(printed, ["sum 385 points 2", "gone", "not there"])
        with open(self.path("way.txt")) as file:
            self.assertEqual(file.read(), "10 20\n")
        self.assertFalse(os.path.exists(self.path("curve.csv")))

    def test_go_into_the_output_folder(self):
        self.write("way.txt", "10 20\n")
        self.run_program("logs.c", self.PROGRAM, 2.0, "--set", "robots.S4.controller.output=out")
        with open(self.path("out/way.txt")) as file:
            self.assertEqual(file.read(), "10 20\n30 40\n")
        with open(self.path("out/home/pi/speed.csv")) as file:
            self.assertEqual(file.read(), "1\n")

    def test_are_written_by_streams(self):
        printed, _ = self.run_program("stream.cpp", r"""
#include "eyebot++.h"
#include <fstream>
#include <iostream>
int main() {
  std::ofstream("a.txt") << "forty two";
  std::ifstream in("a.txt");
  std::string one, two;
  in >> one >> two;
  std::cout << two << one << std::endl;
}
""")
        self.assertEqual(printed, ["twoforty"])


class Sources(Found):
    def test_include_from_folders_above(self):
        self.write("points.hpp", '#pragma once\n#include <unordered_set>\n#include "more/size.hpp"\n'
                   "inline bool has(std::unordered_set<int> const& all, int i) { return all.contains(i); }\n")
        self.write("more/size.hpp", "constexpr int size = 7;\n")
        self.write("lab/one/room.wld", "floor 2000 2000\n")
        self.write("lab/one/near.cpp", '#include "../../points.hpp"\n#include "eyebot++.h"\n'
                   'int main() { LCDPrintf("x"); printf("%d %d\\n", size, has({1, 2}, 2)); }\n')
        sim = self.write("lab/one/x.sim", "world room.wld\nS4 1000 1000 0 near.cpp\n")
        self.assertEqual(self.run_sim(sim, 1)[0], ["7 1"])
        # What is included is part of what the compiled program was made of.
        self.write("more/size.hpp", "constexpr int size = 8;\n")
        self.assertEqual(self.run_sim(sim, 1)[0], ["8 1"])

    def test_cannot_see_more_above_than_they_include(self):
        self.write("lab/room.wld", "floor 2000 2000\n")
        self.write("secret.txt", "word\n")
        self.write("sum.h", "static int sum(int a, int b) { return a + b; }\n")
        self.write("lab/look.c", '#include "../sum.h"\n#include "eyebot.h"\n'
                   '__asm__(".incbin \\"../secret.txt\\"");\nint main() { return sum(1, 2); }\n')
        sim = self.write("lab/x.sim", "world room.wld\nS4 1000 1000 0 look.c\n")
        done = subprocess.run([SANDLOT, "run", sim, "--duration", "1s"], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 2)
        self.assertIn("secret.txt", done.stderr)

    def test_of_robios_6_are_known_by_what_they_include(self):
        self.write("parts.h", 'VWHandle drive;\nvoid begin() { drive = VWInit(VW_DRIVE, 1); VWStartControl(drive, 7, 0.3, 10, 0.1); }\n')
        _, rows = self.run_program("parts.c", '#include "eyebot.h"\n#include "parts.h"\n'
                                   "int main() { begin(); VWDriveStraight(drive, 0.5, 0.25); VWDriveWait(drive); }\n", 4)
        self.assertAlmostEqual(rows[-1][0], 1.5, delta=0.01)

    def test_may_bring_prototypes_of_their_own(self):
        printed, _ = self.run_program("own.c", r"""
#include <stdio.h>
#include <pthread.h>
#include "wiringPi.h"
extern int XInitThreads(void);
extern int RADIOInit(void);
extern int RADIOCheck(void);
void* task(void* n) { return n; }
int main() {
  pthread_t one;
  void* got;
  int begun = XInitThreads();
  pthread_create(&one, NULL, task, (void*)5);
  pthread_join(one, &got);
  RADIOInit();
  printf("%d %d %d\n", begun, (int)(long)got, RADIOCheck());
}
""")
        self.assertEqual(printed, ["1 5 0"])

    def test_say_how_much_memory_they_need(self):
        self.write("x.sim", "world room.wld\nS4 1000 1000 0 large.c\n")
        self.write("large.c", '#include "eyebot.h"\nint table[400000000];\nint main() { table[5] = 1; return 0; }\n')
        done = subprocess.run([SANDLOT, "run", self.path("x.sim"), "--duration", "1s"], capture_output=True, text=True,
                              timeout=60)
        self.assertEqual(done.returncode, 0)  # the program ends alone
        self.assertIn("memory: ", done.stderr)


class Robots(Found):
    def test_may_be_placed_by_their_programs(self):
        _, rows = self.run_program("place.c", '#include "eyebot.h"\nint main() { SIMSetRobot(0, 2500, 1500, 0, 90); OSWait(200); }\n')
        self.assertAlmostEqual(rows[-1][0], 2.5, delta=1e-3)
        self.assertAlmostEqual(rows[-1][1], 1.5, delta=1e-3)
        self.assertAlmostEqual(rows[-1][2], math.pi / 2, delta=1e-3)

    def test_that_steer_drive_by_motor_and_servo(self):
        self.write("car.c", '#include "eyebot.h"\nint main() {\n  MOTORDrive(1, 50); SERVOSet(1, 127); OSWait(1000);\n'
                   "  SERVOSet(1, 0); OSWait(1500);\n  SERVOSet(1, 255); OSWait(3000);\n  MOTORDrive(1, 0);\n}\n")
        sim = self.write("car.sim", "world room.wld\nAckermann 1500 1500 0 car.c\n")
        _, rows = self.run_sim(sim, 7, robot="Ackermann")
        at = lambda s: rows[round(20 * s)]
        # Half of 1400 deg/s on wheels of 80 mm: 0.4887 m/s, less what accelerating takes.
        self.assertGreater(at(1.0)[0], 1.5 + 0.8 * 0.4887 * 0.9)
        self.assertLess(abs(at(1.0)[2]), 0.02)
        # To the left, then to the right: at most v tan(0.6) / 0.2 m = 1.67 rad/s.
        left = math.remainder(at(2.4)[2] - at(1.2)[2], 2 * math.pi)
        self.assertGreater(left, 0.8)
        self.assertLess(left, 1.67 * 1.2)
        right = math.remainder(at(4.4)[2] - at(3.4)[2], 2 * math.pi)
        self.assertLess(right, -0.8)
        self.assertLess(math.dist(at(6.5)[:2], at(7)[:2]), 0.01)


class Python(Found):
    def test_programs_drive_look_and_wait(self):
        printed, rows = self.run_program("drive.py", """
from eye import *
import threading
import time

LCDMenu("GO", "", "", "END")
LCDPrintf("turning \\n", "")  # one value too many
begin = time.time()
VWStraight(300, 200.7)
VWWait()
x, y, phi = VWGetPosition()
print(x, y, phi)
CAMInit(QQVGA)
image = CAMGet()
print(len(image) == QQVGA_SIZE, len(IPSobel(IPCol2Gray(image))) == QQVGA_PIXELS)
LCDImageStart(0, 0, 10, 10)
LCDImageBinary([1] * 100)
print("%06x" % LCDGetPixel(5, 5), IPPCol2RGB(ORANGE), KEYRead() == NOKEY, len(LIDARGet()) in (0, 360))
ticks = []
timer = OSAttachTimer(100, lambda: ticks.append(1))
thread = threading.Thread(target=time.sleep, args=(0.5,))
thread.start()
thread.join()
OSWait(500)
OSDetachTimer(timer)
print(len(ticks), 2 < time.time() - begin < 5)
SIMSetRobot(0, 2500, 1500, 0, 90)
""", 6)
        self.assertEqual(printed[:3], ["300 0 0", "True True", "ffffff [255, 165, 0] True True"])
        # 1000 ms of 100 ms each, and whatever the calls around took.
        self.assertRegex(printed[3], r"^(9|10|11) True$")
        self.assertAlmostEqual(rows[-1][0], 2.5, delta=1e-3)
        self.assertAlmostEqual(rows[-1][2], math.pi / 2, delta=1e-3)

    def test_programs_use_files_beside_them_but_our_library(self):
        self.write("eye.py", 'import ctypes\nctypes.CDLL("libeyesim.so")\n')
        self.write("helper.py", "from eye import *\n\ndef far():\n    return PSDGet(PSD_BACK)\n")
        printed, _ = self.run_program("use.py", "from helper import far\nprint(far() > 0, __name__)\n")
        self.assertEqual(printed, ["True __main__"])

    def test_programs_say_where_they_fail(self):
        self.write("x.sim", "world room.wld\nS4 1000 1000 0 fail.py\n")
        self.write("fail.py", "from eye import *\nVWStraight(100, 100)\nundefined()\n")
        done = subprocess.run([SANDLOT, "run", self.path("x.sim"), "--duration", "2s"], capture_output=True, text=True, timeout=60)
        self.assertEqual(done.returncode, 0)
        self.assertIn("NameError", done.stderr)

    def test_robots_talk(self):
        self.write("talk.py", "from eye import *\nRADIOInit()\nme = RADIOGetID()\n"
                   "if me == 1:\n    OSWait(200)\n    RADIOSend(2, 'ping')\n    print(RADIOReceive())\n"
                   "else:\n    sender, text = RADIOReceive()\n    RADIOSend(sender, text + ' pong')\n")
        sim = self.write("two.sim", "world room.wld\nS4 1000 1000 0 talk.py\nLabBot 1000 2000 0 talk.py\n")
        self.assertEqual(self.run_sim(sim, 3)[0], ["[2, 'ping pong']"])


if __name__ == "__main__":
    unittest.main()
