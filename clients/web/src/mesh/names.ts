// The names of uploaded files. The server identifies meshes by their content, so that the browser stores the names.

const KEY = "supple-mesh-names";
const MAX_NAMES = 100;

function storedNames(): Record<string, string> {
  try {
    const names: unknown = JSON.parse(localStorage.getItem(KEY) ?? "{}");
    return typeof names === "object" && names !== null ? (names as Record<string, string>) : {};
  } catch {
    return {}; // storage is blocked, or its text is invalid
  }
}

/** The name of a mesh; null if this browser did not upload it. */
export function nameOf(mesh: string): string | null {
  const name = storedNames()[mesh];
  return typeof name === "string" ? name : null;
}

export function storeName(mesh: string, name: string): void {
  const { [mesh]: _, ...others } = storedNames();
  const entries = [...Object.entries(others), [mesh, name.slice(0, 80)] as const].slice(-MAX_NAMES);
  try {
    localStorage.setItem(KEY, JSON.stringify(Object.fromEntries(entries)));
  } catch {
    // storage is blocked: the mesh is listed without a name
  }
}

/** Stem of the names of files about a mesh. */
export function fileStem(mesh: string): string {
  const name = nameOf(mesh)?.replace(/\.[A-Za-z0-9]{1,5}$/, "").replace(/[^A-Za-z0-9._-]+/g, "-").replace(/^[-.]+|-+$/g, "");
  return name || `mesh-${mesh.slice(0, 6)}`;
}
