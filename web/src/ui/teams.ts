// Colours of teams, those of the scene.
import {teamColors} from '../scene/overlays/marks';
import type {World} from '../protocol';

let ofWorld: World | null = null;
let colors = new Map<string, string>();

export function teamColor(team: string, world: World | null): string {
  if (world !== ofWorld) {
    ofWorld = world;
    const found = teamColors((world?.instances ?? []).map((i) => i.team));
    colors = new Map([...found].map(([name, color]) => [name, `#${color.getHexString()}`]));
  }
  return colors.get(team) ?? 'inherit';
}
