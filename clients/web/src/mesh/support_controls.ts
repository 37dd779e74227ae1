// The controls of the supports of a host: fixed vertices, and their displacements.
import { announce } from "../base/announce";
import { button, Checkbox, Slider } from "../base/controls";
import { h } from "../base/dom";
import { touchWords } from "../base/touch_words";
import { MAX_SUPPORTS, type Move } from "./host";
import { readMoves, readSupports, writeMoves, writeSupports } from "./host_text";
import { listField } from "./list_field";
import type { NetworkSession } from "./network_session";
import { type Nudge, nudgeButtons } from "./nudge_buttons";
import type { MeshSession } from "./session";

export function supportControls(mesh: MeshSession, network: NetworkSession, nudge: Nudge): HTMLElement {
  const clicks = new Checkbox(touchWords("Supports: a click on the surface holds the nearest vertex, or lets it go"), (value) => network.supportMode.set(value));
  const field = listField<readonly number[]>("Held vertices", "none", "Write numbers of vertices of this mesh, from 0, between commas; rows of them as 0-9.", readSupports,
    (supports) => {
      if (supports.length > MAX_SUPPORTS || supports.some((vertex) => vertex >= (mesh.mesh.get()?.info.vertices ?? 0))) return false;
      network.changeHost({ supports });
      return true;
    });
  const tell = () => announce(`${network.state.get().host.supports.length} vertices are held.`, "change");
  const lowest = button("Hold the lowest tenth", () => {
    network.supportLowest();
    tell();
  }, { title: "Holds the vertices in the lowest tenth of the height, which is along z" });
  const releaseAll = button("Let all go", () => {
    network.changeHost({ supports: [] });
    tell();
  }, { kind: "quiet" });
  const moves = moveControls(network, nudge);
  network.supportMode.watch((value) => (clicks.value = value));
  network.state.watch(({ host }) => {
    field.set(writeSupports(host.supports));
    releaseAll.hidden = moves.hidden = host.supports.length === 0;
  });
  return h("div", { class: "parameters" }, clicks.element, field.element, h("div", { class: "row" }, lowest, releaseAll), moves);
}

function moveControls(network: NetworkSession, nudge: Nudge): HTMLElement {
  const supports = () => network.state.get().host.supports;
  const help = h("p", { class: "muted" }, "Drag a support in the view, and the host follows.");
  const moveTogether = new Checkbox("Take supports that edges join to it along", (value) => network.moveTogether.set(value));
  const chosen = new Slider({
    label: "Chosen support",
    lower: 0,
    upper: 1,
    step: 1,
    digits: 0,
    changed: (value) => network.chosenSupport.set(supports()[Math.round(value)] ?? null),
  });
  const where = h("p", { class: "muted" });
  const arrows = nudgeButtons("the chosen support", nudge);
  const field = listField<readonly Move[]>("Moved supports", "none", "Write a held vertex and its place in mesh units: 3: 0.1 0 2; the next one after a semicolon.", readMoves,
    (moves) => {
      if (moves.some(({ vertex }) => !supports().includes(vertex))) return false;
      network.setMoves(moves);
      return true;
    });
  const back = button("Put supports back", () => network.setMoves([]), { kind: "quiet" });
  const show = () => {
    const { host } = network.state.get();
    const vertex = network.chosenSupport.get();
    field.set(writeMoves(host.moves));
    back.hidden = host.moves.length === 0;
    chosen.limit(0, Math.max(1, host.supports.length - 1));
    chosen.value = vertex === null ? 0 : Math.max(0, host.supports.indexOf(vertex));
    where.textContent = vertex === null ? "No support is chosen."
      : `Vertex ${vertex} is at ${network.supportPlace(vertex).map((value) => Number(value.toPrecision(4))).join(", ").replace(/-/g, "−")}.`;
    for (const arrow of arrows) arrow.disabled = vertex === null;
  };
  network.moveTogether.watch((value) => (moveTogether.value = value));
  for (const part of [network.state, network.chosenSupport]) part.watch(show);
  return h("div", { class: "parameters" }, help, moveTogether.element, chosen.element, where, h("div", { class: "row" }, ...arrows), field.element, back);
}
