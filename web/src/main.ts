// Where the page begins.
import {App} from './app/app';

const root = document.getElementById('app');
if (root) {
  const app = new App(root);
  // For the page's own tests. Not an interface: it changes without notice.
  (window as unknown as {sandlot: unknown}).sandlot = {
    client: app.client, scene: app.scene, store: app.store, plots: app.plots,
    stats: () => ({...app.scene.stats(), ...app.client.counts, connection: app.client.state}),
  };
}
