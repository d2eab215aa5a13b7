// Values that are dragged from one place of the page to another.

const kind = 'application/x-sandlot-value';

export interface Value {
  address: string;
  unit: string;
}

export function draggableValue(element: HTMLElement, address: string, unit: string): void {
  element.draggable = true;
  element.addEventListener('dragstart', (event) => {
    event.dataTransfer?.setData(kind, JSON.stringify({address, unit}));
    event.dataTransfer?.setData('text/plain', address);
  });
}

/** Calls `take` when a value is dropped. Text that is dropped counts as an address. */
export function acceptValues(element: HTMLElement, take: (value: Value) => void): void {
  element.addEventListener('dragover', (event) => {
    const types = event.dataTransfer?.types ?? [];
    if (!types.includes(kind) && !types.includes('text/plain')) return;
    event.preventDefault();
    element.classList.add('dropping');
  });
  element.addEventListener('dragleave', () => element.classList.remove('dropping'));
  element.addEventListener('drop', (event) => {
    element.classList.remove('dropping');
    event.preventDefault();
    try {
      const value = JSON.parse(event.dataTransfer?.getData(kind) ?? '') as Value;
      if (typeof value.address === 'string') take({address: value.address, unit: String(value.unit ?? '')});
    } catch {
      const text = event.dataTransfer?.getData('text/plain').trim() ?? '';
      if (text !== '' && text.length < 300) take({address: text, unit: ''});
    }
  });
}
