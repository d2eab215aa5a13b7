// Forms made of field lists. What a field looks like is decided here, without a document, so that it can be tested.
import type {Field} from '../protocol';
import type {ParameterValue} from '../net/client';
import {parseNumber} from '../app/format';

export type Control = 'number' | 'switch' | 'choice' | 'vector' | 'text';

export interface FieldView {
  path: string;
  address: string;
  label: string;
  group: string;
  control: Control;
  unit: string;
  help: string;
  tunable: boolean;
  slider: {min: number; max: number; step: number} | null;
  integer: boolean;
  length: number;
  fallback: string;
  choices: string[];
  min: number | null;
  max: number | null;
}

export function controlOf(field: Field): Control {
  if (field.type === 'bool' || field.type === 'boolean') return 'switch';
  if (field.type === 'choice' || (field.choices ?? []).length > 0) return 'choice';
  if (field.type === 'number' || field.type === 'integer') return field.length > 1 ? 'vector' : 'number';
  if (field.type === 'list of number' || field.type === 'list of integer' || field.type === 'vector') return 'vector';
  return 'text';
}

/** A slider makes sense where the whole range is of one order of magnitude and a hand can set it: not 0 to 1e6. */
export function sliderOf(min: number | null, max: number | null, integer: boolean): {min: number; max: number; step: number} | null {
  if (min === null || max === null || !Number.isFinite(min) || !Number.isFinite(max) || max <= min || max - min > 1000) return null;
  if (integer) return max - min >= 2 ? {min, max, step: 1} : null;
  return {min, max, step: 10 ** Math.floor(Math.log10((max - min) / 100))};
}

/** "noise/white" of "rover/laser" is the parameter rover/laser.noise.white. */
export function fieldViews(owner: string, fields: Field[]): FieldView[] {
  return fields.map((field) => {
    const parts = field.path.split('/');
    const integer = field.type === 'integer' || field.type === 'list of integer';
    const control = controlOf(field);
    return {
      path: field.path, address: `${owner}.${parts.join('.')}`, label: words(parts[parts.length - 1] ?? field.path), group: parts.slice(0, -1).map(words).join(' › '),
      control, unit: field.unit === '1' ? '' : field.unit ?? '', help: field.help ?? '', tunable: field.tunable === true, slider: field.path === 'errors' ? errorsSlider : control === 'number' ? sliderOf(field.min, field.max, integer) : null,
      integer, length: field.length ?? 0, fallback: field.default ?? '', choices: field.choices ?? [], min: field.min ?? null, max: field.max ?? null,
    };
  });
}

const errorsSlider = {min: 0, max: 2, step: 0.05};

/** The slider for the errors of a robot, or of all: `rover.errors`, `sim.errors`. More than twice can be typed. */
export function errorsView(owner: string, help: string): FieldView {
  return {path: 'errors', address: `${owner}.errors`, label: 'errors', group: '', control: 'number', unit: '', help: `${help}: 0 none, 1 as configured`, tunable: true,
    slider: errorsSlider, integer: false, length: 0, fallback: '1', choices: [], min: 0, max: 1000};
}

function words(name: string): string {
  return name.replace(/_/g, ' ');
}

export type Read = {value: ParameterValue} | {error: string};

/** What a person typed, as the value to send. */
export function readField(view: FieldView, text: string): Read {
  switch (view.control) {
    case 'switch':
      return {value: text === 'true'};
    case 'choice':
      return view.choices.length === 0 || view.choices.includes(text) ? {value: text} : {error: `one of ${view.choices.join(', ')}`};
    case 'number':
      return readNumber(view, text);
    case 'vector': {
      const values: number[] = [];
      for (const part of text.replace(/[[\]]/g, '').split(/[,;]|\s+(?=[-+.\d])/).map((p) => p.trim()).filter((p) => p !== '')) {
        const one = readNumber(view, part);
        if ('error' in one) return one;
        values.push(one.value as number);
      }
      if (view.length > 0 && values.length !== view.length) return {error: `${view.length} numbers`};
      return {value: values};
    }
    case 'text':
      return {value: text};
  }
}

function readNumber(view: FieldView, text: string): Read {
  const value = parseNumber(text);
  if (value === null) return {error: 'not a number'};
  if (view.integer && !Number.isInteger(value)) return {error: 'not a whole number'};
  if (view.min !== null && value < view.min) return {error: `at least ${view.min}`};
  if (view.max !== null && value > view.max) return {error: `at most ${view.max}`};
  return {value};
}

/** A value as it stands in its field: all digits that tell doubles apart. */
export function writeField(value: ParameterValue): string {
  if (value === null || value === undefined) return '';
  if (Array.isArray(value)) return value.map((v) => String(v)).join(', ');
  if (typeof value === 'number') return String(Number(value.toPrecision(12)));
  return String(value);
}

/** Is the value the field's default? Unknown defaults count as different, so that nothing is hidden. */
export function isDefault(view: FieldView, value: ParameterValue): boolean {
  const read = readField({...view, min: null, max: null}, view.fallback);
  return 'value' in read && JSON.stringify(read.value) === JSON.stringify(value);
}
