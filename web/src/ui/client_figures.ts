// Clients as people read them: words, shares of a deadline, the shape of a latency histogram. No elements here.
import {formatNumber} from '../app/format';
import type {AnsweredProgram, ClientRow, OutsideProgram} from '../protocol';

/** "850 µs", "12.3 ms", "1.20 s". */
export function formatDuration(duration_s: number): string {
  if (!Number.isFinite(duration_s)) return '–';
  const ms = duration_s * 1000;
  if (ms < 0.9995) return `${Math.round(ms * 1000)} µs`;
  if (ms < 999.5) return `${ms < 9.995 ? ms.toFixed(2) : ms < 99.95 ? ms.toFixed(1) : ms.toFixed(0)} ms`;
  return duration_s < 59.95 ? `${duration_s.toFixed(duration_s < 9.995 ? 2 : 1)} s` : `${Math.round(duration_s / 60)} min`;
}

/** How long somebody has been here: "12 s", "4 min", "2 h". */
export function formatAge(age_s: number): string {
  return age_s < 59.5 ? `${Math.round(age_s)} s` : age_s < 3570 ? `${Math.round(age_s / 60)} min` : `${formatNumber(age_s / 3600, 2)} h`;
}

export type Judgement = 'good' | 'warn' | 'bad';

/** Whether an answer is out for longer than one that is merely late. */
export function isSilent(program: AnsweredProgram): boolean {
  return program.waiting_s !== null && program.waiting_s > program.deadline_s + 1;
}

/** How a program keeps its deadline: bad when it is silent, warn when it comes close to it. */
export function judge(program: AnsweredProgram): Judgement {
  if (isSilent(program)) return 'bad';
  return program.latency_s !== null && program.latency_s.p99 > 0.8 * program.deadline_s ? 'warn' : 'good';
}

export function missedShare(program: AnsweredProgram): string {
  if (program.misses === 0) return '0';
  const share = program.steps > 0 ? program.misses / program.steps : 0;
  return `${program.misses} (${share < 0.0995 ? (100 * share).toFixed(1) : Math.round(100 * share)} %)`;
}

/** Left end of the axis of latencies. */
const axis_begin_s = 1e-4;

/** Where a duration lies between 0.1 ms and the deadline, on a logarithmic axis: 0 to 1, beyond 1 for what is too late. */
export function place(duration_s: number, deadline_s: number): number {
  const decades = Math.log10(Math.max(deadline_s, 10 * axis_begin_s) / axis_begin_s);
  return Math.max(0, Math.log10(Math.max(duration_s, axis_begin_s) / axis_begin_s) / decades);
}

/** Heights, 0 to 1, of so many columns between 0.1 ms and the deadline; the last one has what is beyond. A single late answer is seen. */
export function columnsOf(program: AnsweredProgram, count: number): number[] {
  const columns = new Array<number>(count).fill(0);
  const {first_s, per_decade, counts} = program.latencies;
  counts.forEach((n, i) => {
    const middle_s = first_s * 10 ** ((i + 0.5) / per_decade);
    const at = Math.min(count - 1, Math.floor(place(middle_s, program.deadline_s) * (count - 1)));
    columns[at] = (columns[at] ?? 0) + n;
  });
  const most = Math.max(1, ...columns);
  return columns.map((n) => (n === 0 ? 0 : Math.max(0.16, Math.sqrt(n / most))));
}

/** Programs that nobody answers for, and processes that the run started: rows of their own. */
export function rowsOfPrograms(programs: OutsideProgram[], clients: ClientRow[]): OutsideProgram[] {
  const answered = new Set(clients.flatMap((client) => client.programs.map((program) => program.path)));
  return programs.filter((program) => !program.is_client || program.started || !answered.has(program.path));
}

/** What such a row says, and whether it is a matter of concern. */
export function stateOf(program: OutsideProgram, clients: ClientRow[]): [string, Judgement] {
  const client = clients.find((c) => c.programs.some((p) => p.path === program.path));
  if (client) return [`Runs as client ${client.id}`, 'good'];
  if (!program.is_client) return program.connected ? ['Runs', 'good'] : ['Has ended', 'bad'];
  const robot = program.path.split('/')[0] ?? '';
  const free = clients.find((c) => c.mode === 'free' && (c.drives === robot || c.robots.includes(robot)));
  if (free) return [`Driven freely by client ${free.id}`, 'good'];
  return [program.started ? 'Its process has not connected' : 'Waits for a client', 'warn'];
}
