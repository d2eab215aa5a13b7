// A client of the Foxglove WebSocket protocol. It reconnects by itself and keeps what was asked for: subscriptions, published topics and
// watched parameters outlive a connection. Works with any server of the protocol; what is Sandlot's own is in app/.
import {decoderFor, Decoder} from './decoders';
import {decodeServerFrame, encodeClientMessage, encodeServiceRequest} from './frames';
import {Signal} from './signal';
import type {Channel, ClientOptions, ConnectionGraph, ConnectionState, Parameter, ServerInfo, ServerStatus, Service, SocketLike} from './types';

export type {Channel, ConnectionGraph, ConnectionState, Parameter, ParameterValue, ServerInfo, ServerStatus, Service} from './types';

/** One message; decoded once, when the first listener asks. */
export class Message {
  private decoded: unknown = undefined;
  private done = false;

  constructor(readonly channel: Channel, readonly time_ns: bigint, readonly bytes: Uint8Array, private readonly decoder: Decoder | null) {}

  value(): unknown {
    if (!this.done) {
      this.done = true;
      this.decoded = this.decoder ? this.decoder(this.bytes) : undefined;
    }
    return this.decoded;
  }

  /** The payload as a buffer of its own start, for decoders that count from 0. */
  buffer(): ArrayBuffer {
    const {buffer, byteOffset, byteLength} = this.bytes;
    return (buffer as ArrayBuffer).slice(byteOffset, byteOffset + byteLength);
  }
}

export type Handler = (message: Message) => void;

interface Subscription {
  topic: string;
  id: number;
  handlers: Set<Handler>;
  background: number;  // how many of the handlers want messages while the page is hidden too
  channel: Channel | null;
  decoder: Decoder | null;
  complained: boolean;
}

interface Pending {
  resolve: (value: unknown) => void;
  reject: (error: Error) => void;
  timer: ReturnType<typeof setTimeout>;
}

const call_timeout_ms = 10_000;
const unsent_limit_bytes = 4 * 1024 * 1024;
const protocols = ['foxglove.websocket.v1', 'foxglove.sdk.v1'];

export class Client {
  state: ConnectionState = 'closed';
  info: ServerInfo | null = null;
  closeReason = '';
  readonly channels = new Map<string, Channel>();
  readonly services = new Map<string, Service>();
  graph: ConnectionGraph = {publishedTopics: new Map(), subscribedTopics: new Map(), advertisedServices: new Map()};
  /** What came and went, for the page's own statistics. */
  readonly counts = {frames: 0, bytes: 0, malformed: 0, reconnects: 0};

  readonly onState = new Signal<ConnectionState>();
  readonly onInfo = new Signal<ServerInfo>();
  readonly onChannels = new Signal();
  readonly onStatus = new Signal<ServerStatus>();
  readonly onParameters = new Signal<Parameter[]>();
  readonly onGraph = new Signal<ConnectionGraph>();
  readonly onTime = new Signal<bigint>();

  private socket: SocketLike | null = null;
  private readonly byId = new Map<number, Channel>();
  private readonly subscriptions = new Map<string, Subscription>();
  private readonly subscriptionsById = new Map<number, Subscription>();
  private readonly calls = new Map<number, Pending>();
  private readonly assets = new Map<number, Pending>();
  private readonly parameterCalls = new Map<string, Pending>();
  private readonly publications = new Map<number, {topic: string; schemaName: string}>();
  private readonly watchedParameters = new Set<string>();
  private graphListeners = 0;
  private hidden = false;
  private next = 1;
  private attempts = 0;
  private retry: ReturnType<typeof setTimeout> | undefined;
  private guard: ReturnType<typeof setInterval> | undefined;
  private heardAt_ms = 0;
  private openedAt_ms = 0;

  constructor(private readonly options: ClientOptions) {}

  // --- the connection

