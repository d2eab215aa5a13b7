// A whole team by one connection: its robots form a line abreast while they drive.
//
//     npm install --no-save /usr/share/sandlot/javascript
//     sandlot run team.yaml --port 8765 &
//     node team.mjs
import { Team } from "sandlot_client";

const team = await Team.connect("red", { lockstep: true, deadline_s: 5 });
const robots = Object.values(team.robots);
for (const robot of robots) robot.subscribe("truth");
for await (const step of team.steps()) {
  const x = robots.map((robot) => robot.value("truth.pose.pose.position.x"));
  const mean = x.reduce((a, b) => a + b) / x.length;
  robots.forEach((robot, i) => robot.command("drive", { linear: { x: Math.min(0.6, Math.max(0, 0.3 + mean - x[i])) } }));
}
