// A surface with what lies on it. Knows three.js and nothing of the server.
import * as THREE from "three";
import { Line2 } from "three/examples/jsm/lines/Line2.js";
import { LineGeometry } from "three/examples/jsm/lines/LineGeometry.js";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { dark } from "../base/theme";
import { SceneView } from "../scene/scene_view";
import { drape, type Drape } from "./membrane_drape";
import { MembraneDrawing } from "./membrane_drawing";
import { HostDrawing } from "./host_drawing";
import { barycentricOf, type MeshData, roundStep, type Vector } from "./mesh_data";
import { SurfaceGrid } from "./nearest_on_surface";
import { NetworkDrawing, type NetworkPicture } from "./network_drawing";
import type { Rgb } from "./spring_colours";
import { surfaceMaterial } from "./surface_material";

const CLICK_PIXELS = 5;
const ISOLINES = 18;
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

export interface Pick {
  /** Where the surface was hit; null beside it. */
  place: { face: number; barycentric: Vector } | null;
  /** The point of the network that was hit. */
  point: number | null;
}

export class MeshViewer {
  onPick: (pick: Pick) => void = () => {};
  private readonly view: SceneView;
  private readonly material = surfaceMaterial();
  private readonly marks = new THREE.Group();
  private readonly lines = new THREE.Group();
  private readonly network = new NetworkDrawing();
  private readonly membrane = new MembraneDrawing();
  private readonly supports = new NetworkDrawing();
  private readonly host = new HostDrawing();
  private supported: readonly Vector[] = [];
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
    this.view.scene.add(this.marks, this.lines, this.host.group, this.membrane.group, this.supports.group, this.network.group);
    this.listen();
    dark.watch((isDark) => {
      this.material.uniforms.plain.value.set(isDark ? 0x7d8790 : 0xb9c2c8);
      this.setNetwork(this.picture);
      this.setSupports(this.supported);
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
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(Float32Array.from(data.positions), 3));
    geometry.setIndex(new THREE.BufferAttribute(data.faces, 1));
    geometry.computeVertexNormals();
    geometry.setAttribute("distance0", new THREE.BufferAttribute(new Float32Array(data.positions.length / 3), 1));
    geometry.computeBoundingSphere();
    this.surface = new THREE.Mesh(geometry, this.material);
    this.view.scene.add(this.surface);
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

  /** Marks vertices that are held. */
  setSupports(places: readonly Vector[]): void {
    this.supported = places;
    const colour = pageColours();
    this.supports.show({ positions: places, kinds: places.map(() => "support"), lines: [], colours: [], triangles: [], triangleColours: [], straight: false }, (kind) => colour(DOT_COLOURS[kind]));
    this.view.draw();
  }

  /** Colours by distance, one for each vertex (below 0 where there is none); plain without. Returns the spacing of the isolines. */
  setField(distances: ArrayLike<number> | null): number {
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
      uniforms.spacing.value = roundStep(largest || 1, ISOLINES);
    }
    this.view.draw();
    return uniforms.spacing.value as number;
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
    canvas.addEventListener("pointerdown", (event) => (down = [event.clientX, event.clientY]));
    canvas.addEventListener("pointerup", (event) => {
      if (down && event.button === 0 && Math.hypot(event.clientX - down[0], event.clientY - down[1]) < CLICK_PIXELS) this.pick(event);
      down = null;
    });
  }

  private pick(event: PointerEvent): void {
    if (!this.surface || !this.shape) return;
    const { camera, canvas } = this.view;
    const box = canvas.getBoundingClientRect();
    const place = new THREE.Vector2(((event.clientX - box.left) / box.width) * 2 - 1, 1 - ((event.clientY - box.top) / box.height) * 2);
    const ray = new THREE.Raycaster();
    camera.updateMatrixWorld(); // where drawing is slow, nothing has done so yet
    ray.setFromCamera(place, camera);
    const hit = ray.intersectObject(this.surface)[0];
    const face = hit?.faceIndex ?? null;
    const depth = hit ? hit.distance + BEHIND * this.radius : Infinity;
    const point = this.network.nearest(event.clientX - box.left, event.clientY - box.top, POINT_PIXELS, camera, box, depth);
    this.onPick({ place: face === null ? null : { face, barycentric: barycentricOf(this.shape, face, hit.point.toArray()) }, point });
  }
}

function pageColours(): (name: string) => THREE.Color {
  const style = getComputedStyle(document.documentElement);
  return (name) => new THREE.Color(style.getPropertyValue(name).trim() || "#c2500f");
}
