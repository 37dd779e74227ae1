// A drawing of a network: springs as lines, points as dots. It uses three.js and does not depend on the server.
import * as THREE from "three";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
import type { Triple } from "./membrane";
import type { Vector } from "./mesh_data";
import type { Rgb } from "./spring_colours";

export type DotKind = "free" | "fixed" | "chosen" | "support" | "faulty";

export interface NetworkPicture {
  readonly positions: readonly Vector[];
  readonly kinds: readonly DotKind[];
  /** A polyline for each spring, with at least two points. */
  readonly lines: readonly (readonly Vector[])[];
  /** The colour of each spring. */
  readonly colours: readonly Rgb[];
  /** The triangles of a membrane, and their colours. */
  readonly triangles: readonly Triple[];
  readonly triangleColours: readonly Rgb[];
  /** Whether springs are straight in space; otherwise they lie on the surface. */
  readonly straight: boolean;
}

/** Depth offsets of lines towards the camera, in units of the depth resolution. Straight springs need more, because they run below a curved surface. */
const DEPTH_OFFSET = { straight: 1200, exact: 300 };
/** Resolution of a depth buffer with 24 bits, for depths from -1 to 1. */
const DEPTH_STEP = 2 ** -23;
/** Depth offset of dots, over that of lines. */
const DOT_OFFSET_FACTOR = 1.3;
/** Limits of the number of points; networks above them have smaller dots. */
const MAX_POINTS_WITH_LARGE_DOTS = 60;
const MAX_POINTS_WITH_MEDIUM_DOTS = 400;

const vertexShader = /* glsl */ `
  attribute vec3 colour;
  attribute float size;
  uniform float ratio;
  uniform float nearer;
  varying vec3 vColour;
  varying float vSize;
  void main() {
    vColour = colour;
    vSize = size * ratio;
    gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
    gl_Position.z -= nearer * gl_Position.w;
    gl_PointSize = vSize;
  }`;

const fragmentShader = /* glsl */ `
  uniform vec3 rim;
  varying vec3 vColour;
  varying float vSize;
  void main() {
    float away = length(gl_PointCoord - 0.5) * vSize;
    float radius = 0.5 * vSize;
    if (away > radius) discard;
    gl_FragColor = vec4(mix(vColour, rim, smoothstep(radius - 2.6, radius - 1.6, away)), 1.0);
    #include <colorspace_fragment>
  }`;

export class NetworkDrawing {
  readonly group = new THREE.Group();
  private readonly lineMaterial = new LineMaterial({ linewidth: 3, vertexColors: true, polygonOffset: true, polygonOffsetFactor: 0 });
  private readonly dotMaterial = new THREE.ShaderMaterial({
    vertexShader,
    fragmentShader,
    uniforms: { rim: { value: new THREE.Color(1, 1, 1) }, ratio: { value: 1 }, nearer: { value: 0 } },
  });
  private readonly dots = new THREE.Points(new THREE.BufferGeometry(), this.dotMaterial);
  private lines: LineSegments2 | null = null;
  private positions: readonly Vector[] = [];

  constructor() {
    this.dots.frustumCulled = false;
    this.group.add(this.dots);
  }

  resized(width: number, height: number, ratio: number): void {
    this.lineMaterial.resolution.set(width, height);
    this.dotMaterial.uniforms.ratio.value = ratio;
  }

  /** Shows a network; null removes it. `colourOf` gives the colours of the present theme. */
  show(picture: NetworkPicture | null, colourOf: (kind: DotKind | "rim") => THREE.Color): void {
    this.positions = picture?.positions ?? [];
    const nearer = picture?.straight ? DEPTH_OFFSET.straight : DEPTH_OFFSET.exact;
    this.lineMaterial.polygonOffsetUnits = -nearer;
    this.dotMaterial.uniforms.nearer.value = DOT_OFFSET_FACTOR * nearer * DEPTH_STEP;
    this.showLines(picture);
    const dots = this.positions.length;
    const free = dots > MAX_POINTS_WITH_MEDIUM_DOTS ? 5 : dots > MAX_POINTS_WITH_LARGE_DOTS ? 9 : 12;
    const geometry = new THREE.BufferGeometry();
    const kinds: Record<DotKind, THREE.Color> = {
      free: colourOf("free"),
      fixed: colourOf("fixed"),
      chosen: colourOf("chosen"),
      support: colourOf("support"),
      faulty: colourOf("faulty"),
    };
    const sizes: Record<DotKind, number> = { free, fixed: 15, chosen: 17, support: dots > MAX_POINTS_WITH_LARGE_DOTS ? 7 : 11, faulty: 21 };
    this.dotMaterial.uniforms.rim.value = colourOf("rim");
    geometry.setAttribute("position", new THREE.Float32BufferAttribute(this.positions.flatMap((place) => [...place]), 3));
    geometry.setAttribute("colour", new THREE.Float32BufferAttribute(this.positions.flatMap((_, k) => kinds[picture?.kinds[k] ?? "free"].toArray()), 3));
    geometry.setAttribute("size", new THREE.Float32BufferAttribute(this.positions.map((_, k) => sizes[picture?.kinds[k] ?? "free"]), 1));
    this.dots.geometry.dispose();
    this.dots.geometry = geometry;
    this.dots.visible = dots > 0;
  }

  /** The point nearest to a position on the canvas, within `maxDistance` pixels and at most `depth` away from the camera. */
  nearest(x: number, y: number, maxDistance: number, camera: THREE.Camera, size: { width: number; height: number }, depth: number): number | null {
    let found: number | null = null;
    let minDistance = maxDistance;
    const place = new THREE.Vector3();
    this.positions.forEach((position, k) => {
      place.set(...position);
      if (place.distanceTo(camera.position) > depth) return;
      place.project(camera);
      const distance = Math.hypot(((place.x + 1) / 2) * size.width - x, ((1 - place.y) / 2) * size.height - y);
      if (distance < minDistance) [found, minDistance] = [k, distance];
    });
    return found;
  }

  private showLines(picture: NetworkPicture | null): void {
    if (this.lines) {
      this.lines.geometry.dispose();
      this.lines.removeFromParent();
      this.lines = null;
    }
    const pieces = picture?.lines.reduce((sum, line) => sum + line.length - 1, 0) ?? 0;
    if (!picture || pieces === 0) return;
    const places = new Float32Array(6 * pieces);
    const colours = new Float32Array(6 * pieces);
    let at = 0;
    picture.lines.forEach((line, spring) => {
      for (let k = 1; k < line.length; ++k, at += 6) {
        places.set(line[k - 1], at);
        places.set(line[k], at + 3);
        colours.set(picture.colours[spring], at);
        colours.set(picture.colours[spring], at + 3);
      }
    });
    const geometry = new LineSegmentsGeometry();
    geometry.setPositions(places);
    geometry.setColors(colours);
    this.lines = new LineSegments2(geometry, this.lineMaterial);
    this.lines.frustumCulled = false;
    this.group.add(this.lines);
  }
}
