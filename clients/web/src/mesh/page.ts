// The mesh page: makes its parts and connects them.
import sampleUrl from "../../../../api/examples/meshes/trefoil-knot.obj?url";
import { announce } from "../base/announce";
import { h, replace } from "../base/dom";
import { shareButton } from "../base/share";
import { undoKeys } from "../base/undo_keys";
import type { RampName } from "../base/ramps";
import { ProgressRow } from "../base/progress_row";
import type { Page, PageContext } from "../page";
import { findings } from "./findings";
import { readMeshLink, writeMeshLink } from "./link";
import { meshPanel } from "./panel";
import { NetworkSession } from "./network_session";
import { NetworkView } from "./network_view";
import { relaxationCard } from "./relaxation_card";
import { type MeshActivity, MeshSession } from "./session";
import { viewTools } from "./view_tools";
import { MeshViewer, type Pick } from "./viewer";
import { voronoiCard } from "./voronoi_card";
import { VoronoiSession } from "./voronoi_session";
import { VoronoiView } from "./voronoi_view";

/** Vertices of the sample mesh that are picked initially. */
const SAMPLE_POINTS = [442, 1223, 1785];
/** Step of an arrow key or button that moves a Voronoi site or a support, in pixels. */
const NUDGE_PIXELS = 8;

