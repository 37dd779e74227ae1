// The deformed patch of a simulation at each state of the load: triangles coloured by stress, repeated along the deformed
// translations.
import { button, Slider } from "../base/controls";
import { h, replace } from "../base/dom";
import { digits } from "../base/format";
import { icon } from "../base/icons";
import { cssColour, cssGradient, rampColour, RAMPS } from "../base/ramps";
import { dark } from "../base/theme";
import type { PatchMesh, Simulation } from "../contract/types";
import { largestState, quantile, type SolidMaterial, vonMisesStresses } from "./patch_stress";

type State = Simulation["states"][number] & { deformed: NonNullable<Simulation["states"][number]["deformed"]> };

const SIDE = 640;
const COPIES = 2;
/** Duration of a state while the load is played. */
const FRAME_MS = 350;
/** The colour map ends at this quantile of the stresses of all states. */
const COLOUR_QUANTILE = 0.99;
const RAMP = RAMPS.inferno;

export class PatchView {
  readonly element = h("div", { class: "patch" });
  private readonly canvas = h("canvas", { width: SIDE, height: SIDE, role: "img" });
  private readonly reading = h("p", { class: "muted" });
  private readonly maxLabel = h("span");
  private readonly play = button("", () => this.toggle(), { icon: "play", title: "Play the load" });
  private readonly legend: HTMLElement;
  private states: State[] = [];
  private meshes: readonly PatchMesh[] = [];
  private stresses: readonly (readonly number[])[] = [];
  private colourLimit = 0;
  private index = 0;
  private direction = 0;
  private slider: Slider | null = null;
  private timer: ReturnType<typeof setInterval> | undefined;

  constructor() {
    const bar = h("div", { class: "ramp", "aria-hidden": "true" });
    bar.style.background = cssGradient(RAMP);
    this.legend = h("div", {}, h("p", { class: "muted" }, "Von Mises stress in the solid"), bar, h("div", { class: "ramp-words" }, h("span", {}, "0"), this.maxLabel));
    dark.watch(() => this.draw());
  }

  show(simulation: Simulation, direction: number, solid: SolidMaterial | null): void {
    this.stop();
    this.meshes = simulation.meshes ?? [];
    this.direction = direction;
    const usable = simulation.states.filter((state): state is State => state.deformed !== undefined && state.stopped === "converged");
    this.states = usable.sort((a, b) => componentAlong(a.green_strain, direction) - componentAlong(b.green_strain, direction));
    this.stresses = solid ? this.states.map(({ deformed }) => vonMisesStresses(this.meshes[deformed.mesh], deformed.points, solid)) : [];
    this.colourLimit = quantile(this.stresses.flat(), COLOUR_QUANTILE);
    this.maxLabel.textContent = `${digits(this.colourLimit)} MPa and more`;
    const last = this.states.length - 1;
    this.index = largestState(this.states.map(({ green_strain }) => componentAlong(green_strain, direction)));
    this.slider = new Slider({
      label: "State of the load",
      lower: 0,
      upper: Math.max(1, last),
      step: 1,
      digits: 0,
      changed: (value) => {
        this.stop();
        this.index = Math.round(value);
        this.draw();
      },
    });
    this.slider.disabled = this.play.disabled = last < 1;
    replace(this.element, this.canvas, this.reading, h("div", { class: "play-row" }, this.play, this.slider.element), this.colourLimit > 0 && this.legend,
      simulation.message !== "" && h("p", { class: "note" }, simulation.message));
    this.draw();
  }

  clear(): void {
    this.stop();
    this.states = [];
    this.element.replaceChildren();
  }

  private toggle(): void {
    if (this.timer !== undefined) return this.stop();
    this.showPlaying(true);
    if (this.index === this.states.length - 1) this.index = -1;
    this.timer = setInterval(() => {
      ++this.index;
      if (this.index >= this.states.length - 1) this.stop();
      this.draw();
    }, FRAME_MS);
  }

  private stop(): void {
    clearInterval(this.timer);
    this.timer = undefined;
    this.showPlaying(false);
  }

