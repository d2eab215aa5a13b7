// Makes elements. Text from outside only ever becomes text nodes and attributes, never markup.

type Child = Node | string | null | undefined | false;
type Handlers = {[K in keyof HTMLElementEventMap]?: (event: HTMLElementEventMap[K]) => void};

export interface Properties {
  class?: string;
  title?: string;
  testid?: string;
  on?: Handlers;
  style?: Record<string, string>;
  [attribute: string]: unknown;
}

export function h<K extends keyof HTMLElementTagNameMap>(tag: K, properties: Properties = {}, ...children: Child[]): HTMLElementTagNameMap[K] {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (value === undefined || value === null || value === false) continue;
    if (name === 'class') element.className = value as string;
    else if (name === 'testid') element.dataset.testid = value as string;
    else if (name === 'on') {
      for (const [event, handler] of Object.entries(value as Handlers)) element.addEventListener(event, handler as EventListener);
    } else if (name === 'style') {
      for (const [key, text] of Object.entries(value as Record<string, string>)) element.style.setProperty(key, text);
    } else element.setAttribute(name, value === true ? '' : String(value));
  }
  for (const child of children) if (child) element.append(child);
  return element;
}

const svgNames = 'http://www.w3.org/2000/svg';

export function svg(tag: string, attributes: Record<string, string | number> = {}, ...children: (Node | string)[]): SVGElement {
  const element = document.createElementNS(svgNames, tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, String(value));
  element.append(...children);
  return element;
}

/** Writes only what differs, so that an unchanged text costs no layout. */
export function setText(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

export function setTitle(element: HTMLElement, title: string): void {
  if (element.title !== title) element.title = title;
}

/** Disables with a reason in the tooltip; null enables, with the usual title. */
export function setReason(element: HTMLButtonElement | HTMLInputElement | HTMLSelectElement, reason: string | null, title: string): void {
  element.disabled = reason !== null;
  setTitle(element, reason === null ? title : `${title}: ${reason.charAt(0).toLowerCase()}${reason.slice(1)}`);
}

export function clear(element: Element): void {
  element.replaceChildren();
}
