// Takes a picture of each scenario on its page, in Debian's Chromium, and writes docs/gallery.md, which shows them all. `./dev test`
// installs what it needs.
//
//   node tools/make_gallery.mjs [NAME...]      NAME as in docs/gallery.md (match, selforg/snake); all when left out
import { readFileSync, readdirSync, mkdirSync, writeFileSync, existsSync } from "node:fs";
import { chromium } from "../tests/js/node_modules/playwright-core/index.mjs";
import { Scratch, Served, until } from "../tests/js/served.mjs";
import { Viewer } from "../tests/js/viewer.mjs";
import { saveScreenshot } from "./indexed_png.mjs";

const size = { width: 1120, height: 680 };
/** When to look [s of the scenario], at what (else at everything), from how near, and what is open below the scene. */
const moments = {
  ball: { time_s: 4 }, beach: { time_s: 12 }, charging: { time_s: 20 }, clearing: { time_s: 15 }, clutter: { time_s: 10 },
  creatures: { time_s: 12 }, errors: { time_s: 10 }, football: { time_s: 12 }, foraging: { time_s: 25 }, formation: { time_s: 6 },
  gripping: { time_s: 5 }, indoor: { time_s: 12 }, joint_step: { time_s: 2.1 }, mario: { time_s: 6 },
  mario_drive: { time_s: 10, at: "mario" }, mario_step: { time_s: 1, at: "mario" }, match: { time_s: 30, below: "match" }, materials: { time_s: 3.2 },
  motor_ramp: { time_s: 3 }, office_goals: { time_s: 12 }, office_localise: { time_s: 10 }, pile: { time_s: 4 },
  predator_prey: { time_s: 8 }, primitives: { time_s: 1.5 }, soccer_attack: { time_s: 6 }, soccer_game: { time_s: 15 },
  transport: { time_s: 10 }, vineyard_loop: { time_s: 3 }, vineyard_rows: { time_s: 12 }, wheels: { time_s: 17 }, yard: { time_s: 20 },
};
const usual_s = 8;

/** What a scenario's first sentence says. */
function sentence(file) {
  const words = [];
  for (const line of readFileSync(file, "utf8").split("\n")) {
    if (!/^# \S/.test(line)) break;  // commands are indented
    words.push(line.slice(2).trim());
  }
  const text = words.join(" ");
  const end = /\.(?= |$)/.exec(text);
  return (end ? text.slice(0, end.index) : text) + ".";
}

const names = [...readdirSync("scenarios").filter((f) => f.endsWith(".yaml")).map((f) => f.slice(0, -5)).sort(),
  ...readdirSync("scenarios/selforg").filter((f) => f.endsWith(".yaml")).map((f) => `selforg/${f.slice(0, -5)}`).sort()];
const wanted = process.argv.length > 2 ? process.argv.slice(2) : names;
for (const name of wanted)
  if (!names.includes(name)) throw new Error(`'${name}' is not a scenario of scenarios/`);
const picture = (name) => `docs/images/gallery/${name.replace("/", "_")}.png`;
mkdirSync("docs/images/gallery", { recursive: true });

const browser = await chromium.launch({ executablePath: process.env.SANDLOT_CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync"] });

async function take(name) {
  const { time_s = usual_s, at, nearer = 1, below } = moments[name] ?? {};
  const scratch = new Scratch();
  const served = await Served.start(["run", `scenarios/${name}.yaml`, "--command", `at ${time_s} s pause`], scratch);
  const viewer = new Viewer(served.ws, "foxglove.websocket.v1");
  try {
    let status;
    await viewer.subscribe("/sandlot/status", (s) => { status = s; });
    const page = await browser.newPage({ viewport: size, colorScheme: "light" });
    await page.addInitScript((below) => {
      localStorage.setItem("sandlot.frame.folded", JSON.stringify({ dock: !below }));
      if (below) localStorage.setItem("sandlot.dock.tab", JSON.stringify(below));
    }, below);
    await page.goto(served.url);
    await until(`${name} at ${time_s} s`, () => status?.time_s >= time_s - 0.011, 300);
    await page.evaluate(([at, nearer]) => {
      const scene = window.sandlot.scene;
      if (at) scene.frame(at);
      scene.rig.goal.distance *= nearer;
      scene.rig.settle();
      scene.invalidate();
    }, [at, nearer]);
    await page.waitForTimeout(3000);  // what is still being drawn
    await saveScreenshot(page, picture(name), 96);
    await page.close();
  } finally {
    viewer.close();
    await served.stop();
    scratch.remove();
  }
}

try {
  for (const name of wanted) {
    await take(name);
    console.log(picture(name));
  }
} finally {
  await browser.close();
}

const rows = names.filter((name) => existsSync(picture(name))).map((name) =>
  `## ${name}\n\n${sentence(`scenarios/${name}.yaml`)}\n\n    sandlot run scenarios/${name}.yaml\n\n![${name} on its page](${picture(name).slice(5)})\n`);
writeFileSync("docs/gallery.md", `# Each scenario on its page

Made by \`node tools/make_gallery.mjs\`; each with the first sentence of its file, which says more. \`sandlot run\` prints the address of the page.

${rows.join("\n")}`);
