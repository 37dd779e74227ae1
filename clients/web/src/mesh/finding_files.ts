// Results on a surface as files: paths as polylines, distances at the vertices.
import type { MeshData, Vector } from "./mesh_data";

const number = (value: number): string => String(Number(value.toPrecision(12)));
const place = (at: readonly number[]): string => at.map(number).join(" ");

/** OBJ with each path as a polyline. */
export function pathsObj(paths: readonly (readonly Vector[])[]): string {
  const lines = ["# shortest paths, one polyline each"];
  let count = 0;
  paths.forEach((path, k) => {
    lines.push(`o path_${k + 1}`, ...path.map((at) => `v ${place(at)}`), `l ${path.map((_, n) => count + n + 1).join(" ")}`);
    count += path.length;
  });
  return `${lines.join("\n")}\n`;
}

/** CSV with the points of each path and their distance along the path from its start, in mesh units. */
export function pathsCsv(paths: readonly (readonly Vector[])[]): string {
  const rows = ["path,point,x,y,z,length_from_start"];
  paths.forEach((path, k) => {
    let length = 0;
    path.forEach((at, n) => {
      if (n > 0) length += Math.hypot(...at.map((value, axis) => value - path[n - 1][axis]));
      rows.push([k + 1, n, ...at.map(number), number(length)].join(","));
    });
  });
  return `${rows.join("\n")}\n`;
}

/** PLY of the mesh with a distance at each vertex. Unreachable vertices have -1, because PLY has no missing values. */
export function fieldPly({ positions, faces }: MeshData, distances: readonly number[]): string {
  const lines = [
    "ply",
    "format ascii 1.0",
    "comment distance in mesh units, -1 where there is no path",
    `element vertex ${positions.length / 3}`,
    "property double x",
    "property double y",
    "property double z",
    "property double distance",
    `element face ${faces.length / 3}`,
    "property list uchar int vertex_indices",
    "end_header",
  ];
  distances.forEach((distance, k) => lines.push(`${place([...positions.subarray(3 * k, 3 * k + 3)])} ${number(distance)}`));
  for (let k = 0; k < faces.length; k += 3) lines.push(`3 ${faces[k]} ${faces[k + 1]} ${faces[k + 2]}`);
  return `${lines.join("\n")}\n`;
}

export function fieldCsv({ positions }: MeshData, distances: readonly number[]): string {
  const rows = distances.map((distance, k) => [k, ...[...positions.subarray(3 * k, 3 * k + 3)].map(number), distance < 0 ? "" : number(distance)].join(","));
  return `${["vertex,x,y,z,distance", ...rows].join("\n")}\n`;
}
