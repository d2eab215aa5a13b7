// Binary frames of the Foxglove WebSocket protocol, little-endian (docs/viewer_protocol.md). Views into the frame are handed on, nothing
// is copied. A frame that is too short, or of an unknown kind, is null: a page must live through what a server sends.

export type ServerFrame =
  | {kind: 'message'; subscription: number; time_ns: bigint; payload: Uint8Array}
  | {kind: 'time'; time_ns: bigint}
  | {kind: 'response'; service: number; call: number; encoding: string; payload: Uint8Array}
  | {kind: 'asset'; request: number; error: string | null; data: Uint8Array};

const utf8 = new TextDecoder();

export function decodeServerFrame(buffer: ArrayBuffer): ServerFrame | null {
  const view = new DataView(buffer);
  const length = buffer.byteLength;
  if (length < 1) return null;
  switch (view.getUint8(0)) {
    case 1:
      if (length < 13) return null;
      return {
        kind: 'message',
        subscription: view.getUint32(1, true),
        time_ns: view.getBigUint64(5, true),
        payload: new Uint8Array(buffer, 13),
      };
    case 2:
      return length < 9 ? null : {kind: 'time', time_ns: view.getBigUint64(1, true)};
    case 3: {
      if (length < 13) return null;
      const encodingLength = view.getUint32(9, true);
      if (encodingLength > length - 13) return null;
      return {
        kind: 'response',
        service: view.getUint32(1, true),
        call: view.getUint32(5, true),
        encoding: utf8.decode(new Uint8Array(buffer, 13, encodingLength)),
        payload: new Uint8Array(buffer, 13 + encodingLength),
      };
    }
    case 4: {
      if (length < 10) return null;
      const failed = view.getUint8(5) !== 0;
      const errorLength = view.getUint32(6, true);
      if (errorLength > length - 10) return null;
      const error = utf8.decode(new Uint8Array(buffer, 10, errorLength));
      return {kind: 'asset', request: view.getUint32(1, true), error: failed ? error : null, data: new Uint8Array(buffer, 10 + errorLength)};
    }
    default:
      return null;
  }
}

export function encodeClientMessage(channel: number, payload: Uint8Array): ArrayBuffer {
  const buffer = new ArrayBuffer(5 + payload.byteLength);
  const view = new DataView(buffer);
  view.setUint8(0, 1);
  view.setUint32(1, channel, true);
  new Uint8Array(buffer).set(payload, 5);
  return buffer;
}

export function encodeServiceRequest(service: number, call: number, encoding: string, payload: Uint8Array): ArrayBuffer {
  const name = new TextEncoder().encode(encoding);
  const buffer = new ArrayBuffer(13 + name.byteLength + payload.byteLength);
  const view = new DataView(buffer);
  view.setUint8(0, 2);
  view.setUint32(1, service, true);
  view.setUint32(5, call, true);
  view.setUint32(9, name.byteLength, true);
  const bytes = new Uint8Array(buffer);
  bytes.set(name, 13);
  bytes.set(payload, 13 + name.byteLength);
  return buffer;
}
