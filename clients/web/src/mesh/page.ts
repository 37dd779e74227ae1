// The mesh page, put together.
import sampleUrl from "../../../../api/examples/meshes/trefoil-knot.obj?url";
import { announce } from "../base/announce";
import { button } from "../base/controls";
import { h, replace } from "../base/dom";
import type { Page, Surroundings } from "../page";
import { findings } from "./findings";
import { readMeshLink, writeMeshLink } from "./link";
import { meshPanel } from "./panel";
import { MeshSession } from "./session";
import { MeshViewer } from "./viewer";

/** Vertices of the sample that are seen at first. */
const SAMPLE_POINTS = [442, 1223, 1785];

export function meshPage({ client, link }: Surroundings): Page {
  const session = new MeshSession(client, findings);
  const status = h("div", { class: "status" });
  const stage = h("section", { class: "card mesh-stage", "aria-label": "View" });
  const element = h("div", { class: "mesh-page" }, h("h1", { class: "visually-hidden" }, "Mesh"), meshPanel(session, () => void openSample()), stage);
  const viewer = makeViewer();
  const hint = h("p", { class: "hint" }, "Click to pick a point, drag to turn, scroll to come nearer. With the keyboard: arrows and + −.");
  replace(stage, viewer?.element ?? h("p", { class: "note" }, "This browser shows no 3D drawings (WebGL is missing); results are given as numbers."), hint, status);

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

  function showMarks(): void {
    if (session.mesh.get()) viewer?.setMarks(session.points.get().map((point) => session.position(point)), session.finding.get().mean);
  }

  if (viewer) {
    viewer.onPick = (pick) => session.add({ face: pick.face, barycentric: [...pick.barycentric] });
    session.mesh.watch((loaded) => {
      if (loaded) viewer.setMesh(loaded.data, `Surface of ${loaded.info.faces} faces`);
    });
    session.finding.watch((finding) => {
      viewer.setField(finding.distances);
      viewer.setPaths(finding.paths);
      showMarks();
    });
    session.points.watch(showMarks);
  }
  session.finding.watch((finding) => {
    if (finding.facts.length > 0) announce(finding.facts.map(([term, value]) => `${term}: ${value}`).join(". "));
  });
  session.activity.watch((activity) => {
    if (activity.kind === "idle") replace(status);
    else if (activity.kind === "failed") replace(status, h("p", { class: "note", role: "alert" }, activity.sentence));
    else {
      const bar = h("progress", { max: 1, "aria-label": "Progress" });
      if (activity.progress !== null) bar.value = activity.progress;
      replace(status, h("div", { class: "working" }, h("span", {}, activity.words), bar, button("Cancel", () => session.cancel())));
    }
  });
  for (const part of [session.mesh, session.points, session.tool]) {
    part.watch(() => {
      const loaded = session.mesh.get();
      if (loaded) link.write(writeMeshLink({ mesh: loaded.info.id, tool: session.tool.get(), points: [...session.points.get()] }));
    });
  }
  stage.addEventListener("dragover", (event) => event.preventDefault());
  stage.addEventListener("drop", (event) => {
    event.preventDefault();
    const file = event.dataTransfer?.files[0];
    if (file) void session.upload(file, file.name);
  });

  return {
    element,
    async open(text) {
      void session.list();
      const linked = readMeshLink(text);
      if (linked && linked.mesh !== session.mesh.get()?.info.id) {
        session.setTool(linked.tool);
        await session.open(linked.mesh, linked.points);
      } else if (session.mesh.get()) {
        const loaded = session.mesh.get();
        if (loaded) link.write(writeMeshLink({ mesh: loaded.info.id, tool: session.tool.get(), points: [...session.points.get()] }));
      }
    },
    close() {},
    reconnected() {
      void session.list();
      session.retry();
    },
  };
}
