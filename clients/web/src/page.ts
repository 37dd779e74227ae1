// What a page of the editor is. A further one is a folder with a function that makes one, and a line in pages.ts.
import type { Client } from "./contract/client";

/** The part of the address that belongs to a page: what follows its name. */
export interface PageLink {
  read(): string;
  write(text: string): void;
}

export interface Surroundings {
  client: Client;
  link: PageLink;
}

export interface Page {
  readonly element: HTMLElement;
  /** The page comes into sight, with the text of its link. */
  open(text: string): void | Promise<void>;
  close(): void;
  /** The server answers again. */
  reconnected(): void;
}