  connect(): void {
    clearTimeout(this.retry);
    this.drop('');
    this.setState('connecting');
    const make = this.options.makeSocket ?? ((address, names) => new WebSocket(address, names) as unknown as SocketLike);
    let socket: SocketLike;
    try {
      socket = make(this.options.address(), protocols);
    } catch (error) {
      this.closed(String(error));
      return;
    }
    this.socket = socket;
    socket.binaryType = 'arraybuffer';
    this.openedAt_ms = this.heardAt_ms = Date.now();
    socket.onmessage = (event) => {
      if (this.socket === socket) this.receive(event.data);
    };
    socket.onclose = (event) => {
      if (this.socket === socket) this.closed(event.reason);
    };
    socket.onerror = () => undefined;  // close follows
    this.guard = setInterval(() => this.checkAlive(), 1000);
  }

  close(): void {
    clearTimeout(this.retry);
    this.drop('closed by the page');
    this.setState('closed');
  }

  private checkAlive(): void {
    const now_ms = Date.now();
    if (this.state === 'connecting' && now_ms - this.openedAt_ms > (this.options.handshake_ms ?? 10_000)) {
      this.closed('the server did not answer');
    } else if (this.state === 'open' && this.info?.metadata?.sandlot_version && now_ms - this.heardAt_ms > (this.options.silence_ms ?? 10_000)) {
      this.closed('the server fell silent');
    }
  }

  private closed(reason: string): void {
    this.drop(reason);
    this.closeReason = reason;
    const steps = this.options.backoff_ms ?? [300, 700, 1500, 3000, 5000];
    const wait_ms = steps[Math.min(this.attempts, steps.length - 1)] ?? 3000;
    this.attempts += 1;
    this.counts.reconnects += 1;
    this.setState('waiting');
    this.retry = setTimeout(() => this.connect(), wait_ms * (0.8 + 0.4 * Math.random()));
  }

  private drop(reason: string): void {
    clearInterval(this.guard);
    const socket = this.socket;
    this.socket = null;
    if (socket) {
      socket.onmessage = socket.onclose = socket.onopen = null;
      try {
        socket.close();
      } catch {
        // already gone
      }
    }
    this.channels.clear();
    this.byId.clear();
    this.services.clear();
    for (const part of [this.graph.publishedTopics, this.graph.subscribedTopics, this.graph.advertisedServices]) part.clear();
    this.info = null;
    for (const s of this.subscriptions.values()) s.channel = null;
    for (const list of [this.calls, this.assets, this.parameterCalls]) {
      for (const pending of list.values()) {
        clearTimeout(pending.timer);
        pending.reject(new Error(reason || 'the connection was lost'));
      }
      list.clear();
    }
  }

  private setState(state: ConnectionState): void {
    if (state === this.state) return;
    this.state = state;
    this.onState.emit(state);
  }

  private send(data: string | ArrayBuffer): boolean {
    if (!this.socket || this.state !== 'open') return false;
    this.socket.send(data);
    return true;
  }

  private say(message: Record<string, unknown>): boolean {
    return this.send(JSON.stringify(message));
  }

  // --- what the server says

  private receive(data: unknown): void {
    this.heardAt_ms = Date.now();
    this.counts.frames += 1;
    try {
      if (typeof data === 'string') {
        this.counts.bytes += data.length;
        this.receiveText(JSON.parse(data) as Record<string, unknown>);
      } else if (data instanceof ArrayBuffer) {
        this.counts.bytes += data.byteLength;
        this.receiveBinary(data);
      }
    } catch (error) {
      this.counts.malformed += 1;
      if (this.counts.malformed <= 10) console.warn('a message from the server could not be read:', error);
    }
  }