  private showPlaying(playing: boolean): void {
    this.play.replaceChildren(icon(playing ? "pause" : "play"));
    this.play.title = playing ? "Stop playing" : "Play the load";
    this.play.setAttribute("aria-label", this.play.title);
  }

  private draw(): void {
    const state = this.states[this.index];
    const context = this.canvas.getContext("2d");
    if (!state || !context) return;
    if (this.slider) this.slider.value = this.index;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, SIDE, SIDE);
    const { points, mesh, lattice: [a, b] } = state.deformed;
    const { triangles, cells } = this.meshes[mesh];
    const copies = cells === 1 ? COPIES : 1;
    const centre = centroid(points);
    const stresses = this.stresses[this.index];
    // All states have the same scale, so that the deformation is visible.
    const scale = SIDE / (1.04 * this.extent());
    const plain = getComputedStyle(document.documentElement).getPropertyValue("--solid").trim() || "#345";
    context.lineWidth = 0.6 / scale;
    const outlines = triangles.map((triangle) => outlinePath(points, triangle));
    for (let i = 0; i < copies; ++i) {
      for (let k = 0; k < copies; ++k) {
        const u = i - (copies - 1) / 2;
        const v = k - (copies - 1) / 2;
        const x = u * a[0] + v * b[0] - centre[0];
        const y = u * a[1] + v * b[1] - centre[1];
        context.setTransform(scale, 0, 0, -scale, SIDE / 2 + scale * x, SIDE / 2 - scale * y);
        outlines.forEach((outline, n) => {
          // Outlines in the same colour close the seams between neighbours.
          context.fillStyle = context.strokeStyle = stresses && this.colourLimit > 0 ? cssColour(rampColour(stresses[n] / this.colourLimit, RAMP)) : plain;
          context.fill(outline);
          context.stroke(outline);
        });
      }
    }
    this.describeState(state);
  }

  private describeState(state: State): void {
    const [exx, eyy] = state.green_strain;
    const peak = Math.max(0, ...(this.stresses[this.index] ?? []));
    const [strain, stress] = [state.green_strain, state.stress].map((tensor) => digits(componentAlong(tensor, this.direction)));
    const words = `State ${this.index + 1} of ${this.states.length}: Green strain ${strain} along the load, stress ${stress} MPa`;
    const extra = [peak > 0 && `at most ${digits(peak)} MPa in the solid`, !state.stable && "unstable", state.contacts > 0 && "in contact"].filter(Boolean);
    this.reading.textContent = `${[words, ...extra].join(", ")}.`;
    this.canvas.setAttribute("aria-label", `The patch at Green strain ${digits(exx)} along x and ${digits(eyy)} along y, coloured by stress`);
  }

  /** Side of a square that contains the drawing of every state, in mm. */
  private extent(): number {
    let side = 0;
    for (const state of this.states) {
      const [a, b] = state.deformed.lattice;
      const copies = this.meshes[state.deformed.mesh].cells === 1 ? COPIES : 1;
      side = Math.max(side, copies * (Math.abs(a[0]) + Math.abs(b[0])), copies * (Math.abs(a[1]) + Math.abs(b[1])));
    }
    return side || 1;
  }
}

/** Normal component of a symmetric tensor (xx, yy, xy) in the direction of the load. */
function componentAlong([xx, yy, xy]: readonly number[], direction: number): number {
  const [x, y] = [Math.cos(direction), Math.sin(direction)];
  return x * x * xx + y * y * yy + 2 * x * y * xy;
}

function centroid(points: readonly (readonly number[])[]): [number, number] {
  let [x, y] = [0, 0];
  for (const point of points) {
    x += point[0];
    y += point[1];
  }
  return [x / points.length, y / points.length];
}

/** The outline of a quadratic triangle: each curved side is drawn as two segments through its midpoint node. */
function outlinePath(points: readonly (readonly number[])[], corners: readonly number[]): Path2D {
  const path = new Path2D();
  path.moveTo(points[corners[0]][0], points[corners[0]][1]);
  for (const k of [3, 1, 4, 2, 5]) path.lineTo(points[corners[k]][0], points[corners[k]][1]);
  path.closePath();
  return path;
}
