/**
 * Drives robots of a Sandlot run from JavaScript: in node 18 or later and in browsers, without any package.
 *
 *     import { Robot } from "./sandlot_client.mjs";
 *
 *     const rover = await Robot.connect("rover", { lockstep: true });
 *     const laser = rover.subscribe("laser");
 *     for await (const step of rover.steps()) {
 *       const near = laser.message.ranges.slice(100, 171).some((r) => r !== null && r < 0.6);  // null: nothing within reach
 *       rover.command("drive", { linear: { x: near ? 0 : 0.3 }, angular: { z: near ? 0.8 : 0 } });
 *     }
 *
 * Protocol   rosbridge v2 as JSON with claims and lockstep of Sandlot's own: docs/clients.md. By WebSocket in browsers; in node by
 *            lines over TCP, or by WebSocket with the option WebSocket: the class of the package ws.
 * Messages   objects with the field names of ROS 2; lists of numbers are arrays, see numbers(); octets are base64 text, see dataOf().
 * Address    option url; node: SANDLOT_URL, else 127.0.0.1:8765. tcp://, ws:// and http:// are the same port; unix:PATH in node.
 * Token      option token, ?token=... of the address; node: SANDLOT_TOKEN.
 * Errors     Refused: the server's own words. RunEnded: the run is over. Disconnected: the connection broke, or was closed for the
 *            reason it names. Nothing reconnects by itself: a robot is claimed again by another Robot.connect().
 */
import { Clock } from "./clock.mjs";

export { Clock };

/** A request that the server has refused. */
export class Refused extends Error { name = "Refused"; }
/** The connection broke or was closed. */
export class Disconnected extends Error { name = "Disconnected"; }
/** The run is over, and the server with it. */
export class RunEnded extends Disconnected { name = "RunEnded"; }

const env = globalThis.process?.versions?.node ? globalThis.process.env : {};
const after = (seconds) => new Promise((done) => setTimeout(done, 1000 * seconds));

/** Bytes of a field of octets. @return Uint8Array */
export function dataOf(message, key = "data") {
  const value = message[key];
  return typeof value === "string" ? Uint8Array.from(atob(value), (c) => c.charCodeAt(0)) : Uint8Array.from(value);
}

/** A message for a radio. @param to  a robot, a team, an address; "": all. A text is sent as UTF-8. */
export function packet(data, to = "") {
  const bytes = typeof data === "string" ? new TextEncoder().encode(data) : data;
  let text = "";
  for (const byte of bytes) text += String.fromCharCode(byte);
  return { to, data: btoa(text) };
}

/** A list of numbers as a Float64Array. @param missing  what stands for null, such as the range beyond which a laser sees nothing */
export const numbers = (values, missing = NaN) => Float64Array.from(values, (value) => value ?? missing);

/** The latest message of a topic. */
export class Reading {
  message = null;
  count = 0;
  #seen = 0;
  constructor(topic) { this.topic = topic; }
  /** Whether a message has come since the call before. */
  fresh() {
    const seen = this.#seen;
    this.#seen = this.count;
    return this.count > seen;
  }
  /** A field of the message: "pose.pose.position.x", "ranges[3]". null as long as there is none. */
  value(path) {
    let found = this.message;
    for (const [, key, index] of path.matchAll(/([A-Za-z_]\w*)|\[(\d+)\]/g)) {
      if (found === null) return null;
      if (index !== undefined) found = found[Number(index)] ?? null;
      else if (typeof found !== "object" || !(key in found)) throw new Error(`${this.topic} has no field '${path}'`);
      else found = found[key];
    }
    return found;
  }
}

/** A control step: simulated time, its number, a 64-bit random word (BigInt) of the program's own. */
export class Step {
  constructor(message) {
    this.program = message.program;
    this.number = message.step;
    this.time_ns = BigInt(message.time.sec) * 1000000000n + BigInt(message.time.nanosec);
    this.random = BigInt(message.random ?? 0);
  }
  get time_s() { return Number(this.time_ns) / 1e9; }
  /** The step's random words: the one that came, then those that SplitMix64 makes from it. */
  bits(index = 0) {
    if (index === 0) return this.random;
    const word = (x) => BigInt.asUintN(64, x);
    let z = word(this.random + BigInt(index) * 0x9E3779B97F4A7C15n);
    z = word((z ^ (z >> 30n)) * 0xBF58476D1CE4E5B9n);
    z = word((z ^ (z >> 27n)) * 0x94D049BB133111EBn);
    return z ^ (z >> 31n);
  }
  /** A random number in [0, 1), a multiple of 2^-53: the same in every language, and again in a run with the same seed.
   *  @param index  another number for each; the same one again for the same */
  uniform(index = 0) { return Number(this.bits(index) >> 11n) * 2 ** -53; }
}

