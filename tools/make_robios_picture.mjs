// Takes the picture of the lesson on RoBIOS programs: a robot in a maze, with its screen. As tools/make_page_picture.mjs.
//
//   node tools/make_robios_picture.mjs [FILE]      FILE is docs/images/robios_maze.png when left out
import { chromium } from "../tests/js/node_modules/playwright-core/index.mjs";
import { Scratch, Served, until } from "../tests/js/served.mjs";
import { Viewer } from "../tests/js/viewer.mjs";

const file = process.argv[2] ?? "docs/images/robios_maze.png";
const scratch = new Scratch();
const served = await Served.start(["run", "examples/robios/maze.sim", "--rate", "8"], scratch);
const viewer = new Viewer(served.ws, "foxglove.websocket.v1");
let status;
await viewer.subscribe("/sandlot/status", (s) => { status = s; });
const browser = await chromium.launch({ executablePath: process.env.SANDLOT_CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--ignore-gpu-blocklist", "--disable-quic",
    "--no-first-run", "--disable-background-networking", "--disable-component-update", "--disable-sync"] });
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 900 }, colorScheme: "light" });
  await page.goto(served.url);
  await page.locator('[data-testid="tree"] [data-address="LabBot"]').click();
  // It knows most of the maze.
  await until("a good moment", () => status?.time_s > 145, 120);
  await viewer.say("pause");
  await page.mouse.move(500, 300);
  for (let i = 0; i < 1; ++i) await page.mouse.wheel(0, -100);
  await page.mouse.move(1270, 890);
  await page.waitForTimeout(9000);  // what is still being drawn
  await page.screenshot({ path: file, clip: { x: 0, y: 0, width: 1280, height: 650 } });
} finally {
  await browser.close();
  viewer.close();
  await served.stop();
  scratch.remove();
}
