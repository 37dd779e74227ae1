// The panel beside the view: mesh, tool, points and results.
import { AccuracyDial } from "../base/accuracy_dial";
import { button, Checkbox, Segments, Select, Slider } from "../base/controls";
import { h, replace, uniqueId } from "../base/dom";
import { EffectChips } from "../base/effect_chips";
import { chipsOf } from "../base/effect_words";
import { digits } from "../base/format";
import type { Mesh } from "../contract/types";
import { pointWords, readPoint } from "./link";
import { nameOf } from "./names";
import { networkPanel } from "./network_panel";
import type { NetworkSession } from "./network_session";
import { afterChoice, mayBeRepaired, REPAIR_WORDS, REPAIRS, repairSentence } from "./repair";
import { type MeshSession, MAX_STARTS, type Tool, TOOLS } from "./session";
import { cssGradient, RAMP_NAMES, RAMP_WORDS, type RampName, RAMPS } from "../base/ramps";
import { touchWords } from "../base/touch_words";
import { inWords } from "../contract/places";
import { isolineSpacing, rampTicks } from "./mesh_data";
import { projectedOnto, readPlace } from "./point_in_space";
import type { Nudge } from "./nudge_buttons";
import { voronoiPanel } from "./voronoi_panel";
import type { VoronoiSession } from "./voronoi_session";

/** Changes the appearance of a distance field in the view. */
export interface FieldAppearance {
  ramp(name: RampName): void;
  /** Sets the distance between isolines; null for a round one. */
  spacing(spacing: number | null): void;
}

const FILE_TYPES = ".obj,.off,.ply,.stl";
const TOOL_WORDS: Record<Tool, string> = { path: "Path", distance: "Distance", mean: "Mean", network: "Network", voronoi: "Voronoi" };

export function meshPanel(
  session: MeshSession,
  network: NetworkSession,
  voronoi: VoronoiSession,
  nudge: { readonly site: Nudge; readonly support: Nudge },
  sample: () => void,
  appearance: FieldAppearance,
): HTMLElement {
  return h("div", { class: "column left" }, surfaceCard(session, sample), toolCard(session, network), networkPanel(session, network, nudge.support),
    voronoiPanel(session, voronoi, nudge.site), findingCard(session, appearance));
}

function surfaceCard(session: MeshSession, sample: () => void): HTMLElement {
  const file = h("input", {
    type: "file",
    accept: FILE_TYPES,
    class: "visually-hidden",
    id: uniqueId("file"),
    onchange: () => {
      const chosen = file.files?.[0];
      if (chosen) void session.upload(chosen, chosen.name);
      file.value = "";
    },
  });
  const list = new Select<string>("Meshes on the server", [], (id) => id && void session.open(id));
  const facts = h("dl", { class: "facts compact" });
  const warnings = h("div", { class: "notes" });
  session.known.watch((meshes) => {
    list.setChoices([{ value: "", words: "Choose …" }, ...meshes.map((mesh) => ({ value: mesh.id, words: meshWords(mesh) }))]);
    list.value = session.mesh.get()?.info.id ?? "";
  });
  session.mesh.watch((loaded) => {
    list.value = loaded?.info.id ?? "";
    if (!loaded) return;
    const { info } = loaded;
    const rows: [string, string][] = [
      ["Vertices", info.vertices.toLocaleString("en")],
      ["Faces", info.faces.toLocaleString("en")],
      ["Components", String(info.components)],
      ["Boundaries", String(info.boundary_loops)],
      ["Handles", String(info.genus)],
      ["Area", digits(info.area, 4)],
    ];
    replace(facts, ...rows.flatMap(([term, value]) => [h("dt", {}, term), h("dd", {}, value)]));
    replace(warnings, info.repair && h("p", { class: "note good" }, repairSentence(info, info.repair)),
      ...info.warnings.map(inWords).map((sentence) => h("p", { class: "note" }, sentence)), mayBeRepaired(info) && button("Repair the mesh", () => void session.repairShown()));
  });
  return h("section", { class: "card controls", "aria-label": "Surface" },
    h("div", { class: "row" }, h("label", { class: "button primary", for: file.id }, "Open a mesh"), file, button("Sample", sample)),
    h("p", { class: "muted" }, "OBJ, OFF, PLY or STL; or drop a file onto the view."), repairControls(session), list.element, facts, warnings);
}

