// Shows in the view what the sessions have: the surface, marked points, findings, networks, supports and Voronoi cells.
import type { MeshSessions } from "./sessions";
import type { MeshViewer } from "./viewer";

export function showInView(sessions: MeshSessions, viewer: MeshViewer): void {
  const { mesh, network, view, cells } = sessions;

  function showMarks(): void {
    if (!mesh.mesh.get()) return;
    const marks = sessions.isNetworkTool || sessions.isVoronoiTool ? [] : mesh.points.get().map((point) => mesh.position(point));
    viewer.setMarks(marks, mesh.finding.get().mean);
  }

  /** Marks the supports at their positions on the drawn surface. */
  function showSupports(): void {
    const { supports, moves } = network.state.get().host;
    // Displaced supports are shown at their new positions, even if the surface has not followed yet.
    const movedTo = new Map(view.atRest.get() ? [] : moves.map(({ vertex, to }) => [vertex, to]));
    const shown = mesh.mesh.get() && sessions.hasSupports ? supports : [];
    viewer.setSupports(shown.map((vertex) => movedTo.get(vertex) ?? mesh.position({ vertex })), supports.indexOf(network.chosenSupport.get() ?? -1));
    viewer.dragsSupports = sessions.hasSupports && !view.atRest.get();
  }

  mesh.mesh.watch((loaded) => {
    if (loaded) viewer.setMesh(loaded.data, `Surface of ${loaded.info.faces} faces`);
  });
  mesh.finding.watch((finding) => {
    viewer.setField(finding.distances);
    viewer.setPaths(finding.paths);
    showMarks();
  });
  for (const part of [mesh.points, mesh.tool]) part.watch(showMarks);
  // The surface is set before the network, which lies on it.
  for (const part of [view.host, mesh.tool]) part.watch(() => viewer.setHost(sessions.isNetworkTool ? view.host.get() : null));
  for (const part of [view.host, view.atRest, mesh.tool, mesh.mesh, network.state, network.chosenSupport]) part.watch(showSupports);
  for (const part of [cells.cells, mesh.tool]) part.watch(() => !sessions.isNetworkTool && viewer.setCells(sessions.isVoronoiTool ? cells.cells.get() : null));
  for (const part of [view.picture, cells.picture, mesh.tool]) {
    part.watch(() => viewer.setNetwork(sessions.isNetworkTool ? view.picture.get() : sessions.isVoronoiTool ? cells.picture.get() : null));
  }
}
