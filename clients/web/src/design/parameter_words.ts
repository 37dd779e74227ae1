// Words for the parameters of the families of tilings: what each does to the tile.

export interface ParameterWords {
  readonly name: string;
  /** What a larger value does, as a sentence. */
  readonly help: string;
}

const WIDTH: ParameterWords = { name: "Length of slanted walls", help: "Larger makes the tile wider: the two slanted walls beside the upright one become longer." };
const SLANT: ParameterWords = { name: "Slant", help: "How far the slanted walls rise from one end to the other: level at 0.5, downwards below it, upwards above it." };
const TIP: ParameterWords = {
  name: "Tip",
  help: "How far the pointed side sticks out of the tile. Small values fold it inwards, which makes the structure auxetic; larger ones point outwards.",
};

/** The parameters of each family in their order. */
const WORDS: Readonly<Record<string, readonly ParameterWords[]>> = {
  IH01: [
    WIDTH,
    SLANT,
    TIP,
    { name: "Height of the tips", help: "Moves both tips along the upright direction: in the middle of the tile at 0.625, so that larger or smaller values shear it." },
  ],
  IH21: [
    { name: "Height of the corner", help: "Moves the tile’s free corner away from the side below it: larger makes the tile higher." },
    { name: "Place of the corner", help: "Moves the tile’s free corner along the side below it: larger moves it to the outside." },
  ],
  IH22: [WIDTH, SLANT, TIP],
  IH28: [
    { name: "Depth", help: "The distance of the tip from the side opposite to it: larger makes the tile deeper, small values fold it." },
    { name: "Place of the tip", help: "Moves the tip along the side opposite to it: beside its middle at 0.5, so that other values skew the tile." },
  ],
  IH29: [{ name: "Height", help: "How far the tip is from the base of the tile: larger makes it higher and wider, small values pinch it at the base." }],
  IH50: [
    { name: "Width", help: "The width of the zigzag rows: larger makes the tile wider." },
    { name: "Slant", help: "How far the walls of a row rise from one end to the other: straight rows at 0.5, zigzag beside it." },
  ],
  IH67: [
    { name: "Height", help: "The distance of the two parallel sides: larger makes the rows higher." },
    { name: "Taper", help: "The shape of the trapezoid: a rectangle at 0.87; below it one of the parallel sides is longer, above it shorter, down to a point." },
  ],
};

/** The words of a parameter, counted from 0. A family of one's own has those of its definition, or else numbers. */
export function parameterWords(family: string, index: number, description = ""): ParameterWords {
  return WORDS[family]?.[index] ?? { name: description === "" ? `Parameter ${index + 1}` : description, help: "" };
}

/** The families whose parameters have words, with their number. */
export function familiesWithWords(): [family: string, count: number][] {
  return Object.entries(WORDS).map(([family, words]) => [family, words.length]);
}
