// The 3D view of a sheet: strands as tubes, and faint lines for the sheet at rest. It does not depend on the server.
import * as THREE from "three";
import { dark } from "../base/theme";
import { SceneView } from "../scene/scene_view";
import { smoothed } from "./geometry";
import { tubes, type Vector } from "./tubes";

/** Initial direction from the sheet to the camera. */
const FROM = new THREE.Vector3(0.15, -0.6, 1.2);
/** Vertices around a tube. They are reduced above a number of points, so that drawing stays fast. */
const SIDES = 8;
const REDUCED_SIDES = 4;
const MAX_POINTS_WITH_ALL_SIDES = 60_000;

const MAX_SMOOTH_PIECES = 5;

/** Whether a line ends where it begins. */
function isLoop(line: readonly Vector[]): boolean {
  return line.length > 2 && line[0].every((value, axis) => Math.abs(value - line[line.length - 1][axis]) < 1e-9);
}

export type Lines = readonly (readonly Vector[])[];

export class SheetViewer {
  private readonly view = new SceneView("No sheet yet");
  private readonly material = new THREE.MeshLambertMaterial({ side: THREE.DoubleSide });
  private readonly restMaterial = new THREE.LineBasicMaterial({ transparent: true, opacity: 0.35 });
  private readonly strands = new THREE.Mesh(new THREE.BufferGeometry(), this.material);
  private readonly rest = new THREE.LineSegments(new THREE.BufferGeometry(), this.restMaterial);

  /** Throws if the browser has no WebGL. */
  constructor() {
    const { scene, camera } = this.view;
    const lamp = new THREE.DirectionalLight(0xffffff, 1.6);
    lamp.position.set(0.4, 0.7, 0.9);
    camera.add(lamp);
    scene.add(camera, new THREE.HemisphereLight(0xffffff, 0x8a8f96, 1.7), this.strands, this.rest);
    dark.watch(() => this.paint());
  }

  get element(): HTMLElement {
    return this.view.element;
  }

  /** Shows a new sheet. The camera shows all of `states`, of which the first is at rest. */
  setSheet(states: readonly Lines[]): void {
    const places = states.flatMap((lines) => lines.flatMap((line) => line.map((place) => new THREE.Vector3(...place))));
    this.view.showAll(new THREE.Box3().setFromPoints(places).getBoundingSphere(new THREE.Sphere()), FROM);
    const pieces = (states[0] ?? []).flatMap((line) => line.slice(1).flatMap((place, k) => [...line[k], ...place]));
    this.rest.geometry.dispose();
    this.rest.geometry = new THREE.BufferGeometry().setAttribute("position", new THREE.Float32BufferAttribute(pieces, 3));
  }

  /** Draws the strands with their radii. `words`: description for screen readers. */
  setStrands(lines: Lines, radii: readonly number[], words: string): void {
    const nodes = lines.reduce((sum, line) => sum + line.length, 0);
    // The answer has a point for each node of the rods, which are smooth between them. Large sheets have nodes enough.
    const pieces = Math.max(1, Math.min(MAX_SMOOTH_PIECES, Math.floor(MAX_POINTS_WITH_ALL_SIDES / Math.max(1, nodes))));
    const smooth = lines.map((line) => smoothed(line, isLoop(line), pieces));
    const points = smooth.reduce((sum, line) => sum + line.length, 0);
    const { positions, normals, triangles } = tubes(smooth, radii, points > MAX_POINTS_WITH_ALL_SIDES ? REDUCED_SIDES : SIDES);
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(positions, 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(normals, 3));
    geometry.setIndex(new THREE.BufferAttribute(triangles, 1));
    this.strands.geometry.dispose();
    this.strands.geometry = geometry;
    this.view.words = words;
    this.paint();
  }

  private paint(): void {
    const style = getComputedStyle(document.documentElement);
    const colour = (name: string) => style.getPropertyValue(name).trim() || "#345";
    this.material.color.set(colour("--solid"));
    this.restMaterial.color.set(colour("--line-strong"));
    this.view.draw();
  }
}
