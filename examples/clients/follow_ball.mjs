// A robot that looks for a ball, drives to it and pushes it on, by what its camera reports at the level of objects.
//
//     npm install --no-save /usr/share/sandlot/javascript
//     sandlot run follow_ball.yaml --port 8765 &
//     node follow_ball.mjs
import { Robot } from "sandlot_client";

/** Turn until the ball is in sight; then towards it, the faster the straighter. */
function decide(objects) {
  const ball = objects.find((each) => each.label === "ball");
  if (!ball) return { angular: { z: 0.8 } };
  return { linear: { x: Math.abs(ball.bearing) < 0.2 ? 0.5 : 0.1 }, angular: { z: 2.5 * ball.bearing } };
}

const rover = await Robot.connect("rover", { lockstep: true, deadline_s: 5 });
const eye = rover.subscribe("eye/objects");
for await (const step of rover.steps())
  if (eye.fresh()) rover.command("drive", decide(eye.message.objects));
