// The patterns that the page offers: what they are called, their types and their lengths with what these may be.

export type PatternId = "regular" | "interlacing_squares" | "interlacing_circles" | "actuated_rings" | "layout";
export type LengthName = "pitch" | "side" | "overlap" | "circle_radius" | "distance" | "radius";
/** In mm. */
export type Lengths = Readonly<Record<LengthName, number>>;

export interface Pattern {
  readonly words: string;
  /** How its crossings are connected, by type 1, 2, ... */
  readonly types: readonly string[];
  readonly lengths: readonly LengthName[];
  /** Whether it has a periodic cell. */
  readonly periodic: boolean;
}

export const PATTERNS: Readonly<Record<PatternId, Pattern>> = {
  regular: {
    words: "Regular weave",
    types: ["All fused", "Strands along x slide", "Strands along y slide", "Sliding in turn"],
    lengths: ["pitch"],
    periodic: true,
  },
  interlacing_squares: {
    words: "Interlacing squares",
    types: ["1: all fused", "2: strands along x slide", "3: at each corner one along x, one along y", "4: as 3, one corner fused"],
    lengths: ["side", "overlap"],
    periodic: true,
  },
  interlacing_circles: { words: "Interlacing circles", types: ["1: all fused", "2: all slide"], lengths: ["circle_radius", "distance"], periodic: true },
  actuated_rings: { words: "Rings with a strand to push", types: [], lengths: [], periodic: false },
  layout: { words: "Strands of your own", types: [], lengths: [], periodic: true },
};

export const PATTERN_IDS = Object.keys(PATTERNS) as PatternId[];

export const DEFAULT_LENGTHS: Lengths = { pitch: 4, side: 12, overlap: 3, circle_radius: 5.5, distance: 10, radius: 0.25 };

export const LENGTH_WORDS: Readonly<Record<LengthName, string>> = {
  pitch: "Distance of strands",
  side: "Side of a square",
  overlap: "Overlap of corners",
  circle_radius: "Radius of the circles",
  distance: "Distance of their centres",
  radius: "Radius of the strands",
};

/** Neighbouring circles cut each other, others do not: their distance over their radius. */
const NEAREST_CIRCLES = 1.43;
const FARTHEST_CIRCLES = 1.99;
/** Of half the side. */
const MOST_OVERLAP = 0.98;

/** What a length may be while the others stay, in mm. */
export function lengthLimits(name: LengthName, lengths: Lengths): readonly [lower: number, upper: number] {
  switch (name) {
    case "pitch": return [1, 20];
    case "side": return [4, 40];
    case "overlap": return [0.2, (MOST_OVERLAP * lengths.side) / 2];
    case "circle_radius": return [2, 20];
    case "distance": return [NEAREST_CIRCLES * lengths.circle_radius, FARTHEST_CIRCLES * lengths.circle_radius];
    case "radius": return [0.05, 1];
  }
}

/** The lengths with one of them changed; one that is bound to it keeps its proportion. */
export function withLength(lengths: Lengths, name: LengthName, value: number): Lengths {
  const share = value / lengths[name];
  if (name === "side") return { ...lengths, side: value, overlap: lengths.overlap * share };
  if (name === "circle_radius") return { ...lengths, circle_radius: value, distance: lengths.distance * share };
  return { ...lengths, [name]: value };
}
