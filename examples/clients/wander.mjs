// A robot that keeps away from what its laser sees, driven by a client in lockstep with the run.
//
//     npm install --no-save /usr/share/sandlot/javascript
//     sandlot run wander.yaml --port 8765 &
//     node wander.mjs
import { Robot } from "sandlot_client";

const least = (values) => values.reduce((a, b) => Math.min(a, b));

/** Forward while the way is free; else turn to the side with more room. */
function decide(scan) {
  const ranges = scan.ranges.map((r) => r ?? scan.range_max);  // null: nothing within range
  const third = Math.floor(ranges.length / 3);
  const [right, ahead, left] = [ranges.slice(0, third), ranges.slice(third, -third), ranges.slice(-third)].map(least);
  if (ahead > 0.8) return { linear: { x: 0.4 } };
  return { angular: { z: left > right ? 1 : -1 } };
}

const rover = await Robot.connect("rover", { lockstep: true, deadline_s: 5 });
const laser = rover.subscribe("laser");
for await (const step of rover.steps())
  if (laser.fresh()) rover.command("drive", decide(laser.message));
