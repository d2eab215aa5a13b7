// Made-up clients: one in lockstep on time, one late, one free, the pages that are connected, a robot that waits, a process.
const bins = (first_s, counts) => ({ first_s, per_decade: 20, counts });
const durations = (mean) => ({ last: mean, mean, p99: 2.1 * mean, max: 4 * mean });
const base = { address: '127.0.0.1:50312', robots: [], bytes_in: 52_000, bytes_out: 931_000, messages: 900, messages_per_s: 40.2, commands: 0, commands_per_s: 0, dropped: 0, refused: 0, stops: 0, programs: [] };
const bell = (n, middle, width, most) => Array.from({ length: n }, (_, i) => Math.round(most * Math.exp(-(((i - middle) / width) ** 2))));

export function clientsMessage(pages, robots, time_s) {
  const program = (robot, more) => ({ path: `${robot}/controller`, control_period_s: 0.05, steps: Math.round(20 * time_s), misses: 0, waiting_s: null, step_s: durations(0.05), ...more });
  const [one = 'rover', two = 'rover_2', three = 'rover_3'] = robots;
  return {
    clients: [
      ...pages.map((id) => ({ ...base, id, protocol: 'page', name: '', role: 'admin', drives: '', mode: 'watching', connected_s: time_s, messages_per_s: 0.4, bytes_out: 8_310_000 })),
      { ...base, id: 901, protocol: 'rosbridge, TCP', name: 'wander.py', role: 'robot', drives: one, robots: [one], mode: 'lockstep', connected_s: time_s, commands: 400, commands_per_s: 20,
        programs: [program(one, { deadline_s: 0.1, latency_s: durations(0.0021), latencies: bins(1e-3, bell(22, 7, 4, 300)) })] },
      { ...base, id: 902, protocol: 'rosbridge', name: 'a brain with quite a long name', role: 'robot', drives: two, robots: [two], mode: 'lockstep', connected_s: time_s, dropped: 12, refused: 3,
        programs: [program(two, { deadline_s: 0.02, misses: Math.round(time_s), latency_s: durations(0.0122), latencies: bins(2e-3, bell(30, 16, 7, 200)) })] },
      { ...base, id: 903, protocol: 'rosbridge', name: '', role: 'team', drives: 'red', robots: [one, two], mode: 'free', connected_s: time_s, commands: 900, commands_per_s: 12.4, stops: 2 },
    ],
    programs: [
      { path: `${one}/controller`, kind: 'remote', is_client: true, connected: true, started: false, answers: 20, misses: 0 },
      { path: `${three}/controller`, kind: 'remote', is_client: true, connected: true, started: false, answers: 0, misses: 0 },
      { path: `${two}/helper`, kind: 'remote', is_client: true, connected: true, started: true, answers: 12, misses: 1 },
    ],
  };
}
