// The 3D view of a surface and of what lies on it. It uses three.js and does not depend on the server.
import * as THREE from "three";
import { Line2 } from "three/examples/jsm/lines/Line2.js";
import { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { type RampName, RAMPS } from "../base/ramps";
import { dark } from "../base/theme";
import { SceneView } from "../scene/scene_view";
import { drape, type Drape } from "./membrane_drape";
import { MembraneDrawing } from "./membrane_drawing";
import { CellDrawing, type CellPicture } from "./cell_drawing";
import { HostDrawing } from "./host_drawing";
import { barycentricOf, isolineSpacing, type MeshData, type Vector } from "./mesh_data";
import { SurfaceGrid } from "./nearest_on_surface";
import { NetworkDrawing, type NetworkPicture } from "./network_drawing";
import type { Rgb } from "./spring_colours";
import { surfaceMaterial } from "./surface_material";

const CLICK_PIXELS = 5;
/** Initial direction from the surface to the camera. */
const FROM = new THREE.Vector3(0.35, 0.45, 1);

/** Largest distance in pixels at which a click hits a point. */
const POINT_PIXELS = 14;
const DOT_COLOURS = { free: "--solid", fixed: "--target", chosen: "--simulated", support: "--missed", faulty: "--missed", rim: "--surface" } as const;
/** Depth behind the surface to which a point still counts as visible, over the radius of the surface. */
const VISIBLE_DEPTH = 0.05;

/** A deformed surface. */
export interface HostPicture {
  /** Positions of the vertices; null for those of the mesh. */
  readonly vertices: readonly Vector[] | null;
  /** Colour of each face; null for a plain surface. */
  readonly colours: readonly Rgb[] | null;
}

/** A point on the surface. */
export interface Place {
  face: number;
  barycentric: Vector;
}

export interface Pick {
  /** The point of the surface that was hit; null if none was. */
  place: Place | null;
  /** Index of the point of the network that was hit; null if none was. */
  point: number | null;
}

export class MeshViewer {
  onPick: (pick: Pick) => void = () => {};
  /** Whether the pointer drags points of the network along the surface, instead of rotating the view. */
  dragsPoints = false;
  /** Whether the pointer drags marked points along the surface. */
  dragsMarks = false;
  /** Called while a mark is dragged: its index, its point on the surface, and whether it was released there. */
  onDragMark: (mark: number, place: Place, done: boolean) => void = () => {};
  /** Called while a point is dragged: its index, its point on the surface, and whether it was released there. */
  onDrag: (point: number, place: Place, done: boolean) => void = () => {};
  /** Whether the pointer drags supports through space, instead of rotating the view. */
  dragsSupports = false;
  /** Called while a support is dragged: its index, and its position in the plane through the old one that is parallel to the picture. */
  onDragSupport: (support: number, to: Vector) => void = () => {};
  /** Called for Shift with an arrow key: steps to the right and down. */
  onNudge: (right: number, down: number) => void = () => {};
  private readonly view: SceneView;
  private readonly material = surfaceMaterial();
  private readonly marks = new THREE.Group();
  private readonly lines = new THREE.Group();
  private readonly network = new NetworkDrawing();
  private readonly membrane = new MembraneDrawing();
  private readonly supports = new NetworkDrawing();
  private readonly host = new HostDrawing();
  private readonly cells = new CellDrawing();
  private readonly edges = new THREE.Mesh(new THREE.BufferGeometry(), new THREE.MeshBasicMaterial({ wireframe: true, transparent: true, opacity: 0.35 }));
  private markPositions: readonly Vector[] = [];
  private distances: ArrayLike<number> | null = null;
  private chosenSpacing: number | null = null;
  private supportPositions: readonly Vector[] = [];
  private chosenSupport = -1;
  /** Search grid of the drawn surface; made when a membrane is draped over it. */
  private grid: SurfaceGrid | null = null;
  private draped: { positions: NetworkPicture["positions"]; triangles: NetworkPicture["triangles"]; drape: Drape } | null = null;
  private picture: NetworkPicture | null = null;
  private readonly lineMaterial = new LineMaterial({ linewidth: 5 });
  private surface: THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial> | null = null;
  private data: MeshData | null = null;
  /** The drawn mesh, with deformed vertices if the host is deformed. */
  private deformedMesh: MeshData | null = null;
  private deformedVertices: readonly Vector[] | null = null;
  private radius = 1;

  /** Throws if the browser has no WebGL. */
  constructor() {
    this.view = new SceneView("No mesh yet");
    this.view.resized = (width, height) => {
      this.lineMaterial.resolution.set(width, height);
      for (const drawing of [this.network, this.supports]) drawing.resized(width, height, this.view.pixelRatio);
      this.membrane.resized(width, height);
    };
    this.view.scene.add(this.marks, this.lines, this.host.group, this.cells.group, this.membrane.group, this.supports.group, this.network.group, this.edges);
    this.edges.visible = false;
    this.listen();
    dark.watch((isDark) => {
      this.material.uniforms.plain.value.set(isDark ? 0x7d8790 : 0xb9c2c8);
      this.edges.material.color.set(isDark ? 0xffffff : 0x101317);
      this.setNetwork(this.picture);
      this.setSupports(this.supportPositions, this.chosenSupport);
    });
  }

  get element(): HTMLElement {
    return this.view.element;
  }

  setMesh(data: MeshData, words: string): void {
    this.surface?.geometry.dispose();
    this.surface?.removeFromParent();
    this.data = this.deformedMesh = data;
    [this.grid, this.draped, this.deformedVertices] = [null, null, null];
    this.host.show(null, null);
    this.cells.show(null, [], null);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(Float32Array.from(data.positions), 3));
    geometry.setIndex(new THREE.BufferAttribute(data.faces, 1));
    geometry.computeVertexNormals();
    geometry.setAttribute("distance0", new THREE.BufferAttribute(new Float32Array(data.positions.length / 3), 1));
    geometry.computeBoundingSphere();
    this.surface = new THREE.Mesh(geometry, this.material);
    this.view.scene.add(this.surface);
    this.edges.geometry = geometry;
    this.view.words = words;
    const sphere = geometry.boundingSphere as THREE.Sphere;
    [this.material.uniforms.middle.value, this.radius] = [sphere.center, sphere.radius || 1];
    this.view.showAll(sphere, FROM);
    this.setField(null);
  }

  /** Shows the deformed surface and the colours of its faces; null for the plain mesh. */
  setHost(picture: HostPicture | null): void {
    if (!this.surface || !this.data) return;
    const vertices = picture?.vertices ?? null;
    const { geometry } = this.surface;
    if (vertices !== this.deformedVertices) {
      this.deformedVertices = vertices;
      this.deformedMesh = vertices ? { positions: Float64Array.from(vertices.flatMap((place) => [...place])), faces: this.data.faces } : this.data;
      [this.grid, this.draped] = [null, null];
      const attribute = geometry.getAttribute("position") as THREE.BufferAttribute;
      attribute.array.set(this.deformedMesh.positions);
      attribute.needsUpdate = true;
      geometry.computeVertexNormals();
      geometry.computeBoundingSphere();
    }
    this.surface.visible = !picture?.colours;
    this.host.show(geometry, picture?.colours ?? null);
    this.view.draw();
  }

  /** Shows cells in place of the plain surface; null for the surface. */
  setCells(picture: CellPicture | null): void {
    if (!this.surface || !this.data) return;
    this.cells.show(this.data, this.surface.geometry.getAttribute("normal").array, picture);
    this.surface.visible = !picture;
    this.view.draw();
  }

  /** The point of the surface that is drawn some pixels to the right of and below a position; null if there is none. */
  placeBeside(place: Vector, right: number, down: number): Place | null {
    const { camera, canvas } = this.view;
    camera.updateMatrixWorld();
    const seen = new THREE.Vector3(...place).project(camera);
    const { width, height } = canvas.getBoundingClientRect();
    return this.hit(new THREE.Vector2(seen.x + (2 * right) / width, seen.y - (2 * down) / height))?.place ?? null;
  }

  /** The position some pixels to the right of and below another one, at the same depth. */
  positionBeside(place: Vector, right: number, down: number): Vector {
    const { camera, canvas } = this.view;
    camera.updateMatrixWorld();
    const seen = new THREE.Vector3(...place).project(camera);
    const { width, height } = canvas.getBoundingClientRect();
    return new THREE.Vector3(seen.x + (2 * right) / width, seen.y - (2 * down) / height, seen.z).unproject(camera).toArray();
  }

  /** Shows the supports at their positions. `chosen`: index of the chosen one. */
  setSupports(places: readonly Vector[], chosen = -1): void {
    [this.supportPositions, this.chosenSupport] = [places, chosen];
    const colour = pageColours();
    this.supports.show({
      positions: places,
      kinds: places.map((_, k) => (k === chosen ? "chosen" : "support")),
      lines: [],
      colours: [],
      triangles: [],
      triangleColours: [],
      straight: false,
    }, (kind) => colour(DOT_COLOURS[kind]));
    this.view.draw();
  }

  /** Moves the camera so that the whole surface is visible. */
  fit(): void {
    const geometry = this.surface?.geometry;
    geometry?.computeBoundingSphere();
    if (geometry?.boundingSphere) this.view.showAll(geometry.boundingSphere, FROM);
  }

  setWireframe(shown: boolean): void {
    this.edges.visible = shown;
    this.view.draw();
  }

  setRamp(name: RampName): void {
    this.material.uniforms.ramp.value = RAMPS[name].map((rgb) => new THREE.Vector3(...rgb));
    this.view.draw();
  }

  /** Sets the distance between isolines; null for a round one. */
  setSpacing(spacing: number | null): void {
    this.chosenSpacing = spacing;
    this.setField(this.distances);
  }

  /** The present view as a PNG file. */
  snapshot(): Promise<Blob | null> {
    return this.view.picture();
  }

  /** Colours the surface by the distance at each vertex, which is negative if unknown; null for a plain surface. */
  setField(distances: ArrayLike<number> | null): void {
    this.distances = distances;
    const { uniforms } = this.material;
    const attribute = this.surface?.geometry.getAttribute("distance0") as THREE.BufferAttribute | undefined;
    uniforms.largest.value = 0;
    if (distances && attribute) {
      let largest = 0;
      for (let k = 0; k < distances.length; ++k) {
        attribute.setX(k, distances[k]);
        largest = Math.max(largest, distances[k]);
      }
      attribute.needsUpdate = true;
      uniforms.largest.value = largest;
      uniforms.spacing.value = this.chosenSpacing ?? isolineSpacing(largest);
    }
    this.view.draw();
  }

  setPaths(paths: readonly (readonly Vector[])[]): void {
    for (const line of this.lines.children as Line2[]) line.geometry.dispose();
    this.lines.clear();
    for (const path of paths) {
      if (path.length < 2) continue;
      const geometry = new LineGeometry();
      geometry.setPositions(path.flatMap((place) => [...place]));
      this.lines.add(new Line2(geometry, this.lineMaterial));
    }
    this.view.draw();
  }

  setMarks(points: readonly Vector[], mean: Vector | null): void {
    this.marks.clear();
    const colour = pageColours();
    this.lineMaterial.color = colour("--target");
    const addBall = (place: Vector, size: number, name: string) => {
      const mark = new THREE.Mesh(new THREE.SphereGeometry(size * this.radius, 24, 16), new THREE.MeshBasicMaterial({ color: colour(name) }));
      mark.position.set(...place);
      this.marks.add(mark);
    };
    this.markPositions = points;
    for (const place of points) addBall(place, 0.018, "--target");
    if (mean) addBall(mean, 0.028, "--simulated");
    this.view.draw();
  }

  /** Shows a network; null removes it. */
  setNetwork(picture: NetworkPicture | null): void {
    this.picture = picture;
    const colour = pageColours();
    this.network.show(picture, (kind) => colour(DOT_COLOURS[kind]));
    this.membrane.show(this.drapeOf(picture), picture?.triangleColours ?? [], colour("--solid"));
    this.view.draw();
  }

  /** The draped membrane of a picture. It is cached while only colours change. */
  private drapeOf(picture: NetworkPicture | null): Drape | null {
    if (!picture || picture.triangles.length === 0 || !this.deformedMesh || !this.surface) return null;
    const { positions, triangles } = picture;
    if (this.draped?.positions !== positions || this.draped.triangles !== triangles) {
      this.grid ??= new SurfaceGrid(this.deformedMesh);
      const normals = this.surface.geometry.getAttribute("normal").array;
      this.draped = { positions, triangles, drape: drape(this.deformedMesh, this.grid, normals, positions, triangles) };
    }
    return this.draped.drape;
  }

  private listen(): void {
    const { canvas } = this.view;
    let down: readonly [number, number] | null = null;
    let dragged: { point: number; place: Place | null } | null = null;
    let support: { index: number; at: Vector; moved: boolean } | null = null;
    let isMark = false;
    canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
    // The capture phase comes before the controls that rotate the view; stopping the event there keeps it from them.
    canvas.addEventListener("pointerdown", (event) => {
      const isFirst = event.button === 0 && event.isPrimary;
      isMark = this.dragsMarks;
      const point = !isFirst ? null : isMark ? this.markAt(event) : this.dragsPoints ? this.pointAt(event) : null;
      const grabbed = this.dragsSupports && isFirst ? this.nearestTo(event, this.supports) : null;
      if (point === null && grabbed === null) return;
      event.stopImmediatePropagation();
      canvas.setPointerCapture(event.pointerId);
      canvas.focus();
      if (grabbed !== null) support = { index: grabbed, at: this.supportPositions[grabbed], moved: false };
      else if (point !== null) dragged = { point, place: null };
      down = [event.clientX, event.clientY];
    }, { capture: true });
    canvas.addEventListener("pointermove", (event) => {
      if (support && down) {
        const [right, below] = [event.clientX - down[0], event.clientY - down[1]];
        support.moved ||= Math.hypot(right, below) >= CLICK_PIXELS;
        if (support.moved) this.onDragSupport(support.index, this.positionBeside(support.at, right, below));
      }
      if (!dragged || !down) return;
      if (!dragged.place && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < CLICK_PIXELS) return;
      const place = this.hit(this.deviceCoordinates(event))?.place;
      if (!place) return;
      dragged.place = place;
      (isMark ? this.onDragMark : this.onDrag)(dragged.point, place, false);
    });
    const release = (event: PointerEvent) => {
      const { point, place } = dragged ?? { point: 0, place: null };
      const wasDragged = place !== null || support?.moved === true;
      [dragged, support] = [null, null];
      if (place) (isMark ? this.onDragMark : this.onDrag)(point, place, true);
      else if (event.type === "pointerup" && down && event.button === 0 && !wasDragged && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < CLICK_PIXELS) {
        this.pick(event);
      }
      down = null;
    };
    canvas.addEventListener("pointerup", release);
    canvas.addEventListener("pointercancel", release);
    canvas.addEventListener("keydown", (event) => {
      const steps: Record<string, readonly [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
      const step = event.shiftKey && (this.dragsPoints || this.dragsSupports) ? steps[event.key] : undefined;
      if (!step) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      this.onNudge(...step);
    }, { capture: true });
  }

  /** Position of the pointer in normalized device coordinates, from -1 to 1. */
  private deviceCoordinates(event: PointerEvent): THREE.Vector2 {
    const box = this.view.canvas.getBoundingClientRect();
    return new THREE.Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
  }

  private hit(at: THREE.Vector2): { place: Place; distance: number } | null {
    if (!this.surface || !this.deformedMesh) return null;
    const ray = new THREE.Raycaster();
    this.view.camera.updateMatrixWorld(); // needed if the camera has moved since the last drawing
    ray.setFromCamera(at, this.view.camera);
    const hit = ray.intersectObject(this.surface)[0];
    const face = hit?.faceIndex ?? null;
    return face === null ? null : { place: { face, barycentric: barycentricOf(this.deformedMesh, face, hit.point.toArray()) }, distance: hit.distance };
  }

  private pointAt(event: PointerEvent): number | null {
    return this.nearestTo(event, this.network);
  }

  /** Index of the marked point nearest to the pointer, unless the surface hides it. */
  private markAt(event: PointerEvent): number | null {
    const box = this.view.canvas.getBoundingClientRect();
    const hit = this.hit(this.deviceCoordinates(event));
    const depth = hit ? hit.distance + VISIBLE_DEPTH * this.radius : Infinity;
    let [best, minPixels]: [number | null, number] = [null, POINT_PIXELS];
    this.markPositions.forEach((mark, k) => {
      const at = new THREE.Vector3(...mark);
      if (at.distanceTo(this.view.camera.position) > depth) return;
      at.project(this.view.camera);
      const pixels = Math.hypot(((at.x + 1) / 2) * box.width - (event.clientX - box.left), ((1 - at.y) / 2) * box.height - (event.clientY - box.top));
      if (pixels < minPixels) [best, minPixels] = [k, pixels];
    });
    return best;
  }

  private nearestTo(event: PointerEvent, drawing: NetworkDrawing): number | null {
    const box = this.view.canvas.getBoundingClientRect();
    const hit = this.hit(this.deviceCoordinates(event));
    const depth = hit ? hit.distance + VISIBLE_DEPTH * this.radius : Infinity;
    return drawing.nearest(event.clientX - box.left, event.clientY - box.top, POINT_PIXELS, this.view.camera, box, depth);
  }

  private pick(event: PointerEvent): void {
    if (!this.surface || !this.deformedMesh) return;
    this.onPick({ place: this.hit(this.deviceCoordinates(event))?.place ?? null, point: this.pointAt(event) });
  }
}

function pageColours(): (name: string) => THREE.Color {
  const style = getComputedStyle(document.documentElement);
  return (name) => new THREE.Color(style.getPropertyValue(name).trim() || "#c2500f");
}