function repairControls(session: MeshSession): HTMLElement {
  const boxes = REPAIRS.map((repair) => new Checkbox(REPAIR_WORDS[repair], (asked) => session.repairs.set(afterChoice(session.repairs.get(), repair, asked))));
  const help = h("p", { class: "muted" });
  const repairButton = button("Repair and upload", () => void session.repairRefused(), { kind: "primary" });
  const element = h("details", { class: "more repairs" }, h("summary", {}, "Repairs at upload"), help, h("div", {}, ...boxes.map((box) => box.element)), repairButton);
  let openedHere = false;
  session.repairs.watch((repairs) => REPAIRS.forEach((repair, k) => (boxes[k].value = repairs.includes(repair))));
  session.refused.watch((refused) => {
    repairButton.hidden = !refused;
    if (refused || openedHere) element.open = refused !== null;
    openedHere = refused !== null;
    help.textContent = refused
      ? `${refused.words} was refused for faults that the marked repairs mend.`
      : "Faulty meshes are refused, unless you ask for repairs. What they change is told here.";
  });
  return element;
}

function meshWords(mesh: Mesh): string {
  const name = nameOf(mesh.id);
  return `${name ? `${name}: ` : ""}${mesh.faces.toLocaleString("en")} faces, genus ${mesh.genus} (${mesh.id.slice(0, 6)})`;
}

function toolCard(session: MeshSession, network: NetworkSession): HTMLElement {
  const words: Record<Tool, string> = {
    path: "Shortest paths from point to point.",
    distance: "Distance to the nearest point, with isolines.",
    mean: "The point of least mean squared distance, and the paths to it. There may be several minima: further searches may find a lower one.",
    network: "An elastic network or membrane whose points slide on the surface until it is at rest.",
    voronoi: "Cells of the points that are nearer to one site than to any other, by shortest paths; as they are, or optimized.",
  };
  const tool = new Segments<Tool>("What is computed", TOOLS.map((value) => ({ value, words: TOOL_WORDS[value] })), (value) => session.setTool(value));
  const help = h("p", { class: "muted" });
  const starts = new Slider({
    label: "Searches from different starts",
    lower: 1,
    upper: MAX_STARTS,
    step: 1,
    digits: 0,
    changed: (value, done) => done && session.setStarts(Math.round(value)),
  });
  session.starts.watch((value) => (starts.value = value));
  const list = h("ol", { class: "points" });
  const id = uniqueId("point");
  const entry = h("input", { class: "number", id, placeholder: "v120, 7:0.2,0.3,0.5 or @1,2,3" });
  const distanceNote = h("p", { class: "muted", role: "status", hidden: true });
  const form = h("form", {
    class: "point-form",
    onsubmit: (event: Event) => {
      event.preventDefault();
      const place = readPlace(entry.value);
      const data = session.mesh.get()?.data;
      const placed = place && data ? projectedOnto(data, place) : null;
      const point = placed?.point ?? readPoint(entry.value);
      const before = session.points.get().length;
      if (point) session.add(point);
      const added = session.points.get().length > before;
      entry.setCustomValidity(added ? "" : "Write v and a vertex’s number, or face:a,b,c, of this mesh, or @x,y,z for the point nearest to a place.");
      distanceNote.hidden = !(added && placed);
      distanceNote.textContent = placed ? `The nearest point of the surface was added, ${digits(placed.distance, 4)} away from the place.` : "";
      if (added) entry.value = "";
      else entry.reportValidity();
    },
  }, h("label", { for: id }, "Add a point"), entry, h("button", { class: "button" }, "Add"), distanceNote);
  entry.addEventListener("input", () => entry.setCustomValidity(""));
  const clear = button("Remove all", () => session.setPoints([]), { kind: "quiet" });
  const isNetworkTool = () => session.tool.get() === "network";
  const remove = (index: number) => (isNetworkTool() ? network.removePicked(index) : session.setPoints(session.points.get().filter((_, k) => k !== index)));
  const showPoints = () => {
    const points = session.points.get();
    const picked = session.tool.get() !== "voronoi" && (!isNetworkTool() || network.state.get().points === "picked");
    list.hidden = form.hidden = !picked;
    clear.hidden = !picked || points.length === 0;
    replace(list,
      ...points.map((point, k) =>
        h("li", {}, h("span", {}, `${isNetworkTool() ? `${k}: ` : ""}${pointWords(point)}`), button("", () =>
          remove(k), { icon: "close", kind: "quiet", title: `Remove ${pointWords(point)}` }))
      ));
    if (points.length === 0) replace(list, h("li", { class: "muted" }, touchWords("Click on the surface to pick points.")));
  };
  session.tool.watch((value) => {
    tool.value = value;
    help.textContent = words[value];
    starts.element.hidden = value !== "mean";
  });
  let shown = "";
  for (const part of [session.tool, session.points, network.state]) {
    part.watch(() => {
      const now = [session.tool.get(), network.state.get().points].join();
      if (now !== shown || part === session.points) showPoints();
      shown = now;
    });
  }
  return h("section", { class: "card controls", "aria-label": "Points" }, tool.element, help, starts.element, dial(session), list, form, clear);
}

