// What clicks, drags and keys in the view do: they pick, move, join and fix points, sites and supports.
import { announce } from "../base/announce";
import type { MeshSessions } from "./sessions";
import type { MeshViewer, Pick, Place } from "./viewer";
import type { SurfacePoint } from "../contract/types";

/** Step of an arrow key or button that moves a Voronoi site or a support, in pixels. */
const NUDGE_PIXELS = 8;

function pointAt({ face, barycentric }: Place): SurfacePoint {
  return { face, barycentric: [...barycentric] };
}

export class Picking {
  /** `viewer`: null if the browser has no WebGL. */
  constructor(private readonly sessions: MeshSessions, private readonly viewer: MeshViewer | null) {
    if (!viewer) return;
    const { mesh, network, voronoi } = sessions;
    viewer.onPick = (picked) => this.pick(picked);
    viewer.onNudge = (right, down) => (sessions.isNetworkTool ? this.nudgeSupport(right, down) : this.nudgeSite(right, down));
    viewer.onDragSupport = (index, to) => network.moveSupport(network.state.get().host.supports[index], to);
    viewer.onDrag = (site, place, done) => voronoi.move(site, pointAt(place), done);
    viewer.onDragMark = (mark, place, done) => mesh.movePoint(mark, pointAt(place), done);
    mesh.tool.watch(() => {
      viewer.dragsPoints = sessions.isVoronoiTool;
      viewer.dragsMarks = !sessions.isVoronoiTool && !sessions.isNetworkTool;
    });
  }

  /** Moves the chosen site by a step in the view, along the surface. */
  nudgeSite(right: number, down: number): void {
    const { voronoi } = this.sessions;
    const site = voronoi.chosen.get();
    const from = site === null ? undefined : voronoi.sites.get()[site];
    if (site === null || !from || !this.viewer) return;
    const place = this.viewer.placeBeside(voronoi.position(from), NUDGE_PIXELS * right, NUDGE_PIXELS * down);
    if (place) voronoi.move(site, pointAt(place), true);
    else announce("There is no surface beside the site.");
  }

  /** Moves the chosen support by a step in the view, at the same depth. */
  nudgeSupport(right: number, down: number): void {
    const { network } = this.sessions;
    const vertex = network.chosenSupport.get();
    if (vertex === null || !this.viewer) return announce("No support is chosen.");
    network.moveSupport(vertex, this.viewer.positionBeside(network.supportPlace(vertex), NUDGE_PIXELS * right, NUDGE_PIXELS * down));
  }

  private pick(picked: Pick): void {
    const { mesh, network, isNetworkTool, isVoronoiTool } = this.sessions;
    const { place, point } = picked;
    if (isVoronoiTool) return this.pickSite(picked);
    if (isNetworkTool && network.supportMode.get()) {
      if (place) this.toggleSupport(place);
      else announce("There is no surface here.");
      return;
    }
    const mode = network.state.get().points === "picked" ? network.mode.get() : "fix";
    if (!isNetworkTool || mode === "add") {
      if (place) mesh.add(pointAt(place));
    } else if (point === null) announce("There is no point of the network.");
    else if (mode === "join") network.join(point);
    else network.toggleFixed(point);
  }

  private pickSite({ place, point }: Pick): void {
    const { voronoi } = this.sessions;
    if (point !== null) voronoi.chosen.set(point);
    else if (place) voronoi.place(pointAt(place));
  }

  /** Fixes the vertex that is nearest to a point of the surface, or releases it. */
  private toggleSupport({ face, barycentric }: Place): void {
    const { mesh, network } = this.sessions;
    const vertex = mesh.mesh.get()?.data.faces[3 * face + barycentric.indexOf(Math.max(...barycentric))];
    if (vertex === undefined) return;
    network.toggleSupport(vertex);
    announce(`Vertex ${vertex} is ${network.state.get().host.supports.includes(vertex) ? "held" : "free"}.`, "change");
  }
}
