// The load of a part: the direction of the design that lies along the part's axis, and by how much the structure is turned for that.
import { digits } from "../base/format";
import type { Target } from "./state";
import { isPolar } from "./state";

/** Axis of coupons and blocks in radians: they are loaded along y. */
export const LENGTH_AXIS = Math.PI / 2;

/** The direction of all targets in radians; null if a target is over direction, or if the directions differ. */
export function loadDirection(targets: readonly Pick<Target, "task" | "direction">[]): number | null {
  const directions = new Set(targets.map(({ task, direction }) => (isPolar(task) ? null : direction)));
  const [only] = directions;
  return directions.size === 1 && only !== undefined ? only : null;
}

/** An angle in degrees from -90 to 90 that stands for the same turn of an axis, rounded to tenths. */
function axisTurn(angle: number): number {
  const tenths = Math.round((angle * 1800) / Math.PI);
  const turn = (((tenths % 1800) + 1800) % 1800) / 10;
  return turn > 90 ? turn - 180 : turn;
}

/** Says how the structure was turned; `direction` of the design and `axis` of the part in radians, null where there is none. */
export function loadWords(direction: number | null, axis: number | null): string {
  if (axis === null) return "";
  if (direction === null) return "Not turned: the design has no single direction of load.";
  const turn = axisTurn(axis - direction);
  if (turn === 0) return "Not turned: the design’s load runs along the part as it is.";
  return `Turned by ${digits(turn, 4)} degrees so that the design’s load runs along the part: it is loaded as it was designed.`;
}

/** The path of an arrow with a head at each end, along an axis through a point; y points downwards, as in SVG. */
export function axisArrow([x, y]: readonly [number, number], axis: number, length: number): string {
  const [along, across] = [[Math.cos(axis), -Math.sin(axis)], [Math.sin(axis), Math.cos(axis)]];
  const head = length / 8;
  const at = (forward: number, side: number): string =>
    `${Number((x + forward * along[0] + side * across[0]).toFixed(4))} ${Number((y + forward * along[1] + side * across[1]).toFixed(4))}`;
  const half = length / 2;
  const tip = (sign: number): string => `M${at(sign * (half - head), head / 2)}L${at(sign * half, 0)}L${at(sign * (half - head), -head / 2)}`;
  return `M${at(-half, 0)}L${at(half, 0)}${tip(1)}${tip(-1)}`;
}