export function meshPage({ client, link }: PageContext): Page {
  const session = new MeshSession(client, findings);
  const network = new NetworkSession(session, client);
  const view = new NetworkView(network);
  const voronoi = new VoronoiSession(session, client);
  const cells = new VoronoiView(voronoi);
  const status = h("div", { class: "status" });
  const stage = h("section", { class: "card mesh-stage", "aria-label": "View" });
  const card = h("div", {}, relaxationCard(network, view));
  const diagram = h("div", {}, voronoiCard(voronoi, cells));
  const viewer = makeViewer();
  const appearance = { ramp: (name: RampName) => viewer?.setRamp(name), spacing: (spacing: number | null) => viewer?.setSpacing(spacing) };
  const element = h("div", { class: "mesh-page" }, h("h1", { class: "visually-hidden" }, "Mesh"),
    meshPanel(session, network, voronoi, { site: nudge, support: nudgeSupport }, () => void openSample(), appearance), h("div", { class: "column right" }, stage, card, diagram));
  const hint = h("p", { class: "hint" });
  const share = shareButton("Copy a link to this mesh and its points", () => {
    if (!session.mesh.get()) return "Open a mesh first";
    writeLink();
    return undefined;
  });
  replace(stage, viewTools(session, viewer, share), h("div", { class: "status-place" }, status),
    viewer?.element ?? h("p", { class: "note" }, "This browser shows no 3D drawings (WebGL is missing); results are given as numbers."), hint);

  function makeViewer(): MeshViewer | null {
    try {
      return new MeshViewer();
    } catch {
      return null;
    }
  }

  async function openSample(): Promise<void> {
    const response = await fetch(sampleUrl);
    await session.upload(await response.blob(), "the sample");
    if (session.points.get().length === 0) session.setPoints(SAMPLE_POINTS.map((vertex) => ({ vertex })));
  }

  const isNetworkTool = () => session.tool.get() === "network";
  const isVoronoiTool = () => session.tool.get() === "voronoi";

  function showMarks(): void {
    if (!session.mesh.get()) return;
    const marks = isNetworkTool() || isVoronoiTool() ? [] : session.points.get().map((point) => session.position(point));
    viewer?.setMarks(marks, session.finding.get().mean);
  }

  /** Marks the supports at their positions on the drawn surface. */
  function showSupports(): void {
    const loaded = session.mesh.get();
    const { kind, supports, moves } = network.state.get().host;
    const isSeen = isNetworkTool() && kind !== "rigid";
    // Displaced supports are shown at their new positions, even if the surface has not followed yet.
    const movedTo = new Map(view.atRest.get() ? [] : moves.map(({ vertex, to }) => [vertex, to]));
    viewer?.setSupports(loaded && isSeen ? supports.map((vertex) => movedTo.get(vertex) ?? session.position({ vertex })) : [], supports.indexOf(network.chosenSupport.get() ?? -1));
    if (viewer) viewer.dragsSupports = isSeen && !view.atRest.get();
  }

  function toggleSupport({ face, barycentric }: NonNullable<Pick["place"]>): void {
    const vertex = session.mesh.get()?.data.faces[3 * face + barycentric.indexOf(Math.max(...barycentric))];
    if (vertex === undefined) return;
    network.toggleSupport(vertex);
    announce(`Vertex ${vertex} is ${network.state.get().host.supports.includes(vertex) ? "held" : "free"}.`, "change");
  }

  /** Moves the chosen site by a step in the view, along the surface. */
  function nudge(right: number, down: number): void {
    const site = voronoi.chosen.get();
    const from = site === null ? undefined : voronoi.sites.get()[site];
    if (site === null || !from || !viewer) return;
    const place = viewer.placeBeside(voronoi.position(from), NUDGE_PIXELS * right, NUDGE_PIXELS * down);
    if (place) voronoi.move(site, { face: place.face, barycentric: [...place.barycentric] }, true);
    else announce("There is no surface beside the site.");
  }

  /** Moves the chosen support by a step in the view, at the same depth. */
  function nudgeSupport(right: number, down: number): void {
    const vertex = network.chosenSupport.get();
    if (vertex === null || !viewer) return announce("No support is chosen.");
    const to = viewer.positionBeside(network.supportPlace(vertex), NUDGE_PIXELS * right, NUDGE_PIXELS * down);
    network.moveSupport(vertex, to);
  }

  function pickSite({ place, point }: Pick): void {
    if (point !== null) voronoi.chosen.set(point);
    else if (place) voronoi.place({ face: place.face, barycentric: [...place.barycentric] });
  }

  function pick(picked: Pick): void {
    if (isVoronoiTool()) return pickSite(picked);
    const { place, point } = picked;
    if (isNetworkTool() && network.supportMode.get()) {
      if (place) toggleSupport(place);
      else announce("There is no surface here.");
      return;
    }
    const mode = network.state.get().points === "picked" ? network.mode.get() : "fix";
    if (!isNetworkTool() || mode === "add") {
      if (place) session.add({ face: place.face, barycentric: [...place.barycentric] });
    } else if (point === null) announce("There is no point of the network.");
    else if (mode === "join") network.join(point);
    else network.toggleFixed(point);
  }

  if (viewer) {
    viewer.onPick = pick;
    viewer.onNudge = (right, down) => (isNetworkTool() ? nudgeSupport(right, down) : nudge(right, down));
    viewer.onDragSupport = (index, to) => network.moveSupport(network.state.get().host.supports[index], to);
    viewer.onDrag = (site, { face, barycentric }, done) => voronoi.move(site, { face, barycentric: [...barycentric] }, done);
    viewer.onDragMark = (mark, { face, barycentric }, done) => session.movePoint(mark, { face, barycentric: [...barycentric] }, done);
    session.tool.watch(() => {
      viewer.dragsPoints = isVoronoiTool();
      viewer.dragsMarks = !isVoronoiTool() && !isNetworkTool();
    });
    session.mesh.watch((loaded) => {
      if (loaded) viewer.setMesh(loaded.data, `Surface of ${loaded.info.faces} faces`);
    });
    session.finding.watch((finding) => {
      viewer.setField(finding.distances);
      viewer.setPaths(finding.paths);
      showMarks();
    });
    for (const part of [session.points, session.tool]) part.watch(showMarks);
    // The surface is set before the network, which lies on it.
    for (const part of [view.host, session.tool]) part.watch(() => viewer.setHost(isNetworkTool() ? view.host.get() : null));
    for (const part of [view.host, view.atRest, session.tool, session.mesh, network.state, network.chosenSupport]) part.watch(showSupports);
    for (const part of [cells.cells, session.tool]) part.watch(() => !isNetworkTool() && viewer.setCells(isVoronoiTool() ? cells.cells.get() : null));
    for (const part of [view.picture, cells.picture, session.tool]) {
      part.watch(() => viewer.setNetwork(isNetworkTool() ? view.picture.get() : isVoronoiTool() ? cells.picture.get() : null));
    }
  }
  session.finding.watch((finding) => {
    if (finding.facts.length > 0) announce(finding.facts.map(([term, value]) => `${term}: ${value}`).join(". "));
  });
  for (const part of [session.tool, network.state, network.mode, network.supportMode]) {
    part.watch(() => {
      const { points } = network.state.get();
      if (isVoronoiTool()) {
        hint.textContent =
          "Click to add a site, drag one to move it; drag beside it to turn, scroll to come nearer. With the keyboard: arrows and + −; with Shift, arrows move the chosen site.";
        return;
      }
      const click = isNetworkTool() && network.supportMode.get() ? "Click to hold the nearest vertex or let it go"
        : !isNetworkTool() || (points === "picked" && network.mode.get() === "add") ? "Click to pick a point"
        : points === "picked" && network.mode.get() === "join" ? "Click on two points to join them" : "Click on a point to fix it or let it go";
      const { kind, supports } = network.state.get().host;
      const hasSupports = isNetworkTool() && kind !== "rigid" && supports.length > 0;
      const dragged = hasSupports ? "a support to move it, beside it" : isNetworkTool() ? "" : "a point to move it, beside it";
      hint.textContent = `${click}, drag ${dragged} to turn, scroll to come nearer. With the keyboard: arrows and + −${
        hasSupports ? "; with Shift, arrows move the chosen support" : ""
      }.`.replace("  ", " ");
    });
  }
  session.tool.watch(() => {
    card.hidden = !isNetworkTool();
    diagram.hidden = !isVoronoiTool();
    element.classList.toggle("with-network", isNetworkTool() || isVoronoiTool());
  });

  // On a small screen the view is far from the button that starts a computation, so that the page scrolls to it.
  for (const part of [network.relaxing, voronoi.optimizing]) {
    let isRunning = false;
    part.watch((work: { readonly answer: unknown } | null) => {
      const now = work !== null && work.answer === null;
      if (now && !isRunning) stage.scrollIntoView({ block: "nearest" });
      isRunning = now;
    });
  }

  let stop = () => {};
  const progressRow = new ProgressRow("Progress", () => stop());

  function showActivity(): void {
    const own = isNetworkTool() ? network : isVoronoiTool() ? voronoi : session;
    const busy = session.activity.get().kind === "idle" ? own : session;
    const activity: MeshActivity = busy.activity.get();
    const cancel = () => busy.cancel();
    stop = cancel;
    if (activity.kind === "idle") replace(status);
    else if (activity.kind === "failed") replace(status, h("p", { class: "note", role: "alert" }, activity.sentence));
    else progressRow.show(status, activity.words, activity.progress);
  }
  for (const part of [session.activity, network.activity, voronoi.activity, session.tool]) part.watch(showActivity);

  function writeLink(): void {
    const loaded = session.mesh.get();
    if (!loaded) return;
    const points = isVoronoiTool() ? (voronoi.state.get().scattered ? [] : voronoi.sites.get()) : session.points.get();
    link.write(
      writeMeshLink({
        mesh: loaded.info.id,
        tool: session.tool.get(),
        points: [...points],
        starts: session.starts.get(),
        network: network.state.get(),
        voronoi: voronoi.state.get(),
      }),
    );
  }
  for (const part of [session.mesh, session.points, session.tool, session.starts, network.state, voronoi.state, voronoi.sites]) part.watch(writeLink);
  stage.addEventListener("dragover", (event) => event.preventDefault());
  stage.addEventListener("drop", (event) => {
    event.preventDefault();
    const file = event.dataTransfer?.files[0];
    if (file) void session.upload(file, file.name);
  });

  const keys = undoKeys(session);

  return {
    element,
    async open(text) {
      document.addEventListener("keydown", keys);
      void session.list();
      const linked = readMeshLink(text);
      if (linked && linked.mesh !== session.mesh.get()?.info.id) {
        session.setTool(linked.tool);
        session.setStarts(linked.starts ?? 1);
        await session.open(linked.mesh, linked.tool === "voronoi" ? [] : linked.points);
        if (linked.voronoi && linked.tool === "voronoi" && session.mesh.get()?.info.id === linked.mesh) await voronoi.restore(linked.voronoi, linked.points);
        if (linked.network && session.mesh.get()?.info.id === linked.mesh) network.restore(linked.network);
      } else writeLink();
    },
    close() {
      document.removeEventListener("keydown", keys);
    },
    reconnected() {
      void session.list();
      session.retry();
    },
  };
}
