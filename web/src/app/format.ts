// Numbers and times as people read them. Never the browser's locale: a decimal point is a point.

/** At most `digits` significant digits, no trailing zeros; very large and very small ones with an exponent. */
export function formatNumber(value: number, digits = 5): string {
  if (Number.isNaN(value)) return '–';
  if (!Number.isFinite(value)) return value > 0 ? '∞' : '−∞';
  if (value === 0) return '0';
  const size = Math.abs(value);
  if (Number.isInteger(value) && size < 1e15) return String(value);
  if (size < 1e-4 || size >= 1e7) return value.toExponential(Math.max(0, digits - 2)).replace(/\.?0+e/, 'e').replace('e+', 'e');
  return String(Number(value.toPrecision(Math.max(digits, Math.ceil(Math.log10(size)) + 1))));
}

/** A width that does not jump: so many decimals. */
export function formatFixed(value: number, decimals: number): string {
  if (!Number.isFinite(value)) return formatNumber(value);
  const text = value.toFixed(decimals);
  return /^-0\.?0*$/.test(text) ? text.slice(1) : text;
}

/** "12.34 s" below a minute, "1:02.34" below an hour, "1:00:02.34" above. */
export function formatTime(time_s: number): string {
  if (!Number.isFinite(time_s)) return '–';
  const sign = time_s < 0 ? '−' : '';
  const hundredths = Math.round(Math.abs(time_s) * 100);
  const s = (hundredths % 6000) / 100;
  const minutes = Math.floor(hundredths / 6000);
  if (minutes === 0) return `${sign}${s.toFixed(2)} s`;
  const seconds = s.toFixed(2).padStart(5, '0');
  if (minutes < 60) return `${sign}${minutes}:${seconds}`;
  return `${sign}${Math.floor(minutes / 60)}:${String(minutes % 60).padStart(2, '0')}:${seconds}`;
}

export function formatBytes(bytes: number): string {
  if (!Number.isFinite(bytes)) return '–';
  const units = ['B', 'kB', 'MB', 'GB'];
  let at = 0;
  while (bytes >= 1000 && at < units.length - 1) {
    bytes /= 1000;
    at += 1;
  }
  return `${at === 0 ? Math.round(bytes) : bytes.toPrecision(3)} ${units[at]}`;
}

export function formatRate(hz: number): string {
  return hz < 0.05 ? '–' : `${hz < 9.95 ? hz.toFixed(1) : Math.round(hz)} Hz`;
}

/** What a person typed: "0.5", "1e-3", "90 deg", "5 cm", "-3". Null when it is not a number. Results are in SI units. */
export function parseNumber(text: string): number | null {
  const match = /^\s*([+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?)\s*(deg|°|rad|mm|cm|m|km|ms|s|%)?\s*$/.exec(text.replace('−', '-'));
  if (!match) return null;
  const factors: Record<string, number> = {deg: Math.PI / 180, '°': Math.PI / 180, mm: 1e-3, cm: 1e-2, km: 1e3, ms: 1e-3, '%': 1e-2};
  const value = Number(match[1]) * (factors[match[2] ?? ''] ?? 1);
  return Number.isFinite(value) ? value : null;
}

/** A word of a console line: quoted where the command language would split it. It knows both quotes and no escapes. */
export function word(text: string): string {
  if (/^[^\s"'#;]+$/.test(text)) return text;
  return text.includes('"') ? `'${text}'` : `"${text}"`;
}

/** The unit in "rover.pose.x = 1.5 m"; an expression has none. */
export function unitOf(text: string, address: string): string {
  const prefix = `${address} = `;
  if (!text.startsWith(prefix)) return '';
  return /^\S+ (\S+)$/.exec(text.slice(prefix.length).trim())?.[1] ?? '';
}
