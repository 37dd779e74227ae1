// The pages of the editor, in the order of its navigation. Each is loaded when it is first opened.
import type { Page, PageContext } from "./page";

export interface PageEntry {
  /** First part of the address after "#/". */
  id: string;
  title: string;
  load: () => Promise<(context: PageContext) => Page>;
}

export const PAGES: readonly PageEntry[] = [
  { id: "design", title: "Design", load: async () => (await import("./design/page")).designPage },
  { id: "family", title: "Family", load: async () => (await import("./family/page")).familyPage },
  { id: "weave", title: "Weave", load: async () => (await import("./weave/page")).weavePage },
  { id: "mesh", title: "Mesh", load: async () => (await import("./mesh/page")).meshPage },
];
