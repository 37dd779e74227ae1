/** Numbers from here are written with an exponent, and so are numbers below MIN_PLAIN. */
const MAX_PLAIN = 1e7;
const MIN_PLAIN = 1e-6;

/** A number with `count` significant digits, without trailing zeros. It has an exponent only far outside the ordinary range. */
export function digits(value: number, count = 3): string {
  if (!Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= MAX_PLAIN || size < MIN_PLAIN) return minus(trimExponent(value.toExponential(count - 1)));
  return minus(String(Number(value.toPrecision(count))));
}

/** Powers of ten of the SI prefixes. */
const PREFIXES: readonly (readonly [prefix: string, power: number])[] = [["G", 9], ["M", 6], ["k", 3], ["", 0], ["m", -3], ["µ", -6]];
/** A value within these limits keeps its unit. */
const ORDINARY: readonly [number, number] = [0.01, 1e4];

/** A unit with another SI prefix, and what values in the former unit are multiplied by. */
export interface ScaledUnit {
  readonly unit: string;
  readonly factor: number;
}

/** The unit with the prefix that suits a value: kN/m for 1.673e5 N/m. A unit that is no multiple of N, N/m, Pa or J stays, and so does that of an ordinary value. */
export function suitedUnit(value: number, unit: string): ScaledUnit {
  const [, prefix = "", base = ""] = /^([GMkmµ]?)(N\/m|N|Pa|J)$/.exec(unit) ?? [];
  const size = Math.abs(value);
  if (base === "" || size === 0 || !Number.isFinite(size) || (size >= ORDINARY[0] && size < ORDINARY[1])) return { unit, factor: 1 };
  const own = PREFIXES.find(([name]) => name === prefix)?.[1] ?? 0;
  const [name, power] = PREFIXES.find(([, power]) => size * 10 ** (own - power) >= 1) ?? PREFIXES[PREFIXES.length - 1];
  return { unit: `${name}${base}`, factor: 10 ** (own - power) };
}

/** A value with its unit, such as 167.3 kN/m. */
export function quantity(value: number, unit: string, count = 3): string {
  const suited = suitedUnit(value, unit);
  return `${digits(value * suited.factor, count)}${suited.unit && ` ${suited.unit}`}`;
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
  if (value < 60) return `${digits(value, 2)} s`;
  const minutes = Math.floor(value / 60);
  return minutes < 120 ? `${minutes} min ${Math.round(value % 60)} s` : `${Math.floor(minutes / 60)} h ${minutes % 60} min`;
}

/** The shortest text with eight significant digits, for links and files. */
export function plain(value: number): string {
  return String(Number(value.toPrecision(8)));
}

function minus(text: string): string {
  return text.replace(/-/g, "−");
}

function trimExponent(text: string): string {
  const [mantissa, exponent] = text.split("e");
  return `${Number(mantissa)}e${Number(exponent)}`;
}
