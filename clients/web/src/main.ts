// Starts the editor: makes the frame, and shows the page that the address names.
import "./styles/index.css";
import { Account } from "./account";
import { liveRegion } from "./base/announce";
import { startTheme } from "./base/theme";
import { Bills } from "./base/bills";
import { watchWriting } from "./base/writing";
import { BillMenu } from "./bill_menu";
import { Client, isServing } from "./contract/client";
import { Connection } from "./contract/connection";
import { frame } from "./frame";
import type { Page } from "./page";
import { type PageEntry, PAGES } from "./pages";

startTheme();
watchWriting(document);

const connection = new Connection(isServing);
const account = new Account();
const bill = new BillMenu();
const { element, main, select } = frame(connection, account.element, bill.element);
document.body.append(element, liveRegion, account.dialog);
void account.checkSession();

interface OpenedPage {
  readonly page: Page;
  readonly bills: Bills;
}

const openedPages = new Map<string, OpenedPage>();
let current: Page | null = null;

/** The page that the address names, and the text of its link: "#/design?text" is the page "design" with "text". */
function address(): { entry: PageEntry; text: string } {
  const [id, ...text] = location.hash.replace(/^#\/?/, "").split("?");
  return { entry: PAGES.find((page) => page.id === id) ?? PAGES[0], text: text.join("?") };
}

async function pageOf(entry: PageEntry): Promise<OpenedPage> {
  const cached = openedPages.get(entry.id);
  if (cached) return cached;
  const make = await entry.load();
  const link = {
    read: () => (address().entry === entry ? address().text : ""),
    write: (text: string) => {
      if (address().entry === entry) history.replaceState(null, "", `#/${entry.id}${text && `?${text}`}`);
    },
  };
  const concurrent = openedPages.get(entry.id); // a second call that began before the page was loaded
  if (concurrent) return concurrent;
  const bills = new Bills();
  const client = new Client("", (answered) => connection.report(answered), () => account.ask(), bills.record);
  const page = { page: make({ client, link }), bills };
  openedPages.set(entry.id, page);
  return page;
}

async function show(): Promise<void> {
  const { entry, text } = address();
  const { page, bills } = await pageOf(entry);
  if (address().entry !== entry) return; // the address has changed while the page was loaded
  if (page !== current) {
    current?.close();
    current = page;
    main.replaceChildren(page.element);
    select(entry);
    bill.show(bills);
  }
  await page.open(text);
}

addEventListener("hashchange", () => void show());
connection.lost.watch((lost) => {
  if (!lost) { for (const { page } of openedPages.values()) page.reconnected(); }
});
void show();