  private receiveText(message: Record<string, unknown>): void {
    switch (message.op) {
      case 'serverInfo':
        this.info = message as unknown as ServerInfo;
        this.info.capabilities ??= [];
        this.attempts = 0;
        this.setState('open');
        this.onInfo.emit(this.info);
        this.restore();
        break;
      case 'advertise':
        for (const c of message.channels as Channel[]) {
          this.channels.set(c.topic, c);
          this.byId.set(c.id, c);
        }
        this.link();
        this.onChannels.emit();
        break;
      case 'unadvertise':
        for (const id of message.channelIds as number[]) this.forget(id);
        this.onChannels.emit();
        break;
      case 'advertiseServices':
        for (const s of message.services as Service[]) this.services.set(s.name, s);
        this.onChannels.emit();
        break;
      case 'unadvertiseServices':
        for (const id of message.serviceIds as number[]) {
          for (const s of this.services.values()) if (s.id === id) this.services.delete(s.name);
        }
        break;
      case 'status':
        this.onStatus.emit(message as unknown as ServerStatus);
        break;
      case 'parameterValues': {
        const parameters = (message.parameters ?? []) as Parameter[];
        this.onParameters.emit(parameters);
        if (typeof message.id === 'string') this.settle(this.parameterCalls, message.id, parameters);
        break;
      }
      case 'serviceCallFailure':
        this.fail(this.calls, message.callId as number, String(message.message ?? 'the call failed'));
        break;
      case 'connectionGraphUpdate':
        this.updateGraph(message);
        break;
    }
  }

  private receiveBinary(data: ArrayBuffer): void {
    const frame = decodeServerFrame(data);
    if (!frame) {
      this.counts.malformed += 1;
      return;
    }
    if (frame.kind === 'message') {
      const s = this.subscriptionsById.get(frame.subscription);
      if (!s?.channel) return;
      const message = new Message(s.channel, frame.time_ns, frame.payload, s.decoder);
      for (const handler of [...s.handlers]) {
        try {
          handler(message);
        } catch (error) {
          this.counts.malformed += 1;
          if (!s.complained) console.warn(`a message of ${s.topic} could not be read:`, error);
          s.complained = true;
        }
      }
    } else if (frame.kind === 'time') {
      this.onTime.emit(frame.time_ns);
    } else if (frame.kind === 'response') {
      this.settle(this.calls, frame.call, JSON.parse(new TextDecoder().decode(frame.payload)));
    } else if (frame.error !== null) {
      this.fail(this.assets, frame.request, frame.error);
    } else {
      this.settle(this.assets, frame.request, frame.data);
    }
  }

  private forget(channelId: number): void {
    const channel = this.byId.get(channelId);
    if (!channel) return;
    this.byId.delete(channelId);
    if (this.channels.get(channel.topic)?.id === channelId) this.channels.delete(channel.topic);
    const s = this.subscriptions.get(channel.topic);
    if (s && s.channel?.id === channelId) s.channel = null;
  }

  private updateGraph(message: Record<string, unknown>): void {
    const merge = (into: Map<string, string[]>, list: unknown, removed: unknown, idsKey: string): void => {
      for (const entry of (list ?? []) as Record<string, unknown>[]) into.set(String(entry.name), (entry[idsKey] ?? []) as string[]);
      for (const name of (removed ?? []) as string[]) into.delete(name);
    };
    merge(this.graph.publishedTopics, message.publishedTopics, message.removedTopics, 'publisherIds');
    merge(this.graph.subscribedTopics, message.subscribedTopics, message.removedTopics, 'subscriberIds');
    merge(this.graph.advertisedServices, message.advertisedServices, message.removedServices, 'providerIds');
    this.onGraph.emit(this.graph);
  }

  /** Says again, on a new connection, all that was asked for on the last one. */
  private restore(): void {
    if (this.publications.size > 0) {
      this.say({op: 'advertise', channels: [...this.publications].map(([id, p]) => ({id, topic: p.topic, encoding: 'json', schemaName: p.schemaName}))});
    }
    if (this.watchedParameters.size > 0) this.say({op: 'subscribeParameterUpdates', parameterNames: [...this.watchedParameters]});
    if (this.graphListeners > 0) this.askGraph(true);
  }

