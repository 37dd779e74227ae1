// A surface with a colour for each face. It uses three.js and does not depend on the server.
import * as THREE from "three";
import type { Rgb } from "./spring_colours";
import { facesMaterial } from "./surface_material";

export class HostDrawing {
  readonly group = new THREE.Group();
  private readonly material = facesMaterial();
  private faces: THREE.Mesh<THREE.BufferGeometry, THREE.ShaderMaterial> | null = null;

  /** Shows the faces of an indexed surface, each in its colour; null removes them. */
  show(surface: THREE.BufferGeometry | null, colours: readonly Rgb[] | null): void {
    this.faces?.geometry.dispose();
    this.group.clear();
    this.faces = null;
    if (!surface || !colours) return;
    const geometry = surface.toNonIndexed();
    geometry.deleteAttribute("distance0");
    const values = new Float32Array(9 * colours.length);
    colours.forEach((colour, face) => [0, 3, 6].forEach((corner) => values.set(colour, 9 * face + corner)));
    geometry.setAttribute("colour", new THREE.BufferAttribute(values, 3));
    this.faces = new THREE.Mesh(geometry, this.material);
    this.faces.frustumCulled = false;
    this.group.add(this.faces);
  }
}
