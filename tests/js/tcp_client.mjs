// A client of rosbridge over TCP that drives a robot, as a few lines of a language without a library would.
import { connect } from "node:net";

export class TcpClient {
  steps = 0;
  ended = false;
  /** @param answer  called with each step sent; returns how long to wait before the answer, in ms */
  constructor(url, answer = () => 0) {
    const { hostname, port } = new URL(url);
    this.socket = connect(Number(port), hostname);
    this.socket.setNoDelay(true);  // else the second of two short messages waits for an acknowledgement, 40 ms
    this.socket.on("error", () => {});
    this.socket.on("close", () => { this.ended = true; });
    let rest = "";
    this.socket.on("data", (data) => {
      const lines = (rest + data).split("\n");
      rest = lines.pop();
      for (const line of lines) this.take(JSON.parse(line), answer);
    });
  }
  say(message) {
    if (!this.ended) this.socket.write(JSON.stringify(message) + "\n");
  }
  claim(robot, more = {}) {
    this.robot = robot;
    this.say({ op: "sandlot.claim", robot, ...more });
  }
  drive(x, z) {
    this.say({ op: "publish", topic: `/${this.robot}/drive`, msg: { linear: { x }, angular: { z } } });
  }
  take(message, answer) {
    if (message.op === "sandlot.claimed") this.claimed = message;
    if (message.op !== "sandlot.tick") return;
    this.steps += 1;
    const done = () => {
      this.drive(0.3, 0.4);
      this.say({ op: "sandlot.done", step: message.step });
    };
    const wait_ms = answer(this.steps);
    if (wait_ms > 0) setTimeout(done, wait_ms);
    else done();
  }
  close() { this.socket.destroy(); }
}
