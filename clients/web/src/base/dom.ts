// Functions that make elements in one expression. Styles are classes only, because the server's content security policy refuses style attributes.

export type Child = Node | string | null | undefined | false;
type Attributes = Record<string, string | number | boolean | null | undefined | ((event: never) => void)>;

/** An HTML element with attributes and children. Functions such as `onclick` become listeners, and true becomes an empty attribute. */
export function h<Tag extends keyof HTMLElementTagNameMap>(
  tag: Tag,
  attributes: Attributes = {},
  ...children: Child[]
): HTMLElementTagNameMap[Tag] {
  const element = document.createElement(tag);
  setAttributes(element, attributes);
  append(element, children);
  return element;
}

const SVG = "http://www.w3.org/2000/svg";

/** An SVG element, made in the same way. */
export function svg<Tag extends keyof SVGElementTagNameMap>(
  tag: Tag,
  attributes: Attributes = {},
  ...children: Child[]
): SVGElementTagNameMap[Tag] {
  const element = document.createElementNS(SVG, tag);
  setAttributes(element, attributes);
  append(element, children);
  return element;
}

function setAttributes(element: Element, attributes: Attributes): void {
  for (const [name, value] of Object.entries(attributes)) {
    if (typeof value === "function") element.addEventListener(name.slice(2), value as EventListener);
    else if (value === true) element.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) element.setAttribute(name, String(value));
  }
}

function append(element: Element, children: Child[]): void {
  for (const child of children) if (child !== null && child !== undefined && child !== false) element.append(child);
}

export function replace(element: Element, ...children: Child[]): void {
  element.replaceChildren();
  append(element, children);
}

/** Sets an attribute unless it has this value already: browsers style and arrange an element anew after each writing, also of the same value. */
export function writeAttribute(element: Element, name: string, value: string): void {
  if (element.getAttribute(name) !== value) element.setAttribute(name, value);
}

/** Sets the text of an element unless it has this text already. */
export function writeText(element: Element, text: string): void {
  if (element.textContent !== text) element.textContent = text;
}

/** Replaces the children of an element unless they are equal to those that it has. Equal children stay with their listeners, so that they must have none that depend on what is shown. */
export function replaceChanged(element: Element, ...children: Child[]): void {
  const next = document.createElement("div");
  append(next, children);
  const isSame = next.childNodes.length === element.childNodes.length && [...next.childNodes].every((child, k) => child.isEqualNode(element.childNodes[k]));
  if (!isSame) element.replaceChildren(...next.childNodes);
}

let idCount = 0;
/** An id that is unique in the page. */
export function uniqueId(prefix: string): string {
  return `${prefix}-${++idCount}`;
}
