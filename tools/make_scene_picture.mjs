// Takes the picture of the README's section on wheels and materials: three scenarios on their pages, in Debian's Chromium, side
// by side. `./dev test` installs what it needs.
//
//   node tools/make_scene_picture.mjs [FILE]      FILE is docs/images/scenes.png when left out
import { chromium } from "../tests/js/node_modules/playwright-core/index.mjs";
import { Scratch, Served, until } from "../tests/js/served.mjs";
import { Viewer } from "../tests/js/viewer.mjs";

const file = process.argv[2] ?? "docs/images/scenes.png";
const size = { width: 520, height: 400 };
// When to look, at what (else at everything), and from where.
const scenes = [
  { name: "wheels", time_s: 17, at: "mecanum_rollers", view: { distance: 1.75, azimuth: -2.3, elevation: 0.42 } },
  { name: "creatures", time_s: 14, at: "hexapod", view: { distance: 7, azimuth: -2.2, elevation: 0.5 } },
  { name: "materials", time_s: 3.2, nearer: 0.9 },
];
const browser = await chromium.launch({ executablePath: process.env.SANDLOT_CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync"] });

/** One scenario's 3D view as a data URL. */
async function take({ name, time_s, at, view = {}, nearer = 1 }) {
  const scratch = new Scratch();
  const served = await Served.start(["run", `scenarios/${name}.yaml`, "--command", `at ${time_s} s pause`], scratch);
  const viewer = new Viewer(served.ws, "foxglove.websocket.v1");
  try {
    let status;
    await viewer.subscribe("/sandlot/status", (s) => { status = s; });
    const page = await browser.newPage({ viewport: size, deviceScaleFactor: 2, colorScheme: "light" });
    await page.goto(served.url);
    await until("a good moment", () => status?.time_s >= time_s - 0.005, 120);
    // The view alone, as large as the window.
    await page.evaluate(async ([at, view, nearer]) => {
      const scene = window.sandlot.scene;
      scene.setOverlays({ names: false, trails: true });
      Object.assign(scene.host.style, { position: "fixed", inset: "0", zIndex: "1000" });
      await new Promise((done) => setTimeout(done, 500));
      if (at) scene.frame(at);
      Object.assign(scene.rig.goal, view);
      scene.rig.goal.distance *= nearer;
      scene.rig.settle();
      scene.invalidate();
    }, [at, view, nearer]);
    await page.waitForTimeout(3000);  // what is still being drawn
    const picture = await page.screenshot();
    await page.close();
    return `data:image/png;base64,${picture.toString("base64")}`;
  } finally {
    viewer.close();
    await served.stop();
    scratch.remove();
  }
}

try {
  const pictures = [];
  for (const scene of scenes) pictures.push(await take(scene));
  const gap = 8;
  const page = await browser.newPage({ viewport: { width: size.width * 3 + 2 * gap, height: size.height } });
  await page.setContent(`<body style="margin:0;display:flex;gap:${gap}px">${pictures.map((p) => `<img width=${size.width} src="${p}">`).join("")}`);
  await page.waitForTimeout(500);
  await page.screenshot({ path: file });
} finally {
  await browser.close();
}
