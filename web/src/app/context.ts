// What every panel is given.
import type {Client} from '../net/client';
import type {SceneView} from '../scene/scene';
import type {Actions} from './actions';
import type {Parameters} from './parameters';
import type {Steer} from './steer';
import type {Store} from './store';

export interface Context {
  client: Client;
  store: Store;
  steer: Steer;
  parameters: Parameters;
  actions: Actions;
  scene: SceneView;
  /** Says something that goes away by itself. */
  toast: (text: string, kind?: 'info' | 'warning' | 'error', button?: {label: string; run: () => void}) => void;
  /** Opens a tab of the dock (and the dock). */
  openPane: (id: string) => void;
  /** Adds a value to a plot and shows it. */
  plot: (address: string, unit: string) => void;
  /** Opens a phase plot: values against the first one. */
  phase: (addresses: string[]) => void;
  showMatrix: (topic: string) => void;
  /** Opens the pictures of cameras with this topic among them. */
  showPicture: (topic: string) => void;
  /** Opens the log with the lines of a program alone. */
  showLog: (program: string) => void;
}

/** A part of the page. It draws only while it is seen. */
export interface Panel {
  readonly element: HTMLElement;
  setVisible(visible: boolean): void;
}
