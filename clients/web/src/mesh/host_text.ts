// Supports as they are written by hand, and a host in a link.
import { plain } from "../base/format";
import { DEFAULT_NETWORK } from "./network_state";
import { type Host, HOST_KINDS, MOST_SUPPORTS, type Move } from "./host";

/** "0-9, 17": vertices and rows of them, ascending; null where that is not what is written. */
export function readSupports(text: string): readonly number[] | null {
  const found = new Set<number>();
  for (const piece of text.split(/[,;\n]/).map((one) => one.trim()).filter((one) => one !== "")) {
    const match = /^(\d{1,9})(?:\s*[-–]\s*(\d{1,9}))?$/.exec(piece);
    if (!match) return null;
    const [from, to] = [Number(match[1]), Number(match[2] ?? match[1])];
    if (to < from || to - from >= MOST_SUPPORTS) return null;
    for (let vertex = from; vertex <= to; ++vertex) found.add(vertex);
    if (found.size > MOST_SUPPORTS) return null;
  }
  return [...found].sort((a, b) => a - b);
}

export function writeSupports(supports: readonly number[]): string {
  const rows: [number, number][] = [];
  for (const vertex of supports) {
    const last = rows.at(-1);
    if (last && last[1] === vertex - 1) last[1] = vertex;
    else rows.push([vertex, vertex]);
  }
  return rows.map(([from, to]) => (from === to ? String(from) : to === from + 1 ? `${from}, ${to}` : `${from}-${to}`)).join(", ");
}

/** "3: 0.1 0 2; 17: 0 0 1": supports and where they are taken, ascending; null where that is not what is written. */
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

/** The fields of a host in a link; none of a rigid one. */
export function writeHost(host: Host): readonly string[] {
  if (host.kind === "rigid") return [];
  const numbers = [host.thickness, host.shellModulus, host.solidModulus, host.poissonRatio, host.volumeWeight, host.volumeScale, host.gravity].map(plain);
  const fields = [host.kind, ...numbers, host.keepsVolume ? "volume" : "free", host.bends ? "bends" : "limp"];
  const moves = host.moves.map(({ vertex, to }) => [vertex, ...to.map((value) => plain(Number(value.toPrecision(6))))].join(":"));
  return [
    `host=${fields.join(",")}`,
    ...(host.supports.length > 0 ? [`supports=${writeSupports(host.supports).replace(/ /g, "")}`] : []),
    ...(moves.length > 0 ? [`moves=${moves.join(",")}`] : []),
  ];
}

/** The host of a link's fields, with defaults for what is none. */
export function readHost(fields: ReadonlyMap<string, string>): Host {
  const { host: standard } = DEFAULT_NETWORK;
  const values = fields.get("host")?.split(",");
  const kind = HOST_KINDS.find((one) => one === values?.[0]);
  if (!values || !kind) return standard;
  const number = (place: number, lower: number, upper: number, otherwise: number) => {
    const value = Number(values[place]);
    return values[place] && value >= lower && value <= upper ? value : otherwise;
  };
  const supports = readSupports(fields.get("supports") ?? "") ?? [];
  const moves = readMoves((fields.get("moves") ?? "").split(",").map((move) => move.replace(/:/g, " ").replace(" ", ":")).join(";")) ?? [];
  return {
    kind,
    thickness: number(1, 1e-12, 1e12, standard.thickness),
    shellModulus: number(2, 1e-12, 1e12, standard.shellModulus),
    solidModulus: number(3, 1e-12, 1e12, standard.solidModulus),
    poissonRatio: number(4, -0.99, 0.4999, standard.poissonRatio),
    volumeWeight: number(5, 0, 1e12, standard.volumeWeight),
    volumeScale: number(6, 1e-6, 1e6, standard.volumeScale),
    gravity: number(7, 0, 1e12, standard.gravity),
    keepsVolume: values[8] === "volume",
    bends: values[9] !== "limp",
    supports,
    moves: moves.filter(({ vertex }) => supports.includes(vertex)),
  };
}