/** The dial of accuracy of distance fields; networks and diagrams have their own. */
function dial(session: MeshSession): HTMLElement {
  const element = new AccuracyDial({
    place: "distances",
    capabilities: () => (session.tool.get() === "distance" ? ["geodesics"] : []),
    measures: session.measures,
    choose: (level) => session.setAccuracy({ ...session.accuracy.get(), level }),
  });
  session.accuracy.watch(({ level }) => (element.value = level));
  session.tool.watch(() => element.update());
  return element.element;
}

function findingCard(session: MeshSession, appearance: FieldAppearance): HTMLElement {
  const facts = h("dl", { class: "facts" });
  const notes = h("div");
  const chips = new EffectChips("What was computed");
  const bar = h("div", { class: "ramp", "aria-hidden": "true" });
  const ticks = h("div", { class: "ramp-ticks" });
  const ramp = new Select<RampName>("Colours", RAMP_NAMES.map((value) => ({ value, words: RAMP_WORDS[value] })), show);
  const id = uniqueId("spacing");
  const spacing = h("input", {
    type: "number",
    class: "number",
    id,
    min: 0,
    step: "any",
    placeholder: "automatic",
    onchange: () => {
      const value = Number(spacing.value);
      const used = spacing.value !== "" && value > 0 ? value : null;
      if (used === null) spacing.value = "";
      appearance.spacing(used);
    },
  });
  const scale = h("div", { class: "ramp-box controls" }, h("div", {}, bar, ticks), ramp.element,
    h("div", { class: "field" }, h("label", { for: id }, "Spacing of the isolines, mesh units"), spacing));
  const card = h("section", { class: "card", "aria-label": "Result", hidden: true }, h("h2", {}, "Result"), scale, facts, chips.element, notes);

  function show(name: RampName): void {
    bar.style.background = cssGradient(RAMPS[name]);
    appearance.ramp(name);
  }
  show("sea");
  session.finding.watch((finding) => {
    card.hidden = finding.facts.length === 0;
    replace(facts, ...finding.facts.flatMap(([term, value]) => [h("dt", {}, term), h("dd", {}, value)]));
    chips.show(chipsOf(finding.effects, {}));
    replace(notes, ...finding.notes.map((sentence) => h("p", { class: "note" }, sentence)));
    scale.hidden = finding.distances === null;
    if (!finding.distances) return;
    const largest = finding.distances.reduce((max, value) => Math.max(max, value), 0);
    spacing.placeholder = `automatic: ${digits(isolineSpacing(largest))}`;
    replace(ticks, ...rampTicks(largest).map((value) => {
      const tick = h("span", {}, digits(value));
      tick.style.left = `${(100 * value) / (largest || 1)}%`;
      return tick;
    }));
  });
  return card;
}
