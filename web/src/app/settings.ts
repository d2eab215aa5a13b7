// What the page remembers in this browser. A value that cannot be read, or storage that is forbidden, means the default.

const prefix = 'sandlot.';

export function remembered<T>(key: string, otherwise: T): T {
  try {
    const text = localStorage.getItem(prefix + key);
    if (text === null) return otherwise;
    const value = JSON.parse(text) as T;
    return typeof value === typeof otherwise && Array.isArray(value) === Array.isArray(otherwise) ? value : otherwise;
  } catch {
    return otherwise;
  }
}

export function remember(key: string, value: unknown): void {
  try {
    localStorage.setItem(prefix + key, JSON.stringify(value));
  } catch {
    // A full or forbidden storage costs the memory, nothing else.
  }
}
