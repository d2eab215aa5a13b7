// Makes values of the bytes of a message, by the channel's encoding.
import {parse} from '@foxglove/rosmsg';
import {MessageReader} from '@foxglove/rosmsg2-serialization';

export interface ChannelFormat {
  encoding: string;
  schemaName: string;
  schema: string;
  schemaEncoding?: string;
}

export type Decoder = (bytes: Uint8Array) => unknown;

/** Readers by schema: a thousand robots share one reader for their thousand scans. */
const readers = new Map<string, Decoder>();
const readers_max = 256;

/** Null when there is no way to read this channel; its bytes can still be counted. */
export function decoderFor(channel: ChannelFormat): Decoder | null {
  if (channel.encoding === 'json') return decodeJson;
  if (channel.encoding !== 'cdr' || (channel.schemaEncoding ?? 'ros2msg') !== 'ros2msg') return null;
  const key = `${channel.schemaName}\n${channel.schema}`;
  let reader = readers.get(key);
  if (!reader) {
    const messages = new MessageReader(parse(channel.schema, {ros2: true}));
    reader = (bytes) => messages.readMessage(bytes);
    if (readers.size >= readers_max) readers.clear();
    readers.set(key, reader);
  }
  return reader;
}

const utf8 = new TextDecoder();

export function decodeJson(bytes: Uint8Array): unknown {
  return JSON.parse(utf8.decode(bytes)) as unknown;
}

/** Seconds of a ROS time as the readers give it (nanosec or nsec, by the version of the schema). */
export function secondsOf(stamp: unknown): number {
  if (typeof stamp !== 'object' || stamp === null) return Number.NaN;
  const t = stamp as {sec?: number; nanosec?: number; nsec?: number};
  return (t.sec ?? Number.NaN) + (t.nanosec ?? t.nsec ?? 0) * 1e-9;
}
