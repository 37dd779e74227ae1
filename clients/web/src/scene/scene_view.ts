// A 3D view that pointer and keys rotate and zoom. This module uses three.js and does not depend on the content of the scene.
import * as THREE from "three";
import { OrbitControls } from "three/examples/jsm/controls/OrbitControls.js";
import { h } from "../base/dom";

const KEY_ANGLE = 0.12;
const KEY_ZOOM = 0.9;
const FIELD_OF_VIEW = 35;
/** Radius that fits into the view, over the radius of the content. */
const MARGIN_FACTOR = 1.12;

export class SceneView {
  readonly element = h("div", { class: "viewer" });
  readonly canvas: HTMLCanvasElement;
  readonly scene = new THREE.Scene();
  readonly camera = new THREE.PerspectiveCamera(FIELD_OF_VIEW, 1, 0.01, 1000);
  /** Called with the size of the canvas in pixels. */
  resized: (width: number, height: number) => void = () => {};
  private readonly renderer: THREE.WebGLRenderer;
  private readonly controls: OrbitControls;
  private scheduled = false;
  /** The sphere that fills the view, and the direction from its centre to the camera; null after the user has moved the camera. */
  private fitted: { sphere: THREE.Sphere; from: THREE.Vector3 } | null = null;

  /** Throws if the browser has no WebGL. */
  constructor(words: string) {
    this.canvas = h("canvas", { tabindex: 0, role: "img", "aria-label": words });
    this.renderer = new THREE.WebGLRenderer({ canvas: this.canvas, antialias: true, alpha: true });
    this.renderer.setPixelRatio(Math.min(2, devicePixelRatio));
    this.controls = new OrbitControls(this.camera, this.canvas);
    this.controls.addEventListener("change", () => this.draw());
    this.controls.addEventListener("start", () => (this.fitted = null));
    this.element.append(this.canvas);
    this.canvas.addEventListener("keydown", (event) => this.key(event));
    new ResizeObserver(() => this.resize()).observe(this.element);
  }

  /** Pixels of the picture for each CSS pixel. */
  get pixelRatio(): number {
    return this.renderer.getPixelRatio();
  }

  set words(words: string) {
    this.canvas.setAttribute("aria-label", words);
  }

  /** Schedules one drawing before the next repaint of the browser. */
  draw(): void {
    if (this.scheduled) return;
    this.scheduled = true;
    requestAnimationFrame(() => {
      this.scheduled = false;
      this.renderer.render(this.scene, this.camera);
    });
  }

  /** Moves the camera so that the whole sphere is visible from a direction, for any aspect ratio. */
  showAll(sphere: THREE.Sphere, from: THREE.Vector3): void {
    const distance = distanceToFit(sphere.radius || 1, this.camera.aspect);
    const radius = sphere.radius || 1;
    this.fitted = { sphere, from };
    this.controls.target.copy(sphere.center);
    this.camera.position.copy(sphere.center).add(from.clone().normalize().multiplyScalar(distance));
    this.camera.near = radius / 100;
    this.camera.far = distance + 20 * radius;
    this.camera.updateProjectionMatrix();
    this.controls.update();
    this.draw();
  }

  /** The present view as a PNG file. */
  picture(): Promise<Blob | null> {
    this.renderer.render(this.scene, this.camera);
    return new Promise((resolve) => this.canvas.toBlob(resolve, "image/png"));
  }

  private resize(): void {
    const { clientWidth: width, clientHeight: height } = this.element;
    if (width === 0 || height === 0) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.resized(width, height);
    if (this.fitted) this.showAll(this.fitted.sphere, this.fitted.from);
    this.draw();
  }

  private key(event: KeyboardEvent): void {
    const turns: Record<string, readonly [number, number, number]> = {
      ArrowLeft: [-KEY_ANGLE, 0, 1],
      ArrowRight: [KEY_ANGLE, 0, 1],
      ArrowUp: [0, -KEY_ANGLE, 1],
      ArrowDown: [0, KEY_ANGLE, 1],
      "+": [0, 0, KEY_ZOOM],
      "-": [0, 0, 1 / KEY_ZOOM],
    };
    const turn = turns[event.key];
    if (!turn) return;
    event.preventDefault();
    this.fitted = null;
    const offset = this.camera.position.clone().sub(this.controls.target);
    const spherical = new THREE.Spherical().setFromVector3(offset);
    spherical.theta += turn[0];
    spherical.phi = Math.max(0.05, Math.min(Math.PI - 0.05, spherical.phi + turn[1]));
    spherical.radius *= turn[2];
    this.camera.position.copy(this.controls.target).add(offset.setFromSpherical(spherical));
    this.controls.update();
    this.draw();
  }
}

/** Distance of the camera at which a sphere fits into the view; `aspect` is width over height. */
export function distanceToFit(radius: number, aspect: number): number {
  const half = (FIELD_OF_VIEW / 2) * (Math.PI / 180);
  const halfAngle = Math.min(half, Math.atan(Math.tan(half) * aspect));
  return (MARGIN_FACTOR * radius) / Math.sin(halfAngle);
}
