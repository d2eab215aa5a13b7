#!/usr/bin/env python3
"""make_map.py draws what can be worked out by hand, and worlds/maps/indoor.* are what it draws."""
import pathlib
import subprocess
import sys
import tempfile
import unittest

ROOT = pathlib.Path(__file__).resolve().parent.parent
TOOL = ROOT / "tools" / "make_map.py"

WORLD = """<sdf version="1.9"><world name="w">
  <include><uri>model://chair</uri></include>
  <model name="room"><static>true</static><pose>1 2 0 0 0 1.5707963267948966</pose><link name="link">
    <pose>0 0 0.5 0 0 0</pose>
    <collision name="ground"><geometry><plane><normal>0 0 1</normal></plane></geometry></collision>
    <collision name="bar"><geometry><box><size>4 1 1</size></box></geometry></collision>
    <collision name="mesh"><geometry><mesh><uri>a.obj</uri></mesh></geometry></collision>
  </link></model>
  <model name="shelf"><static>1</static><pose>3 2 1.2 0 0 0</pose><link name="link">
    <collision name="high"><geometry><box><size>2 2 1</size></box></geometry></collision>
  </link></model>
  <model name="leg"><static>true</static><pose>4.55 2.25 0.25 0 0 0</pose><link name="link">
    <collision name="leg"><geometry><cylinder><radius>0.06</radius><length>0.5</length></cylinder></geometry></collision>
  </link></model>
  <model name="crate"><pose>3 3 0 0 0 0</pose><link name="link">
    <collision name="box"><geometry><box><size>1 1 1</size></box></geometry></collision>
  </link></model>
</world></sdf>"""


class MakeMap(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)
        self.out = pathlib.Path(self.folder.name) / "map"

    def draw(self, world, *options):
        path = pathlib.Path(self.folder.name) / "world.sdf"
        path.write_text(world)
        return subprocess.run([sys.executable, TOOL, path, self.out, *options], capture_output=True, text=True, check=False)

    def rows(self):
        """The picture's rows from above, as text."""
        magic, size, most, pixels = self.out.with_suffix(".pgm").read_bytes().split(b"\n", 3)
        width, height = map(int, size.split())
        self.assertEqual((magic, most, len(pixels)), (b"P5", b"255", width * height))
        text = "".join({0: "#", 254: ".", 205: "?"}[pixel] for pixel in pixels)
        return [text[i:i + width] for i in range(0, len(text), width)]

    def test_shapes_stand_where_their_frames_put_them(self):
        done = self.draw(WORLD, "--height", "0.4", "--resolution", "0.5", "--margin", "0.5")
        self.assertEqual(done.returncode, 0, done.stderr)
        # The bar of 4 m x 1 m, turned by 90 degrees: x from 0.5 to 1.5, y from 0 to 4. The leg, thinner than a cell, in the cell from (4.5, 2).
        bar, both = "." + "##" + "........", "." + "##" + "......" + "#" + "."
        self.assertEqual(self.rows(), ["." * 11, *[bar] * 3, both, *[bar] * 4, "." * 11])
        self.assertIn("origin: [0, -0.5, 0]", self.out.with_suffix(".yaml").read_text())
        self.assertIn("image: map.pgm\nresolution: 0.5\n", self.out.with_suffix(".yaml").read_text())
        for each in ("include of model://chair", "room/link/mesh: a mesh"):
            self.assertIn(f"left out: {each}", done.stderr)

    def test_height_chooses_what_is_cut(self):
        done = self.draw(WORLD, "--height", "1.2", "--resolution", "0.5", "--margin", "0")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(self.rows(), ["####"] * 4)
        for height in ("1.71", "-0.01"):
            self.assertIn("no static shape reaches the height", self.draw(WORLD, "--height", height).stderr)

    def test_what_cannot_be_reached_is_unknown(self):
        side = '<collision name="{0}"><pose>{1} {2} 0 0 0 0</pose><geometry><box><size>{3} {4} 1</size></box></geometry></collision>'
        walls = "".join(side.format(*wall) for wall in (("s", 0, -1, 3, 1), ("n", 0, 1, 3, 1), ("w", -1, 0, 1, 3), ("e", 1, 0, 1, 3)))
        world = f'<sdf version="1.9"><world name="w"><model name="m"><static>true</static><link name="l">{walls}</link></model></world></sdf>'
        options = ("--height", "0", "--resolution", "0.5", "--margin", "0.5", "--inside")
        self.assertEqual(self.draw(world, *options, "0", "0").returncode, 0)
        edge, wall, room = "?" * 8, "?######?", "?##..##?"
        self.assertEqual(self.rows(), [edge, wall, wall, room, room, wall, wall, edge])
        self.assertIn("--inside is off the map or within a shape", self.draw(world, *options, "1", "0").stderr)
        self.assertIn("--inside is off the map or within a shape", self.draw(world, *options, "50", "0").stderr)

    def test_a_mistake_is_named_and_the_exit_code_is_2(self):
        for world, options, words in (("<sdf><a>", (), "world.sdf:1: this is not XML"),
                                      ("<sdf/>", (), "no <world> in <sdf>"),
                                      (WORLD.replace("3 2 1.2 0 0 0", "3 2"), (), "shelf: <pose> is '3 2'; 6 numbers would be right"),
                                      (WORLD.replace("2 2 1<", "2 2 nan<"), (), "shelf/link/high: <size> is '2 2 nan'; 3 numbers would be right"),
                                      (WORLD.replace("<radius>0.06</radius>", ""), (), "leg/link/leg: <radius> is ''; 1 number would be right"),
                                      (WORLD.replace("<box><size>2 2 1</size></box>", ""), (), "shelf/link/high: no shape in <geometry>"),
                                      (WORLD, ("--resolution", "1e-5"), "give a larger --resolution"),
                                      (WORLD, ("--resolution", "nan"), "not finite"),
                                      (WORLD, ("--height", "9"), "no static shape reaches the height 9.0 m")):
            done = self.draw(world, *options)
            self.assertEqual(done.returncode, 2, words)
            self.assertIn(words, done.stderr)
            self.assertEqual(done.stderr.count("\n"), 1 + done.stderr.count("left out"), done.stderr)
        missing = subprocess.run([sys.executable, TOOL, "nowhere.sdf", self.out], capture_output=True, text=True, check=False)
        self.assertEqual((missing.returncode, missing.stderr), (2, "make_map: nowhere.sdf: No such file or directory\n"))

    def test_angles_may_be_degrees_and_the_folder_of_the_map_is_made(self):
        self.out = self.out.parent / "maps" / "map"
        done = self.draw(WORLD.replace("<pose>1 2 0 0 0 1.5707963267948966", '<pose degrees="true">1 2 0 0 0 90'), "--resolution", "0.5", "--margin", "0")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual([row[:2] for row in self.rows()], ["##"] * 8)

    def test_the_map_of_the_flat_is_up_to_date(self):
        self.out = self.out.with_name("indoor")
        done = subprocess.run([sys.executable, TOOL, ROOT / "worlds/indoor.sdf", self.out, "--height", "0.25", "--inside", "1.6", "4.65"],
                              capture_output=True, text=True, check=False)
        self.assertEqual((done.returncode, done.stderr), (0, ""))
        for suffix in (".pgm", ".yaml"):
            self.assertEqual(self.out.with_suffix(suffix).read_bytes(), (ROOT / "worlds/maps/indoor").with_suffix(suffix).read_bytes())


if __name__ == "__main__":
    unittest.main()
