// Drives the rover of @NAME@.yaml: forward while the way is free, else it turns to the side with more room.
import { pathToFileURL } from "node:url";
import { Robot, numbers } from "./sandlot_client/sandlot_client.mjs";

/** A command for the drive by a laser scan: 271 ranges from -135 to 135 degrees. */
export function decide(scan) {
  const ranges = numbers(scan.ranges, scan.range_max);
  const least = (from, to) => Math.min(...ranges.slice(from, to));
  const [right, ahead, left] = [least(45, 115), least(115, 156), least(156, 226)];
  if (ahead > 0.6) return { linear: { x: 0.4 } };
  return { angular: { z: left > right ? 1 : -1 } };
}

async function main() {
  const rover = await Robot.connect("rover", { lockstep: true, deadline_s: 5 });
  const laser = rover.subscribe("laser");
  for await (const step of rover.steps())
    if (laser.fresh()) rover.command("drive", decide(laser.message));
}

if (import.meta.url === pathToFileURL(process.argv[1] ?? "").href) await main();
