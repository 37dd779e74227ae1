// What the page is computing, above the view.
import { h, replace } from "../base/dom";
import { ProgressRow } from "../base/progress_row";
import type { MeshSessions } from "./sessions";

/** Shows the activity of the mesh, and while it is idle that of the tool. */
export function meshStatus(sessions: MeshSessions): HTMLElement {
  const { mesh, network, voronoi } = sessions;
  const status = h("div", { class: "status" });
  const shown = () => (mesh.activity.get().kind !== "idle" ? mesh : sessions.isNetworkTool ? network : sessions.isVoronoiTool ? voronoi : mesh);
  const progressRow = new ProgressRow("Progress", () => shown().cancel());
  for (const part of [mesh.activity, network.activity, voronoi.activity, mesh.tool]) {
    part.watch(() => {
      const activity = shown().activity.get();
      if (activity.kind === "busy") progressRow.show(status, activity.words, activity.progress);
      else replace(status, activity.kind === "failed" && h("p", { class: "note", role: "alert" }, activity.sentence));
    });
  }
  return h("div", { class: "status-place" }, status);
}
