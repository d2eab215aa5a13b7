// P9, the page's side: script and submit time per frame with 1000 moving robots of three links, in Debian's Chromium. What WebGL does with
// the calls is after the time which is measured here. `./dev bench` runs it.
import { existsSync } from "node:fs";
import { chromium } from "playwright-core";
import { Scratch, Served, until } from "./served.mjs";

const executablePath = process.env.SANDLOT_CHROMIUM ?? "/usr/bin/chromium";
if (!existsSync(executablePath)) {
  console.log("P9 page: left out, there is no chromium");
  process.exit(0);
}
const scratch = new Scratch();
const inertial = "<inertial><mass>2</mass><inertia><ixx>0.1</ixx><iyy>0.2</iyy><izz>0.25</izz></inertia></inertial>";
const wheel = (name, y) => `<link name='${name}'><pose>0 ${y} 0.05 -1.5707963 0 0</pose>${inertial}
  <visual name='v'><geometry><cylinder><radius>0.05</radius><length>0.02</length></cylinder></geometry></visual></link>
  <joint name='${name}_joint' type='continuous'><parent>base</parent><child>${name}</child><axis><xyz>0 0 1</xyz></axis></joint>`;
const box = "<geometry><box><size>0.2 0.16 0.08</size></box></geometry>";
scratch.write("r.sdf", `<sdf version='1.9'><model name='r'><link name='base'><pose>0 0 0.05 0 0 0</pose>${inertial}
  <collision name='c'>${box}</collision><visual name='v'>${box}<material><diffuse>0.8 0.4 0.1 1</diffuse></material></visual></link>
  ${wheel("left", 0.1)}${wheel("right", -0.1)}
  <plugin name='gz::sim::systems::DiffDrive' filename='gz-sim-diff-drive-system'><left_joint>left_joint</left_joint>
  <right_joint>right_joint</right_joint><wheel_separation>0.2</wheel_separation><wheel_radius>0.05</wheel_radius></plugin></model></sdf>`);
const served = await Served.start(["run", scratch.write("run.yaml", `version: 1
name: thousand
physics: planar
time: {step: 10 ms, substeps: 1}
seed: 1
robots:
  - {name: r, model: r.sdf, count: 1000, distribution: {grid: {centre: [0, 0, 0], spacing: 1 m}},
     controller: {kind: sequence, steps: [{at: 0 s, orders: {diff_drive: [0.2, 0, 0.7]}}]}}
`)], scratch);
const browser = await chromium.launch({ executablePath,
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync"] });
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 } });
  // Everything is handed to WebGL, and no pixel is made: a processor that draws would hold up the next call, and the page
  // would get one frame a second, with the messages of a whole second to read in it.
  await page.addInitScript(() => {
    for (const name of ["drawElements", "drawArrays", "drawElementsInstanced", "drawArraysInstanced"]) {
      WebGL2RenderingContext.prototype[name] = () => {};
    }
  });
  await page.goto(served.url);
  const stats = () => page.evaluate(() => window.sandlot?.stats());
  await until("1000 robots that move", async () => {
    const s = await stats();
    return s && s.fps > 0 && s.instances >= 1000;
  }, 60);
  await page.waitForTimeout(4000);  // the first frames compile; the mean is of the last second
  const { script_ms, submit_ms, fps, draw_calls } = await stats();
  const sum = script_ms + submit_ms, budget = 5;
  console.log(`${sum <= budget ? "ok  " : "OVER"} P9 page, script and submit per frame                ${sum.toPrecision(3)} ms       ` +
    `(script ${script_ms.toFixed(2)}, submit ${submit_ms.toFixed(2)}, ${draw_calls} draw calls, ${fps.toFixed(0)} frames/s; budget ${budget} ms)`);
} finally {
  await browser.close();
  await served.stop();
  scratch.remove();
}