/** A connection to a run: topics, services, statuses. */
export class Connection {
  statuses = [];
  _inStep = false;
  #link = null;
  #lost = null;
  #ids = 0;
  #readings = new Map();
  #handlers = new Map();
  #answers = new Map();  // by id: [resolve, reject]
  #steps = [];
  #wake = null;

  /** Tries for a while: client and run may start in any order. */
  static async connect(options = {}) {
    const made = new this(options);
    await made._open();
    return made;
  }

  /** Use connect(). */
  constructor({ url, timeout_s = 10, WebSocket = globalThis.WebSocket, ...more } = {}) {
    for (const name of Object.keys(more)) throw new TypeError(`there is no option '${name}'`);
    this.url = url ?? env.SANDLOT_URL ?? (env === globalThis.process?.env ? "tcp://127.0.0.1:8765" : "ws://127.0.0.1:8765");
    this.timeout_s = timeout_s;
    this._WebSocket = WebSocket;
  }

  /** Called with each refusal that answers no call; prints it unless it is replaced. */
  onStatus = (message) => {
    if (message.level !== "info" && message.level !== "none") console.error(`sandlot: ${message.level}: ${message.msg}`);
  };

  async _open() {
    const end = Date.now() + 1000 * this.timeout_s;
    for (;;) {
      const later = await new Promise((done, failed) => this.#connect(done, failed).catch(failed));
      if (!later) return;
      const page = globalThis.location?.origin;  // of a page in a browser
      if (Date.now() > end) throw new Disconnected(`no run answers at ${this.url}: start one with --port${page ? ` and --allow-origin ${page}` : ""}`);
      await after(0.05);
    }
  }

  /** @param done  called when it is open, or with true when it may be tried again */
  async #connect(done, failed) {
    let open = false;
    const on = {
      open: () => { open = true; done(); },
      message: (text) => this.#take(JSON.parse(text)),
      close: (error, code, reason) => {
        if (open) return this.#lose(code, reason);
        if (error && !["ECONNREFUSED", "ENOENT"].includes(error.code)) return failed(new Disconnected(`${this.url}: ${error.message}`));
        done(true);
      },
    };
    const place = /^(tcp|ws|wss|http|https):\/\/(\[[0-9a-fA-F:.]+\]|[^:/?#]+):(\d+)([/?#].*)?$/.exec(this.url);
    if (!place && !this.url.startsWith("unix:"))
      throw new TypeError(`'${this.url}' is not an address: ws://HOST:PORT, the address that a run prints, or in node tcp://HOST:PORT or unix:PATH`);
    const [, scheme, host, port, rest = "/"] = place ?? [];
    const inNode = env === globalThis.process?.env;
    const secure = scheme === "wss" || scheme === "https";
    if (place && this._WebSocket && (!inNode || secure || scheme === "ws")) {
      const socket = new this._WebSocket(`${secure ? "wss" : "ws"}://${host}:${port}${rest}`);
      socket.onopen = on.open;
      socket.onmessage = (event) => on.message(event.data);
      socket.onerror = () => {};  // close comes, too
      socket.onclose = (event) => on.close(null, event.code, event.reason);
      this.#link = { send: (text) => socket.send(text), close: () => socket.close() };
    } else if (inNode && !secure) {
      const { openLines } = await import("./node_lines.mjs");
      this.#link = openLines(place ? { host: host.replace(/^\[|\]$/g, ""), port: Number(port) } : { path: this.url.slice(5) }, on);
    } else {
      throw new TypeError(`${this.url} needs ${inNode ? "the option WebSocket, such as the class of the package ws" : "node"}`);
    }
  }

  /** Why there is nothing to talk to any more; null as long as there is. */
  get lost() { return this.#lost; }

  close() {
    this.#lost ??= new Disconnected("this connection was closed");
    this.#link?.close();
    this.#link = null;
    this.#tell();
  }

  // ------------------------------------------------------------------------------------------------------- messages

  /** Sends an operation of docs/clients.md. */
  send(message) {
    if (this.#lost) throw this.#lost;
    this.#link.send(JSON.stringify(message, (key, value) => {
      if (typeof value === "number" && !Number.isFinite(value)) throw new RangeError(`'${key}' is ${value}, which JSON cannot hold`);
      return value;
    }));
  }

  nextId() { return `js${++this.#ids}`; }

  #take(message) {
    if (message.op === "publish") {
      const reading = this.#readings.get(message.topic);
      if (reading) reading.message = message.msg, ++reading.count;
      for (const handler of this.#handlers.get(message.topic) ?? []) handler(message.msg);
    } else if (message.op === "sandlot.tick") {
      this.#steps.push(new Step(message));
      this.#tell();
    } else if (message.op === "status") {
      this.statuses = [...this.statuses.slice(-99), message];
      const [, reject] = this.#answers.get(message.id) ?? [];
      if (reject) this.#answers.delete(message.id), reject(new Refused(message.msg));
      else this.onStatus(message);
    } else if (this.#answers.has(message.id)) {
      const [resolve] = this.#answers.get(message.id);
      this.#answers.delete(message.id);
      resolve(message);
    }
  }

  /** A farewell names the reason: in a WebSocket the code and reason of its end, over TCP the last line. */
  #lose(code, reason) {
    const last = this.statuses.at(-1);
    const ended = code === undefined ? last?.level === "info" : code === 1001;
    const why = code === undefined ? (last?.level === "error" && !last.id ? last.msg : "") : reason;
    this.#lost ??= ended ? new RunEnded("the run has ended")
      : new Disconnected(why ? `the server has closed the connection: ${why}` : `the connection to ${this.url} broke`);
    this.#link = null;
    for (const [, reject] of this.#answers.values()) reject(this.#lost);
    this.#answers.clear();
    this.#tell();
  }

  #tell() {
    const wake = this.#wake;
    this.#wake = null;
    wake?.();
  }

