// Runs with a page, for tests: `sandlot run ... --port 0` as a user would, until it is stopped with ctrl-c.
import { spawn } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";

export const sandlot = process.env.SANDLOT_BIN ?? "build/release/sandlot";

/** A folder that goes with remove(). */
export class Scratch {
  folder = mkdtempSync(join(tmpdir(), "sandlot-js-"));
  file(name) { return join(this.folder, name); }
  write(name, text) {
    writeFileSync(this.file(name), text);
    return this.file(name);
  }
  remove() { rmSync(this.folder, { recursive: true, force: true }); }
}

/** Waits until `get` returns something that is neither null, undefined nor false. */
export async function until(what, get, timeout_s = 20) {
  const end = Date.now() + timeout_s * 1000;
  for (;;) {
    const value = await get();
    if (value !== undefined && value !== null && value !== false) return value;
    if (Date.now() > end) throw new Error(`${what}: did not come in ${timeout_s} s`);
    await new Promise((done) => setTimeout(done, 20));
  }
}

/** A command that serves a page. `url` is what it printed, `ended` its exit code, output and summary. */
export class Served {
  out = "";
  error = "";
  static all = new Set();
  constructor(args, scratch, env = {}) {
    Served.all.add(this);
    this.summaryFile = scratch.file("summary.json");
    this.process = spawn(sandlot, [...args, "--port", "0", "--summary", this.summaryFile], { env: { ...process.env, ...env } });
    this.process.stdout.on("data", (data) => { this.out += data; });
    this.process.stderr.on("data", (data) => { this.error += data; });
    this.ended = new Promise((done) => this.process.on("close", (code) => done(code)));
  }
  static async start(args, scratch, env) {
    const served = new Served(args, scratch, env);
    let code;
    void served.ended.then((c) => { code = c; });
    served.url = await until("the address of the page", () => {
      if (code !== undefined) throw new Error(`it ended with ${code}: ${served.error}`);
      return /^page: (\S+)$/m.exec(served.error)?.[1];
    });
    return served;
  }
  get ws() { return this.url.replace("http:", "ws:"); }
  get summary() { return JSON.parse(readFileSync(this.summaryFile, "utf8")); }
  /** Whatever a failed test left. */
  static killAll() { for (const served of Served.all) served.process.kill("SIGKILL"); }
  /** Ctrl-c. @return the exit code */
  async stop() {
    this.process.kill("SIGINT");
    return this.ended;
  }
}

/** Rows of a CSV file of `--log`: { names, rows: Map from time to numbers }. */
export function readCsv(file) {
  const lines = readFileSync(file, "utf8").trim().split("\n").map((line) => line.split(","));
  const number = (text) => text === "" ? undefined : text === "inf" ? Infinity : text === "-inf" ? -Infinity : Number(text);
  return { names: lines[0], rows: new Map(lines.slice(1).map((row) => [Number(row[0]).toFixed(3), row.map(number)])) };
}

// A yard with four walls, a mesh and two rovers: one wanders, one waits for orders.
const stl = (() => {
  const p = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]];
  const faces = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
  return "solid t\n" + faces.map((f) => "facet normal 0 0 0\nouter loop\n" +
    f.map((i) => `vertex ${p[i].join(" ")}\n`).join("") + "endloop\nendfacet\n").join("") + "endsolid t\n";
})();

const solid = (name, pose, geometry, rgb) => `<model name="${name}"><static>true</static><pose>${pose}</pose><link name="link">
  <collision name="c"><geometry>${geometry}</geometry></collision>
  <visual name="v"><geometry>${geometry}</geometry><material><diffuse>${rgb} 1</diffuse></material></visual></link></model>`;

/** Writes the yard into a folder. @return the scenario's file */
export function makeYard(scratch, { controller = "{kind: wander, radius: 0.18}", physics = "planar" } = {}) {
  scratch.write("rock.stl", stl);
  const walls = [["north", "0 3 0.25", "6.2 0.2 0.5"], ["south", "0 -3 0.25", "6.2 0.2 0.5"], ["east", "3 0 0.25", "0.2 5.8 0.5"],
    ["west", "-3 0 0.25", "0.2 5.8 0.5"]];
  scratch.write("yard.sdf", `<?xml version="1.0"?><sdf version="1.9"><world name="yard">
    <light name="sun" type="directional"><direction>-0.4 0.3 -0.9</direction><cast_shadows>true</cast_shadows></light>
    ${solid("ground", "0 0 0 0 0 0", "<plane><normal>0 0 1</normal><size>8 8</size></plane>", "0.6 0.62 0.6")}
    ${walls.map(([name, pose, size]) => solid(name, `${pose} 0 0 0`, `<box><size>${size}</size></box>`, "0.7 0.5 0.3")).join("\n")}
    <model name="rock"><static>true</static><pose>2 2 0 0 0 0</pose><link name="link"><visual name="v"><geometry><mesh>
      <uri>rock.stl</uri><scale>0.5 0.5 0.5</scale></mesh></geometry></visual></link></model>
    </world></sdf>`);
  const rover = join(process.cwd(), "models/rover/model.sdf");
  return scratch.write("yard.yaml", `version: 1
name: yard
world: yard.sdf
physics: ${physics}
time: {step: 10 ms, substeps: 2, control_interval: 5}
seed: 1
robots:
  - {name: rover, model: ${rover}, pose: [-1.5, -1, 0], controller: ${controller}}
  - {name: idle, model: ${rover}, pose: [0, 1.5, 0]}
`);
}
