// A drawing of a membrane: coloured triangles, and their sides as thin lines. It uses three.js and does not depend on the server.
import * as THREE from "three";
import { LineMaterial } from "three/examples/jsm/lines/LineMaterial.js";
import { LineSegments2 } from "three/examples/jsm/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/examples/jsm/lines/LineSegmentsGeometry.js";
import type { Drape } from "./membrane_drape";
import type { Rgb } from "./spring_colours";
import { facesMaterial } from "./surface_material";

/** Depth offsets of triangles and sides towards the camera, in units of the depth resolution, so that the surface below does not hide them. */
const TRIANGLE_DEPTH_OFFSET = 150;
const SIDE_DEPTH_OFFSET = 260;

export class MembraneDrawing {
  readonly group = new THREE.Group();
  private readonly material = facesMaterial({ polygonOffset: true, polygonOffsetFactor: -1, polygonOffsetUnits: -TRIANGLE_DEPTH_OFFSET });
  private readonly lineMaterial = new LineMaterial({ linewidth: 1.4, polygonOffset: true, polygonOffsetFactor: 0, polygonOffsetUnits: -SIDE_DEPTH_OFFSET });
  private drape: Drape | null = null;
  private triangles: THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial> | null = null;
  private sides: LineSegments2 | null = null;

  resized(width: number, height: number): void {
    this.lineMaterial.resolution.set(width, height);
  }

  /** Shows a membrane with a colour for each of its triangles; null removes it. */
  show(drape: Drape | null, colours: readonly Rgb[], sides: THREE.Color): void {
    if (drape !== this.drape) this.setDrape(drape);
    this.lineMaterial.color = sides;
    if (!drape || !this.triangles) return;
    const values = new Float32Array(drape.positions.length);
    colours.forEach((colour, k) => {
      for (let corner = 0; corner < 3 * drape.perTriangle; ++corner) values.set(colour, 3 * (3 * drape.perTriangle * k + corner));
    });
    this.triangles.geometry.setAttribute("colour", new THREE.BufferAttribute(values, 3));
  }

  private setDrape(drape: Drape | null): void {
    this.drape = drape;
    for (const part of [this.triangles, this.sides]) part?.geometry.dispose();
    this.group.clear();
    [this.triangles, this.sides] = [null, null];
    if (!drape || drape.positions.length === 0) return;
    const geometry = new THREE.BufferGeometry();
    geometry.setAttribute("position", new THREE.BufferAttribute(drape.positions, 3));
    geometry.setAttribute("normal", new THREE.BufferAttribute(drape.normals, 3));
    this.triangles = new THREE.Mesh(geometry, this.material);
    const lines = new LineSegmentsGeometry();
    lines.setPositions(drape.sides);
    this.sides = new LineSegments2(lines, this.lineMaterial);
    this.triangles.frustumCulled = this.sides.frustumCulled = false;
    this.group.add(this.triangles, this.sides);
  }
}
