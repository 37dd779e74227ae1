// Adds the family to the server, opens drawings of tiles as families, and removes families that were added.
import { Observable } from "../base/observable";
import { type Client, ConnectionLost, explain, Problem } from "../contract/client";
import { inWords } from "../contract/places";
import type { AddedFamily, FamilyDefinition, FamilyUpload } from "../contract/types";
import { DefinitionError, readDefinitionText } from "./definition_reader";
import type { FamilySession } from "./session";

/** A drawing that was opened and whose type has to be chosen. */
export interface OpenedDrawing {
  readonly name: string;
  readonly svg: string;
}

/** What has to be known of a drawing to make a family of it. */
export interface DrawingChoice {
  /** Number of the isohedral type. */
  readonly type: number;
  readonly id: string;
  readonly shapeParameters: boolean;
}

export class Library {
  readonly isBusy = new Observable(false);
  /** The outcome of the last action, as a sentence; empty before any. */
  readonly outcome = new Observable<{ readonly sentence: string; readonly isFault: boolean }>({ sentence: "", isFault: false });
  readonly drawing = new Observable<OpenedDrawing | null>(null);

  constructor(private readonly session: FamilySession, private readonly client: Client) {}

  /** Opens a file with a definition or with a drawing of a tile. Returns why it cannot be used, or "". */
  open(text: string, name: string): string {
    if (/\.svg$/i.test(name) || /^\s*</.test(text)) {
      this.drawing.set({ name, svg: text });
      return "";
    }
    try {
      this.session.open(readDefinitionText(text));
      return "";
    } catch (error) {
      if (error instanceof DefinitionError) return error.message;
      throw error;
    }
  }

  /** Makes a family of the opened drawing, which the server adds under a name. */
  async addDrawing({ type, id, shapeParameters }: DrawingChoice): Promise<void> {
    const drawing = this.drawing.get();
    if (!drawing) return;
    const name = `IH${String(type).padStart(2, "0")}`;
    const added = await this.send({ svg: drawing.svg, type: name, id, description: `From the drawing ${drawing.name}`.slice(0, 500), shape_parameters: shapeParameters });
    if (!added?.family.definition) return;
    this.drawing.set(null);
    this.session.open(added.family.definition);
    this.outcome.set({ sentence: addedWords(added), isFault: false });
  }

  /** Adds the present family. With `replaces`, the one that was added under its name before is removed. */
  async add(replaces = false): Promise<void> {
    const { definition } = this.session.state.get();
    if (replaces && !(await this.delete(definition.id))) return;
    const added = await this.send({ definition });
    if (!added) return;
    if (added.family.definition && this.session.state.get().definition === definition) this.session.adopt(added.family.definition);
    this.outcome.set({ sentence: addedWords(added), isFault: false });
  }

  /** Removes the family that was added under the present name. */
  async remove(): Promise<void> {
    const { id } = this.session.state.get().definition;
    if (await this.delete(id)) this.outcome.set({ sentence: `${id} is removed. It stays here until you leave it.`, isFault: false });
  }

  private async send(upload: FamilyUpload): Promise<AddedFamily | null> {
    return this.attempt(async () => {
      const response = await this.client.postResponse("/v1/families", upload);
      const added = (await response.json()) as AddedFamily;
      await this.session.loadFamilies();
      return added;
    });
  }

  private async delete(id: string): Promise<boolean> {
    const removed = await this.attempt(async () => {
      await this.client.send("DELETE", `/v1/families/${id}`);
      await this.session.loadFamilies();
      return true;
    });
    return removed ?? false;
  }

  /** Runs an action, and tells why it has failed. Null if it has. */
  private async attempt<Value>(action: () => Promise<Value>): Promise<Value | null> {
    this.isBusy.set(true);
    try {
      return await action();
    } catch (error) {
      this.outcome.set({ sentence: refusalWords(error), isFault: true });
      return null;
    } finally {
      this.isBusy.set(false);
    }
  }
}

function addedWords({ family, warnings }: AddedFamily): string {
  const places = warnings.length === 0 ? "" : ` ${warnings.length === 1 ? "One place within its bounds is" : `${warnings.length} places within its bounds are`} to be avoided.`;
  return `${family.id} is on the server.${places}`;
}

function refusalWords(error: unknown): string {
  if (error instanceof ConnectionLost) return "The server does not answer; try again when it does.";
  if (error instanceof Problem && error.code === "family.in_use") return inWords(error.document.detail);
  return explain(error);
}

/** Why a name cannot be that of a family of one's own; empty if it can. `shipped`: names of families that come with the server. */
export function nameFault(id: string, shipped: readonly string[]): string {
  if (!/^[A-Za-z0-9_-]{1,32}$/.test(id)) return "A name has 1 to 32 letters, digits, “_” or “-”.";
  if (id.toLowerCase() === "any") return "“any” means all families.";
  const taken = shipped.find((name) => name.toLowerCase() === id.toLowerCase());
  return taken ? `${taken} comes with the server: choose another name.` : "";
}

/** A definition under a name that no family of the server has. */
export function withFreeName(definition: FamilyDefinition, taken: readonly string[]): FamilyDefinition {
  const used = new Set(taken.map((name) => name.toLowerCase()));
  for (let k = 2; used.has(definition.id.toLowerCase()) && k < 1000; ++k) {
    const id = `my-${definition.id.toLowerCase().replace(/^my-/, "").replace(/-\d+$/, "")}-${k}`.slice(0, 32);
    if (!used.has(id)) return { ...definition, id };
  }
  return definition;
}
