// What hands do in the scene, as console lines.
import type {Drag} from '../scene/scene';
import {word} from './format';
import {plain} from './steer';

const millimetres = (v: number): string => plain(Math.round(v * 1e4) / 1e4);

/** Null: nothing to say. A pull has an end of its own; a move ends where its last line put it. */
export function dragLine(drag: Drag): string | null {
  const target = drag.target.map(millimetres);
  if (drag.target.some((v) => !Number.isFinite(v))) return null;
  switch (drag.mode) {
    case 'move':
      return `drag ${word(drag.name)} ${target.join(' ')}`;
    case 'turn':
      return drag.yaw === undefined || !Number.isFinite(drag.yaw) ? null : `pose ${word(drag.name)} ${target.join(' ')} ${millimetres(drag.yaw)}`;
    case 'pull':
      if (drag.phase === 'end') return `pull ${word(drag.name)} off`;
      return drag.point ? `pull ${word(drag.name)} ${word(drag.link)} ${drag.point.map(millimetres).join(' ')} ${target.join(' ')}` : null;
  }
}
