/** Digits of numbers that count: links and answers round the others. */
const COUNTED_DIGITS = 6;

/** A short key of a document: the same for documents that are equal but for the order of their fields and for rounding. `without`: fields of the document that do not count. */
export function textKey(document: unknown, without: readonly string[] = []): string {
  return hashOf(JSON.stringify(canonical(document, new Set(without))));
}

function canonical(value: unknown, without: ReadonlySet<string>): unknown {
  if (typeof value === "number") return Number(value.toPrecision(COUNTED_DIGITS));
  if (Array.isArray(value)) return value.map((one) => canonical(one, new Set()));
  if (typeof value !== "object" || value === null) return value;
  const fields = Object.entries(value).filter(([name, field]) => field !== undefined && !without.has(name));
  return fields.sort(([a], [b]) => (a < b ? -1 : 1)).map(([name, field]) => [name, canonical(field, new Set())]);
}

/** A hash of 53 bits of a text (cyrb53), for keys among a few texts. */
function hashOf(text: string): string {
  let [high, low] = [0xdeadbeef, 0x41c6ce57];
  for (let k = 0; k < text.length; ++k) {
    const code = text.charCodeAt(k);
    high = Math.imul(high ^ code, 2654435761);
    low = Math.imul(low ^ code, 1597334677);
  }
  high = Math.imul(high ^ (high >>> 16), 2246822507) ^ Math.imul(low ^ (low >>> 13), 3266489909);
  low = Math.imul(low ^ (low >>> 16), 2246822507) ^ Math.imul(high ^ (high >>> 13), 3266489909);
  return (4294967296 * (2097151 & low) + (high >>> 0)).toString(36);
}
