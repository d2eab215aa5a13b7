// Who looks changes nothing: the same run with no viewer, with one, with five, and with one that never reads ends in the same state.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { after, test } from "node:test";
import { Scratch, Served, sandlot, until } from "./served.mjs";
import { Viewer } from "./viewer.mjs";

const scratch = new Scratch();
const run = ["run", "scenarios/fleet.yaml", "--duration", "3s"];
const alone = JSON.parse(execFileSync(sandlot, [...run, "--json"], { stdio: "pipe" }));
after(() => {
  Served.killAll();
  scratch.remove();
});

for (const { viewers, stalled } of [{ viewers: 0 }, { viewers: 1 }, { viewers: 5 }, { viewers: 1, stalled: true }]) {
  test(`${viewers} viewers${stalled ? " and one that never reads" : ""}`, async () => {
    // Paused until all are there; then as fast as it goes.
    const served = await Served.start([...run, "--rate", "max", ...(viewers > 0 ? ["--paused"] : [])], scratch);
    const all = [];
    let seen = 0;
    for (let i = 0; i < viewers + (stalled ? 1 : 0); ++i) {
      const viewer = new Viewer(served.ws, i % 2 === 0 ? "foxglove.websocket.v1" : "foxglove.sdk.v1");
      await until("the channels", () => viewer.channels.has("/sandlot/poses") && viewer.channels.has("/tf"));
      // Everything there is, raw.
      for (const channel of viewer.channels.values()) viewer.handlers.set(viewer.client.subscribe(channel.id), () => { ++seen; });
      all.push(viewer);
      if (stalled && i === viewers) viewer.socket.pause();
    }
    if (viewers > 0) {
      await until("something to see", () => seen > 0);
      assert.ok((await all[0].say("run")).ok);
    }
    assert.equal(await served.ended, 0, served.error);
    assert.equal(served.summary.state_hash, alone.state_hash);
    assert.equal(served.summary.end_tick, alone.end_tick);
    assert.equal(served.summary.server.viewers_most, all.length);
    for (const viewer of all) viewer.socket.terminate();
  });
}
