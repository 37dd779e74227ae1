// Starts the editor: the frame around the pages, and which of them is in sight.
import "./styles/index.css";
import { Account } from "./account";
import { liveRegion } from "./base/announce";
import { startTheme } from "./base/theme";
import { Client } from "./contract/client";
import { Connection } from "./contract/connection";
import { frame } from "./frame";
import type { Page } from "./page";
import { type PageEntry, PAGES } from "./pages";

startTheme();

const connection = new Connection(async () => {
  try {
    return (await fetch("/healthz", { cache: "no-store" })).ok;
  } catch {
    return false;
  }
});
const account = new Account();
const client = new Client("", (answered) => connection.report(answered), () => account.ask());
const { element, main, select } = frame(connection, account.element);
document.body.append(element, liveRegion, account.dialog);
void account.look();

const made = new Map<string, Page>();
let current: Page | null = null;

/** "#/design?text" is the page "design" with the text of its link. */
function address(): { entry: PageEntry; text: string } {
  const [id, ...text] = location.hash.replace(/^#\/?/, "").split("?");
  return { entry: PAGES.find((page) => page.id === id) ?? PAGES[0], text: text.join("?") };
}

async function pageOf(entry: PageEntry): Promise<Page> {
  const known = made.get(entry.id);
  if (known) return known;
  const make = await entry.load();
  const link = {
    read: () => (address().entry === entry ? address().text : ""),
    write: (text: string) => {
      if (address().entry === entry) history.replaceState(null, "", `#/${entry.id}${text && `?${text}`}`);
    },
  };
  const page = made.get(entry.id) ?? make({ client, link });
  made.set(entry.id, page);
  return page;
}

async function show(): Promise<void> {
  const { entry, text } = address();
  const page = await pageOf(entry);
  if (address().entry !== entry) return; // another one was asked for meanwhile
  if (page !== current) {
    current?.close();
    current = page;
    main.replaceChildren(page.element);
    select(entry);
  }
  await page.open(text);
}

addEventListener("hashchange", () => void show());
connection.lost.watch((lost) => {
  if (!lost) for (const page of made.values()) page.reconnected();
});
void show();
