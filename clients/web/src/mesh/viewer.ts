// A surface with what lies on it. Knows three.js and nothing of the server.
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
/** Where a surface is looked at from at first. */
const FROM = new THREE.Vector3(0.35, 0.45, 1);

/** A point of a network that is hit this near, in pixels. */
const POINT_PIXELS = 14;
const DOT_COLOURS = { free: "--solid", fixed: "--target", chosen: "--simulated", support: "--missed", rim: "--surface" } as const;
/** How far behind the surface, of its radius, a point of a network is still seen. */
const BEHIND = 0.05;

/** A surface that gave way. */
export interface HostPicture {
  /** Where its vertices are; null for the mesh as it is. */
  readonly vertices: readonly Vector[] | null;
  /** One for each face; null for a plain surface. */
  readonly colours: readonly Rgb[] | null;
}

/** A place on the surface. */
export interface Place {
  face: number;
  barycentric: Vector;
}

export interface Pick {
  /** Where the surface was hit; null beside it. */
  place: Place | null;
  /** The point of the network that was hit. */
  point: number | null;
}

export class MeshViewer {
  onPick: (pick: Pick) => void = () => {};
  /** Whether a point of the network, when it is seized, is dragged along the surface instead of turning the view. */
  drags = false;
  /** Whether a marked point, when it is seized, is dragged along the surface. */
  dragsMarks = false;
  onDragMark: (mark: number, place: Place, done: boolean) => void = () => {};
  /** A point that is dragged, the place that it is at, and whether it was let go there. */
  onDrag: (point: number, place: Place, done: boolean) => void = () => {};
  /** Whether a vertex that is held, when it is seized, is dragged through space instead of turning the view. */
  dragsSupports = false;
  /** Which of the supports is dragged, and where to: in the plane through its place that faces the camera. */
  onDragSupport: (support: number, to: Vector) => void = () => {};
  /** Shift and an arrow key: steps to the right and down. */
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
  private marked: readonly Vector[] = [];
  private distances: ArrayLike<number> | null = null;
  private wantedSpacing: number | null = null;
  private supported: readonly Vector[] = [];
  private chosenSupport = -1;
  /** Of the surface as it is seen, once a membrane lies on it. */
  private grid: SurfaceGrid | null = null;
  private draped: { positions: NetworkPicture["positions"]; triangles: NetworkPicture["triangles"]; drape: Drape } | null = null;
  private picture: NetworkPicture | null = null;
  private readonly lineMaterial = new LineMaterial({ linewidth: 5 });
  private surface: THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial> | null = null;
  private data: MeshData | null = null;
  /** The mesh as it is seen, which may have given way. */
  private shape: MeshData | null = null;
  private shapeVertices: readonly Vector[] | null = null;
  private radius = 1;

