// How near the family comes to each reference profile, beside the nearest of all other families: two marks on a logarithmic axis for each profile.
import { scaleLog } from "d3-scale";
import { svg } from "../base/dom";
import { percent } from "../base/format";
import type { AtlasProfile } from "../contract/types";
import { GAIN_WORDS, gainOf, profileWords, shortProfileWords } from "./atlas_words";

const ROW = 22;
const MARGIN = { top: 30, right: 16, bottom: 10 };
/** Width of the names of profiles in pixels, in whole and in short. */
const NAMES: readonly [whole: number, short: number] = [270, 122];
/** Deviations are drawn between these. Smaller ones lie at the lower end. */
const RANGE: readonly [number, number] = [0.005, 2];
const TICKS: readonly number[] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1];
/** Deviation that counts as met. */
const MET = 0.02;
/** Width of the plot below which names are shortened, and every other label of the axis is left out. */
const NARROW = 520;

export class ReachPlot {
  readonly element = svg("svg", { class: "plot reach-plot", role: "img" });
  private width = 640;
  private profiles: readonly AtlasProfile[] = [];

  resize(width: number): void {
    if (width === this.width || width < 1) return;
    this.width = width;
    this.update(this.profiles);
  }

  update(profiles: readonly AtlasProfile[]): void {
    this.profiles = profiles;
    const { width } = this;
    const height = MARGIN.top + ROW * profiles.length + MARGIN.bottom;
    for (const [name, value] of [["viewBox", `0 0 ${width} ${height}`], ["width", width], ["height", height]] as const) this.element.setAttribute(name, String(value));
    const isNarrow = width < NARROW;
    const left = NAMES[isNarrow ? 1 : 0];
    const x = scaleLog().domain(RANGE).range([left, width - MARGIN.right]).clamp(true);
    const bottom = MARGIN.top + ROW * profiles.length;
    const ticks = TICKS.filter((_, k) => !isNarrow || k % 2 === 1);
    const met = profiles.filter((profile) => profile.met).length;
    this.element.setAttribute("aria-label", `Deviation from ${profiles.length} reference profiles: the family meets ${met}`);
    this.element.replaceChildren(
      svg("rect", { class: "met-zone", x: left, y: MARGIN.top, width: Math.max(0, x(MET) - left), height: bottom - MARGIN.top }),
      svg("g", { class: "axis" }, ...ticks.flatMap((tick) => [
        svg("path", { class: "spoke", d: `M${x(tick)},${MARGIN.top}V${bottom}` }),
        svg("text", { x: x(tick), y: MARGIN.top - 8, "text-anchor": "middle" }, percent(tick)),
      ])),
      ...profiles.map((profile, k) => row(profile, isNarrow ? shortProfileWords(profile.name) : profileWords(profile.name), MARGIN.top + ROW * (k + 0.5), left, x)),
    );
  }
}

function row(profile: AtlasProfile, name: string, y: number, left: number, x: (value: number) => number): SVGGElement {
  const gain = gainOf(profile);
  const own = x(profile.deviation);
  const other = profile.others ? x(profile.others.deviation) : null;
  const others = profile.others ? `; ${profile.others.family}: ${percent(profile.others.deviation)}` : "";
  return svg("g", { class: `reach-row ${gain}` }, svg("title", {}, `${profileWords(profile.name)}: ${percent(profile.deviation)}${others}. ${GAIN_WORDS[gain]}`),
    svg("text", { x: left - 12, y, "text-anchor": "end", "dominant-baseline": "central" }, name),
    svg("path", { class: "reach-line", d: other === null ? "" : `M${other},${y}H${own}` }), other !== null && svg("circle", { class: "reach-other", cx: other, cy: y, r: 4.5 }),
    svg("circle", { class: "reach-own", cx: own, cy: y, r: 5.5 }));
}
