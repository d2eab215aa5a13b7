// The rows of the tree, flat: what is folded away has no row. Pure, so that a thousand robots are cheap and it can be tested.
import type {Instance, World} from '../protocol';

export interface Row {
  kind: 'group' | 'robot' | 'object' | 'static' | 'device' | 'controller';
  key: string;      // what is folded or selected: "group:robots" or an address
  label: string;
  detail: string;
  depth: number;
  folded: boolean | null;  // null: nothing below it
  team: string;
  instance: Instance | null;
}

export type GroupKey = 'group:robots' | 'group:objects' | 'group:static';

const groups: [GroupKey, string, Row['kind']][] = [
  ['group:robots', 'Robots', 'robot'], ['group:objects', 'Objects', 'object'], ['group:static', 'Static world', 'static'],
];

/** Words of the filter must all occur, in the robot's own name, team and kind or in one of its parts'. */
export function rowsOf(world: World, open: ReadonlySet<string>, filter: string): Row[] {
  const words = filter.toLowerCase().split(/\s+/).filter((w) => w !== '');
  const isStatic = new Map(world.models.map((m) => [m.id, m.static]));
  const byKind: Record<string, Instance[]> = {robot: [], object: [], static: []};
  for (const instance of world.instances) {
    (instance.robot ? byKind.robot : isStatic.get(instance.model) ? byKind.static : byKind.object)?.push(instance);
  }
  const rows: Row[] = [];
  for (const [key, label, kind] of groups) {
    const all = byKind[kind] ?? [];
    if (all.length === 0) continue;
    // Groups are open unless folded by hand: the set holds what was folded, marked.
    const groupFolded = open.has(`-${key}`) && words.length === 0;
    const header: Row = {kind: 'group', key, label, detail: '', depth: 0, folded: groupFolded, team: '', instance: null};
    const at = rows.push(header);
    let count = 0;
    for (const instance of all) {
      const parts = partsOf(instance);
      const own = `${instance.name} ${instance.original} ${instance.team}`.toLowerCase();
      const ownMatches = words.every((w) => own.includes(w));
      const matching = words.length === 0 || ownMatches ? parts : parts.filter((p) => words.every((w) => `${own} ${p.label} ${p.detail}`.toLowerCase().includes(w)));
      if (words.length > 0 && !ownMatches && matching.length === 0) continue;
      count += 1;
      if (groupFolded) continue;
      const shown = parts.length > 0 && (open.has(instance.name) || (words.length > 0 && !ownMatches));
      rows.push({
        kind, key: instance.name, label: instance.name, detail: instance.original !== instance.name ? instance.original ?? '' : '', depth: 1,
        folded: parts.length === 0 ? null : !shown, team: instance.team ?? '', instance,
      });
      if (shown) rows.push(...matching);
    }
    header.detail = count === all.length ? String(count) : `${count} of ${all.length}`;
    if (count === 0) rows.length = at - 1;
  }
  return rows;
}

function partsOf(instance: Instance): Row[] {
  const row = (kind: 'device' | 'controller', path: string, name: string, detail: string): Row =>
    ({kind, key: path, label: name, detail, depth: 2, folded: null, team: '', instance});
  return [
    ...(instance.devices ?? []).map((d) => row('device', d.path, d.name, d.kind.replace(/_/g, ' '))),
    ...(instance.controllers ?? []).map((c) => row('controller', c.path, c.name, `${c.kind.replace(/_/g, ' ')} controller`)),
  ];
}
