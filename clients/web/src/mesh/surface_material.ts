// The shaders of the surface: plain, coloured by distance with isolines, or with a colour for each face.
import * as THREE from "three";
import { RAMPS } from "../base/ramps";

/** Colours of distances, from near to far. */
export const RAMP = RAMPS.sea;

/** The shader function for the lighting of a surface: lit(colour, normal, position in camera coordinates). */
export const lightOfSurface = /* glsl */ `
  vec3 lit(vec3 base, vec3 towards, vec3 view) {
    vec3 normal = normalize(gl_FrontFacing ? towards : -towards);
    vec3 toEye = normalize(-view);
    float light = 0.62 + 0.33 * max(dot(normal, normalize(vec3(0.4, 0.7, 0.9))), 0.0) + 0.1 * normal.y;
    float gloss = 0.12 * pow(max(dot(normal, normalize(toEye + vec3(0.3, 0.6, 0.6))), 0.0), 40.0);
    return base * light + gloss;
  }`;

const vertexShader = /* glsl */ `
  attribute float distance0;
  uniform vec3 middle;
  varying float vLinear;
  varying vec3 vPlace;
  varying vec3 vNormal;
  varying vec3 vView;
  void main() {
    // The squared distance from a point that sees the whole face is |x|^2 plus a linear function on the face. So is the one along the surface, of
    // the unfolded source: the linear part is interpolated, and the square is added for each pixel, so that isolines are arcs within faces.
    vPlace = position - middle;
    vLinear = distance0 < 0.0 ? -1e30 : distance0 * distance0 - dot(vPlace, vPlace);
    vNormal = normalMatrix * normal;
    vec4 view = modelViewMatrix * vec4(position, 1.0);
    vView = view.xyz;
    gl_Position = projectionMatrix * view;
  }`;

const facesVertexShader = /* glsl */ `
  attribute vec3 colour;
  varying vec3 vColour;
  varying vec3 vNormal;
  varying vec3 vView;
  void main() {
    vColour = colour;
    vNormal = normalMatrix * normal;
    vec4 view = modelViewMatrix * vec4(position, 1.0);
    vView = view.xyz;
    gl_Position = projectionMatrix * view;
  }`;

const facesFragmentShader = /* glsl */ `
  varying vec3 vColour;
  varying vec3 vNormal;
  varying vec3 vView;
  ${lightOfSurface}
  void main() {
    gl_FragColor = vec4(lit(vColour, vNormal, vView), 1.0);
    #include <colorspace_fragment>
  }`;

/** Depth offset of the surface away from the camera, so that lines on it are visible. */
const DEPTH_OFFSET = { polygonOffset: true, polygonOffsetFactor: 1.5, polygonOffsetUnits: 2 };

/** The material of faces with a colour for each. */
export function facesMaterial(offset: THREE.MaterialParameters = DEPTH_OFFSET): THREE.ShaderMaterial {
  return new THREE.ShaderMaterial({ vertexShader: facesVertexShader, fragmentShader: facesFragmentShader, side: THREE.DoubleSide, ...offset });
}

const fragmentShader = /* glsl */ `
  uniform vec3 plain;
  uniform vec3 ramp[5];
  uniform float largest;
  uniform float spacing;
  varying float vLinear;
  varying vec3 vPlace;
  varying vec3 vNormal;
  varying vec3 vView;
  ${lightOfSurface}
  void main() {
    vec3 base = plain;
    if (largest > 0.0 && vLinear > -1e20) {
      float along = sqrt(max(vLinear + dot(vPlace, vPlace), 0.0));
      float place = clamp(along / largest, 0.0, 1.0) * 4.0;
      int k = int(min(floor(place), 3.0));
      base = mix(ramp[k], ramp[k + 1], place - float(k));
      float turn = along / spacing;
      float away = abs(fract(turn - 0.5) - 0.5) / fwidth(turn);
      base = mix(base * 0.35, base, smoothstep(0.4, 1.4, away));
    }
    gl_FragColor = vec4(lit(base, vNormal, vView), 1.0);
    #include <colorspace_fragment>
  }`;

export function surfaceMaterial(): THREE.ShaderMaterial {
  return new THREE.ShaderMaterial({
    vertexShader,
    fragmentShader,
    side: THREE.DoubleSide,
    ...DEPTH_OFFSET,
    uniforms: {
      plain: { value: new THREE.Color(0.66, 0.7, 0.73) },
      ramp: { value: RAMP.map((rgb) => new THREE.Vector3(...rgb)) },
      largest: { value: 0 },
      middle: { value: new THREE.Vector3() },
      spacing: { value: 1 },
    },
  });
}
