// One field of a form: shows the value that holds, sends what was committed, shows it as pending until the answer came.
import type {ParameterValue} from '../net/client';
import type {Parameters} from '../app/parameters';
import {h, setText, setTitle} from './dom';
import {FieldView, isDefault, readField, writeField} from './forms';
import {icon} from './icons';

export class FieldRow {
  readonly element: HTMLElement;
  private readonly input: HTMLInputElement | HTMLSelectElement;
  private readonly slider: HTMLInputElement | null = null;
  private readonly error = h('div', {class: 'field-error', role: 'alert', hidden: true});
  private readonly back: HTMLButtonElement;
  private pending = 0;
  private reason: string | null = null;
  private shown: ParameterValue = undefined;

  constructor(private readonly view: FieldView, private readonly parameters: Pick<Parameters, 'values' | 'set'>) {
    const label = {'aria-label': `${view.label}${view.unit ? `, ${view.unit}` : ''}`, testid: `param-${view.address}`};
    if (view.control === 'switch') {
      this.input = h('input', {type: 'checkbox', class: 'switch', role: 'switch', ...label});
    } else if (view.control === 'choice') {
      this.input = h('select', label, ...view.choices.map((choice) => h('option', {value: choice}, choice)));
    } else {
      this.input = h('input', {type: 'text', class: view.control === 'text' ? '' : 'number', inputmode: view.control === 'number' ? 'decimal' : 'text', spellcheck: 'false', autocomplete: 'off', ...label});
    }
    this.back = h('button', {class: 'plain small icon-only back', 'aria-label': `Set ${view.label} to its default`, title: `Back to the default, ${view.fallback} ${view.unit}`.trim()}, icon('undo', 13));
    this.back.addEventListener('click', () => this.commit(view.fallback));
    const cell = h('div', {class: 'field-cell'});
    if (view.slider) {
      const slider = h('input', {type: 'range', min: view.slider.min, max: view.slider.max, step: view.slider.step, 'aria-label': `${view.label}, slider`, tabindex: '-1'});
      slider.addEventListener('input', () => {
        if (this.input !== document.activeElement) this.input.value = writeField(Number(slider.value));
      });
      slider.addEventListener('change', () => this.commit(writeField(Number(slider.value))));
      this.slider = slider;
      cell.append(slider);
    }
    cell.append(this.input, h('span', {class: 'unit'}, view.unit));
    this.element = h('div', {class: `field${view.tunable ? '' : ' fixed'}`},
        h('label', {class: 'ellipsis', title: [view.help, range(view)].filter((t) => t).join('\n')}, view.label), cell, this.back, this.error);
    this.input.addEventListener('change', () => this.commit(this.text()));
    this.input.addEventListener('input', () => this.element.classList.add('typing'));
    this.input.addEventListener('blur', () => this.element.classList.remove('typing'));
    this.input.addEventListener('keydown', (event) => {
      const key = (event as KeyboardEvent).key;
      if (key === 'Escape') {
        // Set before the focus goes, so that what was typed is not committed by leaving.
        if (this.view.control !== 'switch') this.input.value = writeField(this.shown);
        this.setError(null);
        this.input.blur();
        event.stopPropagation();
      } else if (key === 'Enter') {
        this.input.blur();
      }
    });
    if (!view.tunable) this.show(view.fallback);
    this.setReason(null);
  }

  private text(): string {
    return this.view.control === 'switch' ? String((this.input as HTMLInputElement).checked) : this.input.value;
  }

  setReason(reason: string | null): void {
    this.reason = this.view.tunable ? reason : 'Fixed while running';
    this.showReason();
    this.showBack();
  }

  /** Nothing can be typed before the value that holds is known: it would come into the middle of what is typed. */
  private showReason(): void {
    const off = this.reason !== null || this.shown === undefined;
    this.input.disabled = off;
    if (this.slider) this.slider.disabled = off;
    setTitle(this.input, this.reason ?? (off ? 'Its value is on the way' : this.view.help));
  }

  private showBack(): void {
    this.back.hidden = this.reason !== null || this.shown === undefined || isDefault(this.view, this.shown);
  }

  /** The value that holds, as the server says. What somebody is typing just now stays. */
  show(value: ParameterValue): void {
    const first = this.shown === undefined;
    this.shown = value;
    if (first) this.showReason();
    if (this.pending > 0) return;
    const typing = document.activeElement === this.input && this.element.classList.contains('typing');
    if (!typing) {
      if (this.view.control === 'switch') (this.input as HTMLInputElement).checked = value === true || value === 'true';
      else {
        if (this.view.control === 'choice' && ![...(this.input as HTMLSelectElement).options].some((o) => o.value === String(value))) this.input.append(h('option', {value: String(value ?? '')}, String(value ?? '')));
        this.input.value = writeField(value);
      }
      if (this.slider && document.activeElement !== this.slider) this.slider.value = writeField(value);
    }
    this.showBack();
  }

  private setError(text: string | null): void {
    this.error.hidden = text === null;
    setText(this.error, text ?? '');
    this.input.classList.toggle('wrong', text !== null);
    this.input.setAttribute('aria-invalid', String(text !== null));
  }

  private commit(text: string): void {
    if (this.reason !== null) return;
    const read = readField(this.view, text);
    if ('error' in read) {
      this.setError(read.error.charAt(0).toUpperCase() + read.error.slice(1));
      return;
    }
    this.setError(null);
    this.pending += 1;
    this.element.classList.add('pending');
    void this.parameters.set(this.view.address, read.value).then((error) => {
      this.pending -= 1;
      if (this.pending > 0) return;
      this.element.classList.remove('pending');
      this.setError(error);
      this.show(this.parameters.values.has(this.view.address) ? this.parameters.values.get(this.view.address) : this.shown);
    });
  }
}

function range(view: FieldView): string {
  const bound = (v: number | null): boolean => v !== null && Math.abs(v) < 1e5;
  const parts = [
    bound(view.min) ? `at least ${view.min}` : '', bound(view.max) ? `at most ${view.max}` : '', view.fallback !== '' ? `default ${view.fallback}` : '', view.tunable ? '' : 'fixed while running',
  ].filter((t) => t);
  return `${view.path}${parts.length > 0 ? `: ${parts.join(', ')}` : ''}`;
}
