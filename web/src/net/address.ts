// Where to connect, and as whom, from the page's own address.

export interface Target {
  url: string;
  token: string;
  role: string;
}

/**
 * `?token=` is taken out of the address bar (people copy addresses) and kept for the session. `?role=spectator` stays. `?ws=` names another
 * server; a token that was kept for this one is never sent there.
 */
export function targetOf(location: {href: string}, kept: {getItem(k: string): string | null; setItem(k: string, v: string): void}):
    {target: Target; cleanHref: string} {
  const page = new URL(location.href);
  const other = page.searchParams.get('ws');
  const key = `sandlot.token.${page.host}`;
  let token = page.searchParams.get('token') ?? '';
  page.searchParams.delete('token');
  const foreign = other !== null && hostOf(other) !== page.host;
  if (!foreign) {
    if (token !== '') kept.setItem(key, token);
    else token = kept.getItem(key) ?? '';
  }
  const role = page.searchParams.get('role') ?? '';
  const base = other ?? `${page.protocol === 'https:' ? 'wss' : 'ws'}://${page.host}/`;
  return {target: {url: base, token, role}, cleanHref: page.href};
}

function hostOf(address: string): string {
  try {
    return new URL(address).host;
  } catch {
    return '';
  }
}

export function socketAddress(target: Target): string {
  const url = new URL(target.url);
  if (target.token !== '') url.searchParams.set('token', target.token);
  if (target.role !== '') url.searchParams.set('role', target.role);
  url.searchParams.set('name', 'page');
  return url.href;
}
