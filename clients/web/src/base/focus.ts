// Where the focus goes when what has it disappears. Without this it would be lost to keys and screen readers.

function isGone(element: Element): boolean {
  return !element.isConnected || element.closest("[hidden]") !== null || (element instanceof HTMLButtonElement && element.disabled);
}

/** Makes a change within an area. If what has the focus there is gone afterwards, the first element of `next` gets it that is not. */
export function keepFocus(area: Element, change: () => void, ...next: readonly HTMLElement[]): void {
  const focused = document.activeElement;
  const isInside = focused !== null && focused !== document.body && area.contains(focused);
  change();
  if (isInside && isGone(focused)) next.find((element) => !isGone(element))?.focus({ preventScroll: true });
}
