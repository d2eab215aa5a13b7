// Icons, 16 by 16, drawn with the text's colour.
import {svg} from './dom';

const paths: Record<string, string> = {
  play: 'M5 3.2v9.6L12.6 8z',
  pause: 'M5 3.5v9M11 3.5v9',
  step: 'M4 3.5v9L10 8zM12.2 3.5v9',
  reset: 'M3.5 8a4.7 4.7 0 1 0 1.6-3.5M3.2 2.8v2.6h2.6',
  record: 'M8 4.5a3.5 3.5 0 1 0 0 7 3.5 3.5 0 1 0 0-7z',
  eye: 'M1.6 8S4 3.8 8 3.8 14.4 8 14.4 8 12 12.2 8 12.2 1.6 8 1.6 8zM8 6.2a1.8 1.8 0 1 0 0 3.6 1.8 1.8 0 1 0 0-3.6z',
  sun: 'M8 5.2a2.8 2.8 0 1 0 0 5.6 2.8 2.8 0 1 0 0-5.6zM8 1.5v1.3M8 13.2v1.3M1.5 8h1.3M13.2 8h1.3M3.4 3.4l.9.9M11.7 11.7l.9.9M3.4 12.6l.9-.9M11.7 4.3l.9-.9',
  moon: 'M13 9.6A5.6 5.6 0 0 1 6.4 3 5.6 5.6 0 1 0 13 9.6z',
  help: 'M8 1.8a6.2 6.2 0 1 0 0 12.4A6.2 6.2 0 1 0 8 1.8zM6.2 6.3a1.9 1.9 0 1 1 2.6 1.8c-.5.2-.8.5-.8 1.1M8 11.2v.3',
  camera: 'M1.8 5.2h2.4l1-1.7h5.6l1 1.7h2.4v7.3H1.8zM8 6.6a2.1 2.1 0 1 0 0 4.2 2.1 2.1 0 1 0 0-4.2z',
  video: 'M1.8 4.5h8.4v7H1.8zM10.2 7.2l4-2v5.6l-4-2z',
  layers: 'M8 2 14 5.2 8 8.4 2 5.2zM2.6 8 8 10.9 13.4 8M2.6 10.8 8 13.7l5.4-2.9',
  move: 'M8 1.8v12.4M1.8 8h12.4M6.2 3.6 8 1.8l1.8 1.8M6.2 12.4 8 14.2l1.8-1.8M3.6 6.2 1.8 8l1.8 1.8M12.4 6.2 14.2 8l-1.8 1.8',
  pull: 'M2 13.8 4.2 11.6l-1-1.6 2.6.2-.6-2.2 2.5.7-.3-2.4 2.3 1.2 3.7-4.1M10.2 3h3v3',
  cursor: 'M3.5 2.5 12.6 8l-4 .9-2 3.8z',
  plus: 'M8 3v10M3 8h10',
  close: 'M4 4l8 8M12 4l-8 8',
  chevron: 'M6 4l4 4-4 4',
  down: 'M4 6l4 4 4-4',
  search: 'M7 2.8a4.2 4.2 0 1 0 0 8.4 4.2 4.2 0 1 0 0-8.4zM10.2 10.2l3.3 3.3',
  robot: 'M3.5 6h9v6.5h-9zM8 6V3.5M8 3.4v-.6M6.2 8.7v.6M9.8 8.7v.6M1.8 8.5v2M14.2 8.5v2',
  box: 'M8 1.9 13.6 5v6L8 14.1 2.4 11V5zM2.6 5.1 8 8.1l5.4-3M8 8.1v5.8',
  wall: 'M2 3.5h12v9H2zM2 6.5h12M2 9.5h12M6 3.5v3M10 6.5v3M6 9.5v3',
  chip: 'M4.5 4.5h7v7h-7zM6.5 2v2.5M9.5 2v2.5M6.5 11.5V14M9.5 11.5V14M2 6.5h2.5M2 9.5h2.5M11.5 6.5H14M11.5 9.5H14',
  brain: 'M3 4.5h4v4H3zM9 8.5h4v4H9zM7 6.5h2.5a1.5 1.5 0 0 1 1.5 1.5v.5',
  waves: 'M4.8 8h.01M7 5.6a3.4 3.4 0 0 1 0 4.8M9.2 3.8a6 6 0 0 1 0 8.4M11.4 2a8.6 8.6 0 0 1 0 12',
  speaker: 'M2.5 6.2h2.3L8 3.5v9L4.8 9.8H2.5zM10.3 6a2.8 2.8 0 0 1 0 4M12.2 4.2a5.4 5.4 0 0 1 0 7.6',
  flag: 'M4 14V2.5h8.5L10.3 5.6l2.2 3.1H4',
  follow: 'M8 4.6a3.4 3.4 0 1 0 0 6.8 3.4 3.4 0 1 0 0-6.8zM8 1.5v3M8 11.5v3M1.5 8h3M11.5 8h3',
  frame: 'M2.5 5.5v-3h3M10.5 2.5h3v3M13.5 10.5v3h-3M5.5 13.5h-3v-3',
  trash: 'M3 4.5h10M6 4.3V2.8h4v1.5M4.3 4.5l.6 8.7h6.2l.6-8.7M6.8 7v3.6M9.2 7v3.6',
  copy: 'M5.5 5.5h7.5V13H5.5zM10.5 5.3V3H3v7.5h2.3',
  plot: 'M2.5 2.5v11h11M4.5 10l2.5-3.5 2.5 2 3.5-5',
  download: 'M8 2.5v7.5M4.8 7 8 10.2 11.2 7M2.8 13.2h10.4',
  image: 'M2 3h12v10H2zM2.4 11.5 6 8l2.4 2.2L11 7.6l2.7 2.7M5.4 5.2v.6',
  gamepad: 'M4.5 5h7a3 3 0 0 1 2.9 3.8l-.6 2.2a1.5 1.5 0 0 1-2.6.6L9.8 10H6.2l-1.4 1.6a1.5 1.5 0 0 1-2.6-.6l-.6-2.2A3 3 0 0 1 4.5 5zM5.5 6.5v2M4.5 7.5h2M10.6 7v.4M11.6 8.2v.4',
  undo: 'M3 6.5h6.5a3.3 3.3 0 0 1 0 6.6H6M3 6.5l3-3M3 6.5l3 3',
  dots: 'M3.5 8h.01M8 8h.01M12.5 8h.01',
  list: 'M3 4h.01M3 8h.01M3 12h.01M5.5 4H13M5.5 8H13M5.5 12H13',
  sliders: 'M2.5 4.5h6M11.5 4.5h2M2.5 11.5h2M7.5 11.5h6M10 3v3M6 10v3M2.5 8h3M8.5 8h5M7 6.5v3',
  terminal: 'M2 3h12v10H2zM4.5 6l2 2-2 2M8 10.2h3',
  panelLeft: 'M2 3h12v10H2zM6 3v10',
  panelRight: 'M2 3h12v10H2zM10 3v10',
  panelBottom: 'M2 3h12v10H2zM2 9.5h12',
};

const filled = new Set(['play', 'record', 'cursor']);

export function icon(name: string, size = 16): SVGElement {
  return svg('svg', {
    viewBox: '0 0 16 16', width: size, height: size, 'aria-hidden': 'true', class: 'icon', fill: filled.has(name) ? 'currentColor' : 'none',
    stroke: 'currentColor', 'stroke-width': name === 'dots' || name === 'list' ? 1.8 : 1.35, 'stroke-linecap': 'round', 'stroke-linejoin': 'round',
  }, svg('path', {d: paths[name] ?? ''}));
}
