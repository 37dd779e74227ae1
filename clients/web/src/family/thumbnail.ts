// A small picture of a tiling, for lists of types and families.
import { svg, uniqueId } from "../base/dom";
import { defaultsOf } from "./state";
import { cameraOn, copiesOf, isFiniteTiling, outlinesPath, shiftOf, toPixels } from "./tiling_drawing";
import { type DrawnFamily, tilingAt } from "./tiling";

const SIDE = 64;
/** Part of the picture that a tile takes up. */
const FILLED = 0.34;

export function thumbnail(family: DrawnFamily): SVGSVGElement {
  const tiling = tilingAt(family, defaultsOf(family.definition));
  const picture = svg("svg", { class: "tile-picture", viewBox: `0 0 ${SIDE} ${SIDE}`, "aria-hidden": "true" });
  if (!isFiniteTiling(tiling)) return picture;
  const camera = cameraOn(tiling, SIDE, SIDE, FILLED);
  const cell = svg("path", { id: uniqueId("cell"), d: outlinesPath(tiling.tiles, camera.scale) });
  const [x, y] = toPixels(camera, [0, 0]);
  const copies = copiesOf(tiling, camera).map((copy) => {
    const [dx, dy] = shiftOf(tiling, copy, camera.scale);
    return svg("use", { href: `#${cell.id}`, x: dx, y: dy });
  });
  picture.append(svg("defs", {}, cell), svg("g", { transform: `translate(${x},${y})` }, ...copies));
  return picture;
}