  /** Throws where the browser has no WebGL. */
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
      this.setSupports(this.supported, this.chosenSupport);
    });
  }

  get element(): HTMLElement {
    return this.view.element;
  }

  setMesh(data: MeshData, words: string): void {
    this.surface?.geometry.dispose();
    this.surface?.removeFromParent();
    this.data = this.shape = data;
    [this.grid, this.draped, this.shapeVertices] = [null, null, null];
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
    this.radius = sphere.radius || 1;
    this.view.showAll(sphere, FROM);
    this.setField(null);
  }

  /** The surface as it gave way and the colours of its faces; as the mesh has it, and plain, with null. */
  setHost(picture: HostPicture | null): void {
    if (!this.surface || !this.data) return;
    const vertices = picture?.vertices ?? null;
    const { geometry } = this.surface;
    if (vertices !== this.shapeVertices) {
      this.shapeVertices = vertices;
      this.shape = vertices ? { positions: Float64Array.from(vertices.flatMap((place) => [...place])), faces: this.data.faces } : this.data;
      [this.grid, this.draped] = [null, null];
      const attribute = geometry.getAttribute("position") as THREE.BufferAttribute;
      attribute.array.set(this.shape.positions);
      attribute.needsUpdate = true;
      geometry.computeVertexNormals();
      geometry.computeBoundingSphere();
    }
    this.surface.visible = !picture?.colours;
    this.host.show(geometry, picture?.colours ?? null);
    this.view.draw();
  }

  /** Cells in place of the plain surface; none with null. */
  setCells(picture: CellPicture | null): void {
    if (!this.surface || !this.data) return;
    this.cells.show(this.data, this.surface.geometry.getAttribute("normal").array, picture);
    this.surface.visible = !picture;
    this.view.draw();
  }

  /** The place of the surface that is seen so many pixels to the right of a place and below it; null beside the surface. */
  beside(place: Vector, right: number, down: number): Place | null {
    const { camera, canvas } = this.view;
    camera.updateMatrixWorld();
    const seen = new THREE.Vector3(...place).project(camera);
    const { width, height } = canvas.getBoundingClientRect();
    return this.hit(new THREE.Vector2(seen.x + (2 * right) / width, seen.y - (2 * down) / height))?.place ?? null;
  }

  /** The place so many pixels to the right of another and below it, as far from the camera. */
  besideInSpace(place: Vector, right: number, down: number): Vector {
    const { camera, canvas } = this.view;
    camera.updateMatrixWorld();
    const seen = new THREE.Vector3(...place).project(camera);
    const { width, height } = canvas.getBoundingClientRect();
    return new THREE.Vector3(seen.x + (2 * right) / width, seen.y - (2 * down) / height, seen.z).unproject(camera).toArray();
  }

  /** Marks vertices that are held. */
  setSupports(places: readonly Vector[], chosen = -1): void {
    [this.supported, this.chosenSupport] = [places, chosen];
    const colour = pageColours();
    this.supports.show({ positions: places, kinds: places.map((_, k) => (k === chosen ? "chosen" : "support")), lines: [], colours: [], triangles: [], triangleColours: [], straight: false }, (kind) => colour(DOT_COLOURS[kind]));
    this.view.draw();
  }

  /** Looks at the whole surface again. */
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

  /** Between isolines; a round one with null. */
  setSpacing(spacing: number | null): void {
    this.wantedSpacing = spacing;
    this.setField(this.distances);
  }

  /** What is seen now, as a picture. */
  snapshot(): Promise<Blob | null> {
    return this.view.picture();
  }

  /** Colours by distance, one for each vertex (below 0 where there is none); plain without. */
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
      uniforms.spacing.value = this.wantedSpacing ?? isolineSpacing(largest);
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
    const ball = (place: Vector, size: number, name: string) => {
      const mark = new THREE.Mesh(new THREE.SphereGeometry(size * this.radius, 24, 16), new THREE.MeshBasicMaterial({ color: colour(name) }));
      mark.position.set(...place);
      this.marks.add(mark);
    };
    this.marked = points;
    for (const place of points) ball(place, 0.018, "--target");
    if (mean) ball(mean, 0.028, "--simulated");
    this.view.draw();
  }

  /** A network in place of the one that was seen; none with null. */
  setNetwork(picture: NetworkPicture | null): void {
    this.picture = picture;
    const colour = pageColours();
    this.network.show(picture, (kind) => colour(DOT_COLOURS[kind]));
    this.membrane.show(this.drapeOf(picture), picture?.triangleColours ?? [], colour("--solid"));
    this.view.draw();
  }

  /** Where only colours change, the drape stays. */
  private drapeOf(picture: NetworkPicture | null): Drape | null {
    if (!picture || picture.triangles.length === 0 || !this.shape || !this.surface) return null;
    const { positions, triangles } = picture;
    if (this.draped?.positions !== positions || this.draped.triangles !== triangles) {
      this.grid ??= new SurfaceGrid(this.shape);
      const normals = this.surface.geometry.getAttribute("normal").array;
      this.draped = { positions, triangles, drape: drape(this.shape, this.grid, normals, positions, triangles) };
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
    // Before the controls that turn the view, which then hear nothing of it.
    canvas.addEventListener("pointerdown", (event) => {
      const isFirst = event.button === 0 && event.isPrimary;
      isMark = this.dragsMarks;
      const point = !isFirst ? null : isMark ? this.markAt(event) : this.drags ? this.pointAt(event) : null;
      const held = this.dragsSupports && isFirst ? this.nearestTo(event, this.supports) : null;
      if (point === null && held === null) return;
      event.stopImmediatePropagation();
      canvas.setPointerCapture(event.pointerId);
      canvas.focus();
      if (held !== null) support = { index: held, at: this.supported[held], moved: false };
      else if (point !== null) dragged = { point, place: null };
      down = [event.clientX, event.clientY];
    }, { capture: true });
    canvas.addEventListener("pointermove", (event) => {
      if (support && down) {
        const [right, below] = [event.clientX - down[0], event.clientY - down[1]];
        support.moved ||= Math.hypot(right, below) >= CLICK_PIXELS;
        if (support.moved) this.onDragSupport(support.index, this.besideInSpace(support.at, right, below));
      }
      if (!dragged || !down) return;
      if (!dragged.place && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < CLICK_PIXELS) return;
      const place = this.hit(this.placeOf(event))?.place;
      if (!place) return;
      dragged.place = place;
      (isMark ? this.onDragMark : this.onDrag)(dragged.point, place, false);
    });
    const release = (event: PointerEvent) => {
      const { point, place } = dragged ?? { point: 0, place: null };
      const wasDragged = place !== null || support?.moved === true;
      [dragged, support] = [null, null];
      if (place) (isMark ? this.onDragMark : this.onDrag)(point, place, true);
      else if (event.type === "pointerup" && down && event.button === 0 && !wasDragged && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < CLICK_PIXELS) this.pick(event);
      down = null;
    };
    canvas.addEventListener("pointerup", release);
    canvas.addEventListener("pointercancel", release);
    canvas.addEventListener("keydown", (event) => {
      const steps: Record<string, readonly [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
      const step = event.shiftKey && (this.drags || this.dragsSupports) ? steps[event.key] : undefined;
      if (!step) return;
      event.preventDefault();
      event.stopImmediatePropagation();
      this.onNudge(...step);
    }, { capture: true });
  }

  /** Where the pointer is, from -1 to 1. */
  private placeOf(event: PointerEvent): THREE.Vector2 {
    const box = this.view.canvas.getBoundingClientRect();
    return new THREE.Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
  }

  private hit(at: THREE.Vector2): { place: Place; distance: number } | null {
    if (!this.surface || !this.shape) return null;
    const ray = new THREE.Raycaster();
    this.view.camera.updateMatrixWorld(); // where drawing is slow, nothing has done so yet
    ray.setFromCamera(at, this.view.camera);
    const hit = ray.intersectObject(this.surface)[0];
    const face = hit?.faceIndex ?? null;
    return face === null ? null : { place: { face, barycentric: barycentricOf(this.shape, face, hit.point.toArray()) }, distance: hit.distance };
  }

  private pointAt(event: PointerEvent): number | null {
    return this.nearestTo(event, this.network);
  }

  /** The marked point next to the pointer, unless it is hidden behind the surface. */
  private markAt(event: PointerEvent): number | null {
    const box = this.view.canvas.getBoundingClientRect();
    const hit = this.hit(this.placeOf(event));
    const depth = hit ? hit.distance + BEHIND * this.radius : Infinity;
    let [best, least]: [number | null, number] = [null, POINT_PIXELS];
    this.marked.forEach((mark, k) => {
      const at = new THREE.Vector3(...mark);
      if (at.distanceTo(this.view.camera.position) > depth) return;
      at.project(this.view.camera);
      const away = Math.hypot(((at.x + 1) / 2) * box.width - (event.clientX - box.left), ((1 - at.y) / 2) * box.height - (event.clientY - box.top));
      if (away < least) [best, least] = [k, away];
    });
    return best;
  }

  private nearestTo(event: PointerEvent, drawing: NetworkDrawing): number | null {
    const box = this.view.canvas.getBoundingClientRect();
    const hit = this.hit(this.placeOf(event));
    const depth = hit ? hit.distance + BEHIND * this.radius : Infinity;
    return drawing.nearest(event.clientX - box.left, event.clientY - box.top, POINT_PIXELS, this.view.camera, box, depth);
  }

  private pick(event: PointerEvent): void {
    if (!this.surface || !this.shape) return;
    this.onPick({ place: this.hit(this.placeOf(event))?.place ?? null, point: this.pointAt(event) });
  }
}

function pageColours(): (name: string) => THREE.Color {
  const style = getComputedStyle(document.documentElement);
  return (name) => new THREE.Color(style.getPropertyValue(name).trim() || "#c2500f");
}
