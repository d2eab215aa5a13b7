// Takes the picture of a match on its page, in Debian's Chromium. `./dev test` installs what it needs.
//
//   node tools/make_match_picture.mjs [FILE]      FILE is docs/images/match.png when left out
import { chromium } from "../tests/js/node_modules/playwright-core/index.mjs";
import { Scratch, Served, until } from "../tests/js/served.mjs";
import { Viewer } from "../tests/js/viewer.mjs";

const file = process.argv[2] ?? "docs/images/match.png";
const scratch = new Scratch();
const served = await Served.start(["match", "teams/dribbling", "teams/run_and_kick", "--duration", "3 min", "--seed", "5", "--rate", "8"], scratch);
const viewer = new Viewer(served.ws, "foxglove.websocket.v1");
let status;
await viewer.subscribe("/sandlot/status", (s) => { status = s; });
const browser = await chromium.launch({ executablePath: process.env.SANDLOT_CHROMIUM ?? "/usr/bin/chromium",
  args: ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync"] });
try {
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 }, colorScheme: "light" });
  await page.goto(served.url);
  // A goal has fallen, and play has gone on.
  await until("a good moment", () => status?.time_s > 105, 240);
  await viewer.say("pause");
  await page.mouse.move(1270, 420);
  await page.waitForTimeout(3000);  // what is still being drawn
  await page.screenshot({ path: file });
} finally {
  await browser.close();
  viewer.close();
  await served.stop();
  scratch.remove();
}
