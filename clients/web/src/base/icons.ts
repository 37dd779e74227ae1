// Icons of buttons: line drawings of 20 x 20 units. They are hidden from screen readers, so that each button needs text or a label.
import { svg } from "./dom";

const PATHS = {
  undo: "M7 4 3 8l4 4M3 8h8a5 5 0 0 1 0 10H8",
  redo: "M13 4l4 4-4 4M17 8H9a5 5 0 0 0 0 10h3",
  plus: "M10 4v12M4 10h12",
  minus: "M4 10h12",
  pin: "M7 3h6l-1 5 3 3H5l3-3-1-5ZM10 11v6",
  link: "M8 12l4-4M9 6l2-2a3.5 3.5 0 0 1 5 5l-2 2M11 14l-2 2a3.5 3.5 0 0 1-5-5l2-2",
  download: "M10 3v10M6 9l4 4 4-4M4 17h12",
  lock: "M6 9V7a4 4 0 0 1 8 0v2M5 9h10v8H5Z",
  unlock: "M6 9V7a4 4 0 0 1 7.5-2M5 9h10v8H5Z",
  close: "M5 5l10 10M15 5 5 15",
  check: "M4 10.5l4 4 8-9",
  restore: "M4 10a6 6 0 1 0 2-4.5M4 3v4h4",
  sun: "M10 6.5a3.5 3.5 0 1 0 0 7 3.5 3.5 0 0 0 0-7ZM10 1.5v2M10 16.5v2M1.5 10h2M16.5 10h2M4 4l1.4 1.4M14.6 14.6 16 16M16 4l-1.4 1.4M5.4 14.6 4 16",
  moon: "M16 12.5A7 7 0 0 1 7.5 4a7 7 0 1 0 8.5 8.5Z",
  half: "M10 3a7 7 0 1 0 0 14 7 7 0 0 0 0-14ZM10 3v14",
  overlay: "M3 13c4 0 4-7 7-7s3 4 7 2M3 16c5 0 5-4 8-4s3 2 6 1",
  play: "M6 4l10 6-10 6Z",
  pause: "M7 4v12M13 4v12",
  fit: "M3 7V3h4M13 3h4v4M17 13v4h-4M7 17H3v-4M7 10h6M10 7v6",
  code: "M7 5 2 10l5 5M13 5l5 5-5 5",
  clock: "M10 3a7 7 0 1 0 0 14 7 7 0 0 0 0-14ZM10 6v4l3 2",
  pencil: "M4 16l1-4L14 3l3 3-9 9-4 1ZM12 5l3 3",
  printer: "M3 3h14M6 3v3l2 3h4l2-3V3M10 9v3M3 17h14M5 14.5h10",
  list: "M7 5h10M7 10h10M7 15h10M3 5h.5M3 10h.5M3 15h.5",
  copy: "M7 7h9v9H7ZM4 13V4h9",
  target: "M3 15c4 0 4-9 7-9s3 6 7 4",
} as const;

export type IconName = keyof typeof PATHS;

export function icon(name: IconName): SVGSVGElement {
  return svg("svg", { class: "icon", viewBox: "0 0 20 20", "aria-hidden": "true" }, svg("path", { d: PATHS[name] }));
}
