// The mesh page: makes its parts and connects them.
import sampleUrl from "../../../../api/examples/meshes/trefoil-knot.obj?url";
import { NORMAL } from "../base/accuracy_choice";
import { announce } from "../base/announce";
import { h, replace } from "../base/dom";
import type { RampName } from "../base/ramps";
import { shareButton } from "../base/share";
import { undoKeys } from "../base/undo_keys";
import type { Page, PageContext } from "../page";
import { viewHint } from "./hint";
import { readMeshLink, writeMeshLink } from "./link";
import { meshPanel } from "./panel";
import { Picking } from "./picking";
import { relaxationCard } from "./relaxation_card";
import type { MeshSession } from "./session";
import { MeshSessions } from "./sessions";
import { meshStatus } from "./status";
import { showInView } from "./view_contents";
import { viewTools } from "./view_tools";
import { MeshViewer } from "./viewer";
import { voronoiCard } from "./voronoi_card";

/** Vertices of the sample mesh that are picked initially. */
const SAMPLE_POINTS = [442, 1223, 1785];

export function meshPage({ client, link }: PageContext): Page {
  const sessions = new MeshSessions(client);
  const { mesh, network, voronoi } = sessions;
  const stage = h("section", { class: "card mesh-stage", "aria-label": "View" });
  const card = h("div", {}, relaxationCard(network, sessions.view));
  const diagram = h("div", {}, voronoiCard(voronoi, sessions.cells));
  const viewer = makeViewer();
  const picking = new Picking(sessions, viewer);
  const nudge = {
    site: (right: number, down: number) => picking.nudgeSite(right, down),
    support: (right: number, down: number) => picking.nudgeSupport(right, down),
  };
  const appearance = { ramp: (name: RampName) => viewer?.setRamp(name), spacing: (spacing: number | null) => viewer?.setSpacing(spacing) };
  const element = h("div", { class: "mesh-page" }, h("h1", { class: "visually-hidden" }, "Mesh"), meshPanel(mesh, network, voronoi, nudge, () => void openSample(mesh), appearance),
    h("div", { class: "column right" }, stage, card, diagram));
  const share = shareButton("Copy a link to this mesh and its points", () => {
    if (!mesh.mesh.get()) return "Open a mesh first";
    writeLink();
    return undefined;
  });
  replace(stage, viewTools(mesh, viewer, share), meshStatus(sessions),
    viewer?.element ?? h("p", { class: "note" }, "This browser shows no 3D drawings (WebGL is missing); results are given as numbers."), viewHint(sessions));
  if (viewer) showInView(sessions, viewer);
  mesh.finding.watch((finding) => {
    if (finding.facts.length > 0) announce(finding.facts.map(([term, value]) => `${term}: ${value}`).join(". "));
  });
  mesh.tool.watch(() => {
    card.hidden = !sessions.isNetworkTool;
    diagram.hidden = !sessions.isVoronoiTool;
    element.classList.toggle("with-network", sessions.isNetworkTool || sessions.isVoronoiTool);
  });
  scrollToComputations(sessions, stage);
  acceptDrops(mesh, stage);

  const writeLink = (): void => {
    const text = linkOf(sessions);
    if (text !== null) link.write(text);
  };
  for (const part of [mesh.mesh, mesh.points, mesh.tool, mesh.starts, mesh.accuracy, network.state, voronoi.state, voronoi.sites]) part.watch(writeLink);
  const keys = undoKeys(mesh);

  return {
    element,
    async open(text) {
      document.addEventListener("keydown", keys);
      void mesh.list();
      if (!(await openLink(sessions, text))) writeLink();
    },
    close() {
      document.removeEventListener("keydown", keys);
    },
    async resume(path, text) {
      await openLink(sessions, text, true);
      if (path === "/v1/embedded-systems") await network.relax();
      if (path === "/v1/voronoi-optimizations" && voronoi.canOptimize) await voronoi.optimize();
    },
    reconnected() {
      void mesh.list();
      mesh.retry();
    },
  };
}

function makeViewer(): MeshViewer | null {
  try {
    return new MeshViewer();
  } catch {
    return null;
  }
}

async function openSample(mesh: MeshSession): Promise<void> {
  const response = await fetch(sampleUrl);
  await mesh.upload(await response.blob(), "the sample");
  if (mesh.points.get().length === 0) mesh.setPoints(SAMPLE_POINTS.map((vertex) => ({ vertex })));
}

/** Scrolls to the view when a computation starts: on a small screen the button that starts it is far from there. */
function scrollToComputations({ network, voronoi }: MeshSessions, stage: HTMLElement): void {
  for (const part of [network.relaxing, voronoi.optimizing]) {
    let isRunning = false;
    part.watch((work: { readonly answer: unknown } | null) => {
      const now = work !== null && work.answer === null;
      if (now && !isRunning) stage.scrollIntoView({ block: "nearest" });
      isRunning = now;
    });
  }
}

/** Uploads a file that is dropped onto the view. */
function acceptDrops(mesh: MeshSession, stage: HTMLElement): void {
  stage.addEventListener("dragover", (event) => event.preventDefault());
  stage.addEventListener("drop", (event) => {
    event.preventDefault();
    const file = event.dataTransfer?.files[0];
    if (file) void mesh.upload(file, file.name);
  });
}

/** The link to what is shown; null without a mesh. */
function linkOf({ mesh, network, voronoi, isVoronoiTool }: MeshSessions): string | null {
  const loaded = mesh.mesh.get();
  if (!loaded) return null;
  const points = isVoronoiTool ? (voronoi.state.get().scattered ? [] : voronoi.sites.get()) : mesh.points.get();
  return writeMeshLink({
    mesh: loaded.info.id,
    tool: mesh.tool.get(),
    points: [...points],
    starts: mesh.starts.get(),
    accuracy: mesh.accuracy.get(),
    network: network.state.get(),
    voronoi: voronoi.state.get(),
  });
}

/** Shows what a link names. Returns false if it names no mesh other than the shown one; `isForced`: whatever it names is shown. */
async function openLink({ mesh, network, voronoi }: MeshSessions, text: string, isForced = false): Promise<boolean> {
  const linked = readMeshLink(text);
  if (!linked || (!isForced && linked.mesh === mesh.mesh.get()?.info.id)) return false;
  mesh.setTool(linked.tool);
  mesh.setStarts(linked.starts ?? 1);
  if (linked.tool === "distance") mesh.setAccuracy(linked.accuracy ?? NORMAL);
  await mesh.open(linked.mesh, linked.tool === "voronoi" ? [] : linked.points);
  const isShown = () => mesh.mesh.get()?.info.id === linked.mesh;
  if (linked.voronoi && linked.tool === "voronoi" && isShown()) await voronoi.restore(linked.voronoi, linked.points);
  if (linked.network && isShown()) network.restore(linked.network);
  return true;
}
