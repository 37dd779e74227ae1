// The toolbar above the view: undo and redo, camera, wireframe, link and exports.
import { announce } from "../base/announce";
import { button } from "../base/controls";
import { h } from "../base/dom";
import { download } from "../base/download";
import { menu } from "../base/menu";
import { fieldCsv, fieldPly, pathsCsv, pathsObj } from "./finding_files";
import { fileStem } from "./names";
import type { MeshSession } from "./session";
import type { MeshViewer } from "./viewer";

export function viewTools(session: MeshSession, viewer: MeshViewer | null, share: HTMLElement): HTMLElement {
  const undo = button("", () => session.undo(), { icon: "undo", title: "Undo (Ctrl+Z)" });
  const redo = button("", () => session.redo(), { icon: "redo", title: "Redo (Ctrl+Shift+Z)" });
  session.steps.watch((steps) => {
    undo.disabled = !steps.undo;
    redo.disabled = !steps.redo;
  });
  const fit = button("Fit view", () => viewer?.fit(), { icon: "fit", title: "Look at the whole surface" });
  const wire = button("Wireframe", () => {
    const shown = wire.getAttribute("aria-pressed") !== "true";
    wire.setAttribute("aria-pressed", String(shown));
    viewer?.setWireframe(shown);
  }, { title: "Show the edges of the mesh" });
  wire.setAttribute("aria-pressed", "false");
  const element = h("div", { class: "toolbar", role: "toolbar", "aria-label": "View" }, undo, redo, h("span", { class: "gap" }), fit, wire, h("span", { class: "stretch" }), share,
    exports(session, viewer));
  session.mesh.watch((loaded) => {
    for (const part of [fit, wire]) part.disabled = !loaded || !viewer;
  });
  return element;
}

function exports(session: MeshSession, viewer: MeshViewer | null): HTMLElement {
  const save = (kind: string, type: string, content: () => BlobPart | null) => () => {
    const loaded = session.mesh.get();
    const part = loaded && content();
    if (loaded && part !== null) download(`${fileStem(loaded.info.id)}-${kind}`, type, part);
    element.open = false;
  };
  const paths = () => session.finding.get().paths.filter((path) => path.length > 1);
  const field = <Text>(write: (data: NonNullable<ReturnType<typeof session.mesh.get>>["data"], distances: readonly number[]) => Text) => () => {
    const [loaded, { distances }] = [session.mesh.get(), session.finding.get()];
    return loaded && distances ? write(loaded.data, distances) : null;
  };
  const pathObj = button("Paths (OBJ)", save("paths.obj", "model/obj", () => pathsObj(paths())), { kind: "quiet" });
  const pathCsv = button("Paths (CSV)", save("paths.csv", "text/csv", () => pathsCsv(paths())), { kind: "quiet" });
  const ply = button("Distances on the mesh (PLY)", save("distance.ply", "model/ply", field(fieldPly)), { kind: "quiet" });
  const csv = button("Distances (CSV)", save("distance.csv", "text/csv", field(fieldCsv)), { kind: "quiet" });
  const png = button("Picture (PNG)", () => void savePicture(), { kind: "quiet" });

  async function savePicture(): Promise<void> {
    const picture = await viewer?.snapshot();
    if (picture) save("view.png", "image/png", () => picture)();
    else announce("There is no picture to save.");
  }

  const element = menu("Export", "download", h("div", { class: "menu-group" }, h("h3", {}, "What was found"), pathObj, pathCsv, ply, csv),
    h("div", { class: "menu-group" }, h("h3", {}, "View"), png));
  session.finding.watch(({ distances }) => {
    for (const part of [pathObj, pathCsv]) part.disabled = paths().length === 0;
    for (const part of [ply, csv]) part.disabled = distances === null;
  });
  session.mesh.watch((loaded) => (png.disabled = !loaded || !viewer));
  return element;
}