  /** The answer to a request, which is sent with an id. Rejects with Refused for the server's reason. */
  async ask(message, timeout_s = this.timeout_s) {
    const id = this.nextId();
    let timer;
    try {
      return await new Promise((resolve, reject) => {
        this.#answers.set(id, [resolve, reject]);
        timer = setTimeout(() => reject(new Error(`no answer to ${message.service ?? message.op} within ${timeout_s} s`)), 1000 * timeout_s);
        this.send({ ...message, id });
      });
    } finally {
      clearTimeout(timer);
      this.#answers.delete(id);
    }
  }

  /** The next control step; null when the run has ended. */
  async _nextStep() {
    for (;;) {
      if (this.#steps.length > 0) return this.#steps.shift();
      if (this.#lost instanceof RunEnded) return null;
      if (this.#lost) throw this.#lost;
      await new Promise((done) => { this.#wake = done; });
    }
  }

  // --------------------------------------------------------------------------------------------------------- topics

  /** The latest message of a topic: "/rover/laser/ranges". @param handler  called with each */
  subscribeTopic(topic, handler, throttle_ms = 0) {
    if (handler) this.#handlers.set(topic, [...(this.#handlers.get(topic) ?? []), handler]);
    if (!this.#readings.has(topic)) this.#readings.set(topic, new Reading(topic));
    this.send({ op: "subscribe", topic, throttle_rate: throttle_ms, id: `subscribe:${topic}` });
    return this.#readings.get(topic);
  }

  publish(topic, message) {
    if (this._inStep && this.#lost instanceof RunEnded) return;  // the loop over the steps ends
    this.send({ op: "publish", topic, msg: message });
  }

  /** Calls a service. Rejects with Refused for the server's reason. */
  async callService(service, args = {}, timeout_s = this.timeout_s) {
    const answer = await this.ask({ op: "call_service", service, args }, timeout_s);
    if (!answer.result) throw new Refused(String(answer.values));
    return answer.values;
  }
  call(service, args, timeout_s) { return this.callService(service, args, timeout_s); }

  /** Types by topic. */
  async topics() {
    const found = await this.callService("/rosapi/topics");
    return Object.fromEntries(found.topics.map((topic, i) => [topic, found.types[i]]));
  }
  async services() { return (await this.callService("/rosapi/services")).services; }
}

/** What robots and teams have in common. */
class Driver extends Connection {
  period_s = null;  // of the control steps, once steps() has begun
  _samples = [];
  #begun = false;
  #clock = null;

  static async connect(name, options = {}) {
    const made = new this(name, options);
    await made._open();
    try {
      await made._claim();
    } catch (error) {
      made.close();
      throw error;
    }
    return made;
  }

  constructor(kind, name, { lockstep = false, deadline_s = 1, token, ...rest }) {
    super(rest);
    this.name = name;
    this.lockstep = lockstep;
    this._deadline_s = deadline_s;
    const query = /[?&]token=([^&#]*)/.exec(this.url);
    this._who = { token: token ?? (query ? decodeURIComponent(query[1]) : env.SANDLOT_TOKEN ?? ""), [kind]: name };
  }

  async _claim() {
    this._robots = (await this.ask({ op: "sandlot.claim", mode: "free", ...this._who })).robots;
    this._topics = Object.keys(await this.topics());
  }

  /** "laser" or "laser/ranges" of a robot as a topic. */
  _topic(name) {
    const wanted = `/${name}`;
    const found = this._topics.find((topic) => topic === wanted || topic.startsWith(`${wanted}/`));
    if (!found) throw new Refused(`'${name}' publishes nothing; there are: ${[...this._topics].sort().join(", ")}`);
    return found;
  }

  /** The control steps of a program in lockstep, until the run ends. What is commanded within one acts with its end. */
  async *steps() {
    if (!this.lockstep) throw new Refused("steps() is for lockstep: true; spin() is for others");
    if (!this.#begun) {  // when everything is subscribed to, so that the first step has its readings
      this.#begun = true;
      const answer = await this.ask({ op: "sandlot.claim", mode: "lockstep", deadline_ms: 1000 * this._deadline_s, ...this._who });
      this.period_s = answer.programs[0].control_period_s;
    }
    for (let step; (step = await this._nextStep());) {
      this._inStep = true;
      try {
        yield step;
      } finally {  // also of a loop that is left
        this._inStep = false;
        const samples = this._samples.length > 0 ? { samples: this._samples.splice(0) } : {};
        if (!this.lost) this.send({ op: "sandlot.done", step: step.number, program: step.program, ...samples });
      }
    }
  }

  /** Waits by the wall clock while messages come. @return false: the run has ended */
  async spin(seconds) {
    if (!this.lost) await after(seconds);
    if (this.lost && !(this.lost instanceof RunEnded)) throw this.lost;
    return !this.lost;
  }

  /** Simulated time and its speed, for programs that run freely: clock.mjs. */
  get clock() {
    if (!this.#clock) {
      this.#clock = new Clock();
      this.subscribeTopic("/sandlot/step_times", (m) =>
        this.#clock.take(m.stamp.sec + m.stamp.nanosec / 1e9, m.step_s, m.wall_s, undefined, m.restarted));
    }
    return this.#clock;
  }
}

/** Gives a class the devices of a robot; `driver` is the connection. */
const withDevices = (Base) => class extends Base {
  #readings = new Map();

  /** The latest message of a device: "laser", or "eye/objects" of one with several topics. @param handler  called with each */
  subscribe(device, handler) {
    const reading = this.driver.subscribeTopic(this.driver._topic(`${this.name}/${device}`), handler);
    this.#readings.set(device, reading);
    return reading;
  }

  /** The latest message of a device; null until one has come. The first call subscribes: make it before steps(). */
  latest(device) { return this.#reading(device).message; }

  /** A field of the latest message: "drive.pose.pose.position.x", "laser/ranges.ranges[3]". */
  value(path) {
    const dot = path.indexOf(".");
    return this.#reading(dot < 0 ? path : path.slice(0, dot)).value(dot < 0 ? "" : path.slice(dot + 1));
  }

  #reading(device) { return this.#readings.get(device) ?? this.subscribe(device); }

  /** A command for a device, at its active level or "drive/ideal". */
  command(device, message) { this.driver.publish(`/${this.name}/${device}`, message); }

  /** In lockstep: lets a device take a sample although none is due. */
  sample(device) { this.driver._samples.push(this.driver === this ? device : `${this.name}/${device}`); }

  /** Calls a service of a device, "odometry/reset". In lockstep it is answered after the step: await it in a later one. */
  call(service, args, timeout_s) {
    return this.driver.callService(service.startsWith("/") ? service : `/${this.name}/${service}`, args, timeout_s);
  }
};

/** The client that drives a robot: await Robot.connect("rover", { lockstep: true }). */
export class Robot extends withDevices(Driver) {
  driver = this;
  constructor(name, options) { super("robot", name, options); }
}

/** A robot of a team. */
export class Member extends withDevices(Object) {
  constructor(team, name) {
    super();
    this.driver = team;
    this.name = name;
  }
}

/** The client that drives all robots of a team: team.robots.red1 has the methods of a Robot. */
export class Team extends Driver {
  robots = {};
  constructor(name, options) { super("team", name, options); }
  async _claim() {
    await super._claim();
    for (const name of this._robots) this.robots[name] = new Member(this, name);
  }
  subscribe(robot, device, handler) { return this.subscribeTopic(this._topic(`${robot}/${device}`), handler); }
  command(robot, device, message) { this.publish(`/${robot}/${device}`, message); }
}
