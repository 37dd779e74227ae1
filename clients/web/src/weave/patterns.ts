// The patterns of the page: names, types, and lengths with their limits.

export type PatternId = "regular" | "interlacing_squares" | "interlacing_circles" | "actuated_rings" | "layout";
export type LengthName = "pitch" | "side" | "overlap" | "circle_radius" | "distance" | "radius";
/** All lengths in mm. */
export type Lengths = Readonly<Record<LengthName, number>>;

export interface Pattern {
  readonly words: string;
  /** Labels of its types 1, 2, ..., which differ in the connections of crossings. */
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

/** Limits of the distance of circles over their radius, between which only neighbouring circles intersect. */
const MIN_DISTANCE_RATIO = 1.43;
const MAX_DISTANCE_RATIO = 1.99;
/** Upper limit of the overlap of squares over half of their side. */
const MAX_OVERLAP_RATIO = 0.98;

/** The limits of a length in mm, for given other lengths. */
export function lengthLimits(name: LengthName, lengths: Lengths): readonly [lower: number, upper: number] {
  switch (name) {
    case "pitch":
      return [1, 20];
    case "side":
      return [4, 40];
    case "overlap":
      return [0.2, (MAX_OVERLAP_RATIO * lengths.side) / 2];
    case "circle_radius":
      return [2, 20];
    case "distance":
      return [MIN_DISTANCE_RATIO * lengths.circle_radius, MAX_DISTANCE_RATIO * lengths.circle_radius];
    case "radius":
      return [0.05, 1];
  }
}

/** The lengths after one has changed. A length that is limited by it is scaled with it. */
export function withLength(lengths: Lengths, name: LengthName, value: number): Lengths {
  const ratio = value / lengths[name];
  if (name === "side") return { ...lengths, side: value, overlap: lengths.overlap * ratio };
  if (name === "circle_radius") return { ...lengths, circle_radius: value, distance: lengths.distance * ratio };
  return { ...lengths, [name]: value };
}
