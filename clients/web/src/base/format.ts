/** A number with `count` significant digits, without trailing zeros. */
export function digits(value: number, count = 3): string {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  const text = size >= 1e5 || size < 1e-4 ? value.toExponential(count - 1) : value.toPrecision(count);
  return minus(text.includes("e") ? trimExponent(text) : trimZeros(text));
}

/** A number with `count` decimals. */
export function fixed(value: number, count: number): string {
  const text = value.toFixed(count);
  return minus(Number(text) === 0 ? (0).toFixed(count) : text);
}

export function percent(fraction: number): string {
  const value = 100 * fraction;
  return `${value >= 10 && value < 1e5 ? String(Math.round(value)) : digits(value, 2)} %`;
}

export function degrees(angle: number): string {
  return `${digits((angle * 180) / Math.PI, 3)}°`;
}

export function seconds(value: number): string {
  if (value < 1) return `${Math.max(1, Math.round(1000 * value))} ms`;
  return value < 60 ? `${digits(value, 2)} s` : `${Math.floor(value / 60)} min ${Math.round(value % 60)} s`;
}

/** The shortest text with eight significant digits, for links and files. */
export function plain(value: number): string {
  return String(Number(value.toPrecision(8)));
}

function minus(text: string): string {
  return text.replace(/-/g, "−");
}

function trimZeros(text: string): string {
  return text.includes(".") ? text.replace(/\.?0+$/, "") : text;
}

function trimExponent(text: string): string {
  const [mantissa, exponent] = text.split("e");
  return `${trimZeros(mantissa)}e${Number(exponent)}`;
}