  // --- subscriptions

  /** Messages of a topic, whenever it exists. `background`: while the page is hidden too. Returns the function that ends it. */
  subscribe(topic: string, handler: Handler, options: {background?: boolean} = {}): () => void {
    let s = this.subscriptions.get(topic);
    if (!s) {
      s = {topic, id: this.next++, handlers: new Set(), background: 0, channel: null, decoder: null, complained: false};
      this.subscriptions.set(topic, s);
      this.subscriptionsById.set(s.id, s);
    }
    const subscription = s;
    subscription.handlers.add(handler);
    if (options.background) subscription.background += 1;
    this.link();
    let ended = false;
    return () => {
      if (ended) return;
      ended = true;
      subscription.handlers.delete(handler);
      if (options.background) subscription.background -= 1;
      if (subscription.handlers.size > 0) return;
      this.subscriptions.delete(topic);
      this.subscriptionsById.delete(subscription.id);
      if (subscription.channel) this.say({op: 'unsubscribe', subscriptionIds: [subscription.id]});
    };
  }

  /** Subscribes at the server to what is wanted and there, and leaves what is not wanted now. */
  private link(): void {
    if (this.state !== 'open') return;
    const wanted: {id: number; channelId: number}[] = [];
    const unwanted: number[] = [];
    for (const s of this.subscriptions.values()) {
      const wants = !this.hidden || s.background > 0;
      const channel = this.channels.get(s.topic);
      if (wants && channel && s.channel?.id !== channel.id) {
        // A new id for each subscription at the server: messages of a channel of that name that is gone are not taken for this one's.
        if (s.channel) unwanted.push(s.id);
        this.subscriptionsById.delete(s.id);
        s.id = this.next++;
        this.subscriptionsById.set(s.id, s);
        s.channel = channel;
        s.complained = false;
        try {
          s.decoder = decoderFor(channel);
        } catch (error) {
          console.warn(`the schema of ${s.topic} could not be read:`, error);
          s.decoder = null;
        }
        wanted.push({id: s.id, channelId: channel.id});
      } else if (!wants && s.channel) {
        s.channel = null;
        unwanted.push(s.id);
      }
    }
    if (unwanted.length > 0) this.say({op: 'unsubscribe', subscriptionIds: unwanted});
    if (wanted.length > 0) this.say({op: 'subscribe', subscriptions: wanted});
  }

  /** A page that nobody sees asks for nothing but what is marked `background`. */
  setHidden(hidden: boolean): void {
    if (this.hidden === hidden) return;
    this.hidden = hidden;
    this.link();
  }

  // --- services

  private settle(list: Map<number, Pending> | Map<string, Pending>, key: number | string, value: unknown): void {
    const pending = (list as Map<number | string, Pending>).get(key);
    if (!pending) return;
    (list as Map<number | string, Pending>).delete(key);
    clearTimeout(pending.timer);
    pending.resolve(value);
  }

  private fail(list: Map<number, Pending> | Map<string, Pending>, key: number | string, why: string): void {
    const pending = (list as Map<number | string, Pending>).get(key);
    if (!pending) return;
    (list as Map<number | string, Pending>).delete(key);
    clearTimeout(pending.timer);
    pending.reject(new Error(why));
  }

  private pend<K extends number | string, T>(list: Map<K, Pending>, key: K, what: string, timeout_ms: number, go: () => boolean): Promise<T> {
    return new Promise<T>((resolve, reject) => {
      const timer = setTimeout(() => this.fail(list as Map<number, Pending>, key as number, `${what}: no answer within ${timeout_ms / 1000} s`), timeout_ms);
      list.set(key, {resolve: resolve as (v: unknown) => void, reject, timer});
      if (!go()) this.fail(list as Map<number, Pending>, key as number, `${what}: not connected`);
    });
  }

