// The interface of a page of the editor. A new page needs a folder with a function that makes it, and a line in pages.ts.
import type { Client } from "./contract/client";

/** The part of the address that belongs to a page: the text after its name. */
export interface PageLink {
  read(): string;
  write(text: string): void;
}

export interface PageContext {
  client: Client;
  link: PageLink;
}

export interface Page {
  readonly element: HTMLElement;
  /** Called when the page becomes visible, with the text of its link. */
  open(text: string): void | Promise<void>;
  close(): void;
  /**
   * Shows the result of a job that was begun under the present link, or goes on with it: requests what the job computes, which is then not
   * computed again. `path`: that of the job's request, `text`: the link.
   */
  resume?(path: string, text: string): void | Promise<void>;
  /** Called when the server answers again after a lost connection. */
  reconnected(): void;
}
