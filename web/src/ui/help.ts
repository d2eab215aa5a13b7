// The sheet of all keys. It is made of the table of actions, so that no key is missing.
import {Actions, keyLabel} from '../app/actions';
import {h} from './dom';
import {openDialog} from './overlays';

/** Keys that are not actions of the table: held keys and those of single panels. */
export const otherKeys: [string, string, string[]][] = [
  ['Driving', 'Forward and back', ['w', 's', 'arrowup', 'arrowdown']],
  ['Driving', 'Turn', ['a', 'd', 'arrowleft', 'arrowright']],
  ['Driving', 'Sideways, where the drive can', ['q', 'e']],
  ['Mouse', 'Turn the view', ['drag']],
  ['Mouse', 'Move the view', ['right drag']],
  ['Mouse', 'Zoom', ['wheel']],
  ['Mouse', 'Pull with a spring', ['ctrl+drag']],
  ['Mouse', 'Frame what is clicked', ['double click']],
];

export function openHelp(actions: Actions): void {
  const groups = new Map<string, [string, string[]][]>();
  const add = (group: string, title: string, keys: string[]): void => {
    groups.set(group, [...(groups.get(group) ?? []), [title, keys]]);
  };
  for (const action of actions.list) if (action.keys.length > 0) add(action.group, action.title, action.keys);
  for (const [group, title, keys] of otherKeys) add(group, title, keys);
  const sheet = h('div', {class: 'keys-sheet'});
  for (const [group, rows] of groups) {
    sheet.append(h('section', {}, h('h3', {}, group), ...rows.map(([title, keys]) => h('div', {}, h('span', {}, title), ...keys.map((key) => h('kbd', {}, keyLabel(key)))))));
  }
  openDialog('Keys', sheet).dataset.testid = 'help';
}
