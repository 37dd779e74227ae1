// The sessions of the mesh page.
import type { Client } from "../contract/client";
import { findings } from "./findings";
import { NetworkSession } from "./network_session";
import { NetworkView } from "./network_view";
import { MeshSession } from "./session";
import { VoronoiSession } from "./voronoi_session";
import { VoronoiView } from "./voronoi_view";

/** A session for the mesh with its points, and one for each tool that has more, with what is drawn of it. */
export class MeshSessions {
  readonly mesh: MeshSession;
  readonly network: NetworkSession;
  readonly view: NetworkView;
  readonly voronoi: VoronoiSession;
  readonly cells: VoronoiView;

  constructor(client: Client) {
    this.mesh = new MeshSession(client, findings);
    this.network = new NetworkSession(this.mesh, client);
    this.view = new NetworkView(this.network);
    this.voronoi = new VoronoiSession(this.mesh, client);
    this.cells = new VoronoiView(this.voronoi);
  }

  get isNetworkTool(): boolean {
    return this.mesh.tool.get() === "network";
  }

  get isVoronoiTool(): boolean {
    return this.mesh.tool.get() === "voronoi";
  }

  /** Whether the host of the network is deformable, and the network is the tool. */
  get hasSupports(): boolean {
    return this.isNetworkTool && this.network.state.get().host.kind !== "rigid";
  }
}