  call<T>(name: string, request: Record<string, unknown>, timeout_ms = call_timeout_ms): Promise<T> {
    const service = this.services.get(name);
    if (!service) return Promise.reject(new Error(this.state === 'open' ? `the server has no service ${name}` : 'not connected'));
    const call = this.next++;
    const payload = new TextEncoder().encode(JSON.stringify(request));
    return this.pend<number, T>(this.calls, call, name, timeout_ms, () => this.send(encodeServiceRequest(service.id, call, 'json', payload)));
  }

  fetchAsset(uri: string, timeout_ms = 30_000): Promise<Uint8Array> {
    const requestId = this.next++;
    return this.pend<number, Uint8Array>(this.assets, requestId, uri, timeout_ms, () => this.say({op: 'fetchAsset', uri, requestId}));
  }

  // --- parameters

  getParameters(parameterNames: string[]): Promise<Parameter[]> {
    const id = `get-${this.next++}`;
    return this.pend<string, Parameter[]>(this.parameterCalls, id, 'parameters', call_timeout_ms, () => this.say({op: 'getParameters', parameterNames, id}));
  }

  /** The values that hold afterwards: the old ones where a change was refused, with the server's reasons. */
  async setParameters(parameters: Parameter[]): Promise<{parameters: Parameter[]; reasons: string[]}> {
    const id = `set-${this.next++}`;
    const reasons: string[] = [];
    const stop = this.onStatus.on((status) => {
      if (status.level > 0 && reasons.length < 20) reasons.push(status.message);
    });
    try {
      const answered = await this.pend<string, Parameter[]>(this.parameterCalls, id, 'parameters', call_timeout_ms, () => this.say({op: 'setParameters', parameters, id}));
      return {parameters: answered, reasons};
    } finally {
      stop();
    }
  }

  watchParameters(names: string[]): void {
    const fresh = names.filter((name) => !this.watchedParameters.has(name));
    for (const name of fresh) this.watchedParameters.add(name);
    if (fresh.length > 0) this.say({op: 'subscribeParameterUpdates', parameterNames: fresh});
  }

  unwatchParameters(names: string[]): void {
    const known = names.filter((name) => this.watchedParameters.delete(name));
    if (known.length > 0) this.say({op: 'unsubscribeParameterUpdates', parameterNames: known});
  }

  // --- publishing

  /** Publishes JSON on a topic until closed. A message is not sent when the socket is clogged: an old command is worth nothing. */
  publisher(topic: string, schemaName: string): {publish: (value: unknown) => boolean; close: () => void} {
    const id = this.next++;
    this.publications.set(id, {topic, schemaName});
    this.say({op: 'advertise', channels: [{id, topic, encoding: 'json', schemaName}]});
    return {
      publish: (value) => {
        if ((this.socket?.bufferedAmount ?? 0) > unsent_limit_bytes) return false;
        return this.send(encodeClientMessage(id, new TextEncoder().encode(JSON.stringify(value))));
      },
      close: () => {
        if (this.publications.delete(id)) this.say({op: 'unadvertise', channelIds: [id]});
      },
    };
  }

  // --- who talks to whom

  subscribeGraph(handler: (graph: ConnectionGraph) => void): () => void {
    const stop = this.onGraph.on(handler);
    this.graphListeners += 1;
    if (this.graphListeners === 1) this.askGraph(true);
    else handler(this.graph);
    return () => {
      stop();
      this.graphListeners -= 1;
      if (this.graphListeners === 0) this.askGraph(false);
    };
  }

  private askGraph(on: boolean): void {
    if (!this.info?.capabilities.includes('connectionGraph')) return;
    if (on) this.graph = {publishedTopics: new Map(), subscribedTopics: new Map(), advertisedServices: new Map()};
    this.say({op: on ? 'subscribeConnectionGraph' : 'unsubscribeConnectionGraph'});
  }
}
