// Supports and their displacements as text in fields, and a host in a link.
import { plain } from "../base/format";
import { choiceOf, type Fields, numberOf, readValues, writeValues } from "../base/link_fields";
import { DEFAULT_NETWORK } from "./network_state";
import { type Host, HOST_KINDS, MAX_SUPPORTS, type Move } from "./host";

/** Vertices from a text such as "0-9, 17", ascending; null if the text is invalid. */
export function readSupports(text: string): readonly number[] | null {
  const found = new Set<number>();
  for (const piece of text.split(/[,;\n]/).map((one) => one.trim()).filter((one) => one !== "")) {
    const match = /^(\d{1,9})(?:\s*[-–]\s*(\d{1,9}))?$/.exec(piece);
    if (!match) return null;
    const [from, to] = [Number(match[1]), Number(match[2] ?? match[1])];
    if (to < from || to - from >= MAX_SUPPORTS) return null;
    for (let vertex = from; vertex <= to; ++vertex) found.add(vertex);
    if (found.size > MAX_SUPPORTS) return null;
  }
  return [...found].sort((a, b) => a - b);
}

export function writeSupports(supports: readonly number[]): string {
  const ranges: [number, number][] = [];
  for (const vertex of supports) {
    const last = ranges.at(-1);
    if (last && last[1] === vertex - 1) last[1] = vertex;
    else ranges.push([vertex, vertex]);
  }
  return ranges.map(([from, to]) => (from === to ? String(from) : to === from + 1 ? `${from}, ${to}` : `${from}-${to}`)).join(", ");
}

/** Displacements from a text such as "3: 0.1 0 2; 17: 0 0 1", ascending; null if the text is invalid. */
export function readMoves(text: string): readonly Move[] | null {
  const found = new Map<number, Move>();
  for (const piece of text.split(/[;\n]/).map((one) => one.trim()).filter((one) => one !== "")) {
    const [vertex, place, ...more] = piece.split(":").map((one) => one.trim());
    const to = (place ?? "").split(/[\s,]+/).filter((one) => one !== "").map(Number);
    if (!/^\d{1,9}$/.test(vertex) || more.length > 0 || to.length !== 3 || !to.every(Number.isFinite)) return null;
    found.set(Number(vertex), { vertex: Number(vertex), to: [to[0], to[1], to[2]] });
  }
  return [...found.values()].sort((a, b) => a.vertex - b.vertex);
}

export function writeMoves(moves: readonly Move[]): string {
  return moves.map(({ vertex, to }) => `${vertex}: ${to.map((value) => plain(Number(value.toPrecision(6)))).join(" ")}`).join("; ");
}

/** Values of a host in a link, in the order in which the links of version 0.1 have them. */
const HOST_VALUES = ["kind", "thickness", "shell-modulus", "solid-modulus", "poisson-ratio", "volume-weight", "volume-scale", "gravity", "volume", "bending"];

/** The fields of a host in a link; none for a rigid one. */
export function writeHost(host: Host): [string, string][] {
  if (host.kind === "rigid") return [];
  const values = writeValues({
    kind: host.kind,
    thickness: host.thickness,
    "shell-modulus": host.shellModulus,
    "solid-modulus": host.solidModulus,
    "poisson-ratio": host.poissonRatio,
    "volume-weight": host.volumeWeight,
    "volume-scale": host.volumeScale,
    gravity: host.gravity,
    volume: host.keepsVolume ? "constant" : "free",
    bending: host.bends ? "on" : "off",
  });
  const moves = host.moves.map(({ vertex, to }) => [vertex, ...to.map((value) => plain(Number(value.toPrecision(6))))].join(":"));
  const fields: [string, string][] = [["host", values]];
  if (host.supports.length > 0) fields.push(["supports", writeSupports(host.supports).replace(/ /g, "")]);
  if (moves.length > 0) fields.push(["moves", moves.join(",")]);
  return fields;
}

/** The host from the fields of a link, with defaults for missing and invalid values. */
export function readHost(fields: Fields): Host {
  const { host: defaults } = DEFAULT_NETWORK;
  const values = readValues(fields.get("host") ?? "", HOST_VALUES);
  const kind = choiceOf(values.get("kind"), HOST_KINDS, "rigid");
  if (kind === "rigid") return defaults;
  const number = (name: string, lower: number, upper: number, otherwise: number) => numberOf(values.get(name), lower, upper, otherwise);
  const supports = readSupports(fields.get("supports") ?? "") ?? [];
  const moves = readMoves((fields.get("moves") ?? "").split(",").map((move) => move.replace(/:/g, " ").replace(" ", ":")).join(";")) ?? [];
  return {
    kind,
    thickness: number("thickness", 1e-12, 1e12, defaults.thickness),
    shellModulus: number("shell-modulus", 1e-12, 1e12, defaults.shellModulus),
    solidModulus: number("solid-modulus", 1e-12, 1e12, defaults.solidModulus),
    poissonRatio: number("poisson-ratio", -0.99, 0.4999, defaults.poissonRatio),
    volumeWeight: number("volume-weight", 0, 1e12, defaults.volumeWeight),
    volumeScale: number("volume-scale", 1e-6, 1e6, defaults.volumeScale),
    gravity: number("gravity", 0, 1e12, defaults.gravity),
    // The links of version 0.1 say "volume" and "limp".
    keepsVolume: ["constant", "volume"].includes(values.get("volume") ?? ""),
    bends: !["off", "limp"].includes(values.get("bending") ?? ""),
    supports,
    moves: moves.filter(({ vertex }) => supports.includes(vertex)),
  };
}
