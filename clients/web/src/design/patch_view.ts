// The deformed patch of a simulation: its triangles, repeated along its deformed translations.
import { Slider } from "../base/controls";
import { h } from "../base/dom";
import { digits } from "../base/format";
import { dark } from "../base/theme";
import type { PatchMesh, Simulation } from "../contract/types";

type State = Simulation["states"][number] & { deformed: NonNullable<Simulation["states"][number]["deformed"]> };

const SIDE = 640;
const COPIES = 2;

export class PatchView {
  readonly element = h("div", { class: "patch" });
  private readonly canvas = h("canvas", { width: SIDE, height: SIDE, role: "img" });
  private states: State[] = [];
  private meshes: readonly PatchMesh[] = [];
  private index = 0;

  constructor() {
    dark.watch(() => this.draw());
  }

  show(simulation: Simulation, direction: number): void {
    this.meshes = simulation.meshes ?? [];
    const usable = simulation.states.filter((state): state is State => state.deformed !== undefined && state.stopped === "converged");
    this.states = usable.sort((a, b) => loading(a, direction) - loading(b, direction));
    this.index = Math.max(0, this.states.length - 1);
    const last = this.states.length - 1;
    const slider = new Slider({
      label: "State of the load", lower: 0, upper: Math.max(1, last), step: 1, digits: 0,
      changed: (value) => {
        this.index = Math.round(value);
        this.draw();
      },
    });
    slider.value = this.index;
    slider.disabled = last < 1;
    const message = simulation.message ? h("p", { class: "note" }, simulation.message) : null;
    this.element.replaceChildren(this.canvas, slider.element, ...(message ? [message] : []));
    this.draw();
  }

  clear(): void {
    this.states = [];
    this.element.replaceChildren();
  }

  private draw(): void {
    const state = this.states[this.index];
    const context = this.canvas.getContext("2d");
    if (!state || !context) return;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, SIDE, SIDE);
    const outline = outlinePath(state.deformed.points, this.meshes[state.deformed.mesh].triangles);
    const [a, b] = state.deformed.lattice;
    const copies = this.meshes[state.deformed.mesh].cells === 1 ? COPIES : 1;
    const centre = middle(state.deformed.points);
    // The scale is that of rest in every state, so that stretching shows.
    const scale = SIDE / (1.04 * this.extent());
    context.fillStyle = getComputedStyle(document.documentElement).getPropertyValue("--solid").trim() || "#345";
    for (let i = 0; i < copies; ++i) {
      for (let k = 0; k < copies; ++k) {
        const u = i - (copies - 1) / 2;
        const v = k - (copies - 1) / 2;
        const x = u * a[0] + v * b[0] - centre[0];
        const y = u * a[1] + v * b[1] - centre[1];
        context.setTransform(scale, 0, 0, -scale, SIDE / 2 + scale * x, SIDE / 2 - scale * y);
        context.fill(outline);
      }
    }
    const [exx, eyy] = state.green_strain;
    this.canvas.setAttribute("aria-label", `The patch at Green strain ${digits(exx)} along x and ${digits(eyy)} along y`);
    this.canvas.title = `E = (${state.green_strain.map((value) => digits(value)).join(", ")})${state.stable ? "" : ", unstable"}${state.contacts > 0 ? ", in contact" : ""}`;
  }

  /** Side of the square around all states, mm. */
  private extent(): number {
    let most = 0;
    for (const state of this.states) {
      const [a, b] = state.deformed.lattice;
      const copies = this.meshes[state.deformed.mesh].cells === 1 ? COPIES : 1;
      most = Math.max(most, copies * (Math.abs(a[0]) + Math.abs(b[0])), copies * (Math.abs(a[1]) + Math.abs(b[1])));
    }
    return most || 1;
  }
}

/** Green strain along the load. */
function loading(state: State, direction: number): number {
  const [x, y] = [Math.cos(direction), Math.sin(direction)];
  const [xx, yy, xy] = state.green_strain;
  return x * x * xx + y * y * yy + 2 * x * y * xy;
}

function middle(points: readonly (readonly number[])[]): [number, number] {
  let [x, y] = [0, 0];
  for (const point of points) {
    x += point[0];
    y += point[1];
  }
  return [x / points.length, y / points.length];
}

/** All triangles as one path, their curved sides by the points in their middles. */
function outlinePath(points: readonly (readonly number[])[], triangles: readonly (readonly number[])[]): Path2D {
  const path = new Path2D();
  for (const corners of triangles) {
    path.moveTo(points[corners[0]][0], points[corners[0]][1]);
    for (const k of [3, 1, 4, 2, 5]) path.lineTo(points[corners[k]][0], points[corners[k]][1]);
    path.closePath();
  }
  return path;
}
