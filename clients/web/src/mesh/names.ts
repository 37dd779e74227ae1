// How a person's files were called: the server knows meshes by what they hold, this browser remembers the names.

const KEY = "supple-mesh-names";
const MOST_NAMES = 100;

function kept(): Record<string, string> {
  try {
    const names: unknown = JSON.parse(localStorage.getItem(KEY) ?? "{}");
    return typeof names === "object" && names !== null ? (names as Record<string, string>) : {};
  } catch {
    return {}; // storage is refused, or something else wrote there
  }
}

/** Null where the mesh came from elsewhere. */
export function nameOf(mesh: string): string | null {
  const name = kept()[mesh];
  return typeof name === "string" ? name : null;
}

export function keepName(mesh: string, name: string): void {
  const { [mesh]: _, ...others } = kept();
  const entries = [...Object.entries(others), [mesh, name.slice(0, 80)] as const].slice(-MOST_NAMES);
  try {
    localStorage.setItem(KEY, JSON.stringify(Object.fromEntries(entries)));
  } catch {
    // the mesh stays known by its number
  }
}

/** The beginning of the names of files about a mesh. */
export function fileStem(mesh: string): string {
  const name = nameOf(mesh)?.replace(/\.[A-Za-z0-9]{1,5}$/, "").replace(/[^A-Za-z0-9._-]+/g, "-").replace(/^[-.]+|-+$/g, "");
  return name || `mesh-${mesh.slice(0, 6)}`;
}
