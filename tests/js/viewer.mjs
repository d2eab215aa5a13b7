// A client of a run's page by @foxglove/ws-protocol, decoding with @foxglove/rosmsg and rosmsg2-serialization: nothing of ours.
import assert from "node:assert/strict";
import { parse } from "@foxglove/rosmsg";
import { MessageReader, MessageWriter } from "@foxglove/rosmsg2-serialization";
import protocol from "@foxglove/ws-protocol";
import { WebSocket } from "ws";
import { until } from "./served.mjs";

const { FoxgloveClient } = protocol;  // CommonJS

/** A client with what it was told. */
export class Viewer {
  channels = new Map();
  services = new Map();
  parameters = new Map();
  statuses = [];
  times = [];
  handlers = new Map();
  replies = new Map();
  assets = new Map();
  published = new Map();
  nextCall = 1;
  constructor(url, subprotocol) {
    this.socket = new WebSocket(url, [subprotocol]);
    this.client = new FoxgloveClient({ ws: this.socket });
    this.client.on("serverInfo", (info) => { this.info = info; });
    this.client.on("advertise", (list) => list.forEach((c) => this.channels.set(c.topic, c)));
    this.client.on("advertiseServices", (list) => list.forEach((s) => this.services.set(s.name, s)));
    this.client.on("parameterValues", ({ parameters }) => parameters.forEach((p) => this.parameters.set(p.name, p.value)));
    this.client.on("status", (status) => this.statuses.push(status));
    this.client.on("time", ({ timestamp }) => this.times.push(timestamp));
    this.client.on("message", (m) => this.handlers.get(m.subscriptionId)?.(m));
    this.client.on("serviceCallResponse", (r) => this.replies.set(r.callId, r));
    this.client.on("serviceCallFailure", (r) => this.replies.set(r.callId, r));
    this.client.on("fetchAssetResponse", (r) => this.assets.set(r.requestId, r));
    this.client.on("connectionGraphUpdate", (g) => g.publishedTopics.forEach((t) => this.published.set(t.name, t.publisherIds)));
    this.client.on("error", () => {});
  }
  /** Subscribes and decodes by the schema that the server sent. */
  async subscribe(topic, take) {
    const channel = await until(`channel ${topic}`, () => this.channels.get(topic));
    let decode;
    if (channel.encoding === "cdr") {
      const reader = new MessageReader(parse(channel.schema, { ros2: true }));
      decode = (data) => reader.readMessage(data);
    } else {
      decode = (data) => JSON.parse(new TextDecoder().decode(data));
    }
    const id = this.client.subscribe(channel.id);
    this.handlers.set(id, (m) => take(decode(m.data), m.timestamp));
    return id;
  }
  async call(name, request) {
    const service = await until(`service ${name}`, () => this.services.get(name));
    const types = (side, old) => parse(side?.schema ?? old, { ros2: true });
    const writer = new MessageWriter(types(service.request, service.requestSchema));
    const callId = this.nextCall++;
    const data = writer.writeMessage(request);
    this.client.sendServiceCallRequest({ serviceId: service.id, callId, encoding: "cdr", data: new DataView(data.buffer, data.byteOffset, data.byteLength) });
    const reply = await until(`the answer of ${name}`, () => this.replies.get(callId));
    assert.ok(reply.data, reply.message);
    return new MessageReader(types(service.response, service.responseSchema)).readMessage(reply.data);
  }
  async say(line) {
    return this.call("/sandlot/console", { line });
  }
  async number(address) {
    const { ok, text } = await this.say(`show ${address}`);
    assert.ok(ok, text);
    const found = /-?\d+(\.\d+)?(e[-+]?\d+)?|-?inf|nan/i.exec(text.slice(text.indexOf(address) + address.length));
    return Number(found?.[0]);
  }
  close() { this.client.close(); }
}
