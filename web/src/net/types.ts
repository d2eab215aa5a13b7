// What the Foxglove protocol tells, as types.
import type {ChannelFormat} from './decoders';

export type ConnectionState = 'connecting' | 'open' | 'waiting' | 'closed';

export interface Channel extends ChannelFormat {
  id: number;
  topic: string;
}

export interface Service {
  id: number;
  name: string;
  type: string;
}

export type ParameterValue = number | boolean | string | number[] | boolean[] | string[] | null | undefined;

export interface Parameter {
  name: string;
  value?: ParameterValue;
  type?: string;
}

export interface ServerInfo {
  name: string;
  capabilities: string[];
  supportedEncodings?: string[];
  metadata?: Record<string, string>;
  sessionId?: string;
}

export interface ServerStatus {
  level: number;
  message: string;
  id?: string;
}

export interface ConnectionGraph {
  publishedTopics: Map<string, string[]>;
  subscribedTopics: Map<string, string[]>;
  advertisedServices: Map<string, string[]>;
}

export interface SocketLike {
  binaryType: string;
  readonly readyState: number;
  readonly bufferedAmount?: number;
  onopen: ((event: unknown) => void) | null;
  onclose: ((event: {code: number; reason: string}) => void) | null;
  onerror: ((event: unknown) => void) | null;
  onmessage: ((event: {data: unknown}) => void) | null;
  send(data: string | ArrayBuffer): void;
  close(): void;
}

export interface ClientOptions {
  address: () => string;
  makeSocket?: (address: string, protocols: string[]) => SocketLike;
  handshake_ms?: number;
  silence_ms?: number;  // a Sandlot server says how it goes 5 times a second: silence is a dead connection
  backoff_ms?: number[];
}
