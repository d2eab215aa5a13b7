// Two robots that agree by radio where to meet. One process each:
//
//     npm install --no-save /usr/share/sandlot/javascript
//     sandlot run radio_pair.yaml --port 8765 &
//     node radio_pair.mjs red & node radio_pair.mjs blue
//
// Each draws a place between the two, and a rank, and sends both in every step: packets get lost. The place of the higher rank is it.
import { Robot, dataOf, packet } from "sandlot_client";

const name = process.argv[2] ?? "red";
const other = name === "red" ? "blue" : "red";
const [begin, direction] = name === "red" ? [-2, 1] : [2, -1];

const robot = await Robot.connect(name, { lockstep: true, deadline_s: 5 });
const radio = robot.subscribe("radio");
const odometry = robot.subscribe("drive");
let mine, heard;  // { rank, place }
for await (const step of robot.steps()) {
  mine ??= { rank: step.uniform(0), place: 3 * step.uniform(1) - 1.5 };
  robot.command("radio", packet(`${mine.rank} ${mine.place}`, other));
  if (radio.fresh())
    for (const each of radio.message.packets) {
      const [rank, place] = new TextDecoder().decode(dataOf(each)).split(" ").map(Number);
      heard = { rank, place };
    }
  if (!heard) continue;
  const { place } = heard.rank > mine.rank ? heard : mine;
  const left = direction * (place - begin) - odometry.value("pose.pose.position.x");
  robot.command("drive", { linear: { x: Math.min(0.4, Math.max(-0.4, left)) } });
}
