/** Lines of JSON over TCP or a Unix socket, for node: what sandlot_client.mjs uses there in place of a WebSocket. */
import net from "node:net";

/** @param where  { host, port } or { path }. @param on  { open, message(text), close(error) }: close comes once, after the last message */
export function openLines(where, on) {
  const socket = net.connect(where);
  let rest = [], error;
  socket.setNoDelay(true);
  socket.setEncoding("utf8");
  socket.on("connect", () => on.open());
  socket.on("data", (data) => {
    const lines = data.split("\n");
    if (lines.length === 1) return void rest.push(data);
    lines[0] = rest.join("") + lines[0];
    rest = [lines.pop()];
    for (const line of lines) if (line.trim()) on.message(line);
  });
  // Written once a turn, after what has come is read: a write after the server's farewell would end the socket before that is.
  let waiting = [], ended = false;
  const flush = () => {
    const text = waiting.join("");
    waiting = [];
    if (text && !ended && !socket.destroyed) socket.write(text);
  };
  socket.on("error", (e) => { error = e; });
  socket.on("end", () => { ended = true; });
  socket.on("close", () => on.close(error));
  return {
    send(text) {
      if (waiting.push(text + "\n") === 1) setImmediate(flush);
    },
    close() {
      flush();
      socket.destroySoon();
    },
  };
}
