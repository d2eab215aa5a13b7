// The table of actions with their keys.
import type {Action} from './actions';
import type {CameraMode} from '../ui/scene_tools';
import {cameras} from '../ui/scene_tools';

/** What the page can do; the app fills it in, tests fill in nothing. */
export interface Doers {
  [id: string]: () => void;
}

const table: [string, Action['group'], string, string[], boolean][] = [
  ['time.play', 'Time', 'Play or pause', ['space'], true],
  ['time.step', 'Time', 'One step', ['.'], true],
  ['time.reset', 'Time', 'Reset', ['r'], true],
  ['time.slower', 'Time', 'Slower', ['-'], true],
  ['time.faster', 'Time', 'Faster', ['+'], true],
  ['time.max', 'Time', 'As fast as possible', [], true],
  ['time.record', 'Time', 'Record the run to a file, or stop', [], true],
  ['scene.frame', 'View', 'Frame what is selected, or everything', ['f'], false],
  ['robots.follow', 'View', 'Follow what is selected', [], false],
  ['overlay.grid', 'View', 'Grid', ['g'], false],
  ['overlay.trails', 'View', 'Trails', ['t'], false],
  ['overlay.names', 'View', 'Names', ['n'], false],
  ['overlay.links', 'View', 'Communication links', [], false],
  ['overlay.batteries', 'View', 'Batteries', [], false],
  ['overlay.shadows', 'View', 'Shadows', [], false],
  ['overlay.scans', 'View', 'Laser scans', [], false],
  ['overlay.ranges', 'View', 'Ranges with distances', [], false],
  ['overlay.frusta', 'View', 'Camera views', [], false],
  ['overlay.objects', 'View', 'Detected objects', [], false],
  ['overlay.velocity', 'View', 'Velocities', [], false],
  ['overlay.frames', 'View', 'Frames', [], false],
  ['overlay.contacts', 'View', 'Contacts', [], false],
  ['overlay.collisions', 'View', 'Collision shapes', [], false],
  ['overlay.teams', 'View', 'Team colours', [], false],
  ['overlay.layers', 'View', 'Maps, plans and estimates', [], false],
  ['tool.orbit', 'Scene', 'Look around', ['v'], false],
  ['tool.move', 'Scene', 'Move things', ['m'], true],
  ['tool.pull', 'Scene', 'Pull things', ['p'], true],
  ['tool.goal', 'Scene', 'Send the selected robot somewhere', ['l'], true],
  ['scene.add', 'Scene', 'Add an object', ['o'], true],
  ['scene.duplicate', 'Scene', 'Duplicate what is selected', ['ctrl+d'], true],
  ['scene.remove', 'Scene', 'Remove what is selected', ['x', 'delete'], true],
  ['scene.screenshot', 'Scene', 'Save a picture', [], false],
  ['scene.video', 'Scene', 'Record video, or stop', [], false],
  ['robots.drive', 'Robots', 'Drive what is selected, or let go', ['enter'], true],
  ['robots.next', 'Robots', 'Next robot', [']'], false],
  ['robots.previous', 'Robots', 'Previous robot', ['['], false],
  ['panels.filter', 'Panels', 'Filter the tree', ['/'], false],
  ['panels.console', 'Panels', 'Console', ['`'], false],
  ['panels.left', 'Panels', 'Tree', ['ctrl+b'], false],
  ['panels.right', 'Panels', 'Inspector', ['ctrl+i'], false],
  ['panels.dock', 'Panels', 'Panels below', ['ctrl+j'], false],
  ['pane.plots', 'Panels', 'Plots', [], false],
  ['pane.log', 'Panels', 'Log', [], false],
  ['pane.clients', 'Panels', 'Clients', [], false],
  ['pane.topics', 'Panels', 'Topics', [], false],
  ['pane.graph', 'Panels', 'Graph', [], false],
  ['pane.matrix', 'Panels', 'Matrix', [], false],
  ['pane.agents', 'Panels', 'Agents', [], false],
  ['pane.pictures', 'Panels', 'Cameras', [], false],
  ['pane.match', 'Panels', 'Match', [], false],
  ['pane.panels', 'Panels', 'Screens and keys of robots', [], false],
  ['pane.commands', 'Panels', 'Commands', [], false],
  ['page.palette', 'Page', 'All commands', ['ctrl+k'], false],
  ['page.theme', 'Page', 'Dark or light', [], false],
  ['page.help', 'Page', 'This help', ['h', '?'], false],
  ['page.escape', 'Page', 'Let go, close, unselect', ['escape'], false],
];

export function actionTable(doers: Doers): Action[] {
  const action = ([id, group, title, keys, steers]: (typeof table)[number]): Action => ({id, group, title, keys, steers, run: doers[id] ?? (() => undefined)});
  const camera = ([mode, label]: [CameraMode, string], i: number): Action =>
    ({id: `camera.${mode}`, group: 'View', title: `Camera: ${label === 'TV' ? label : label.toLowerCase()}`, keys: [String(i + 1)], run: doers[`camera.${mode}`] ?? (() => undefined)});
  return [...table.slice(0, 7).map(action), ...cameras.map(camera), ...table.slice(7).map(action)];
}

export function actionIds(): string[] {
  return [...table.map(([id]) => id), ...cameras.map(([mode]) => `camera.${mode}`)];
}
