// Starts the editor: the frame around the pages, and which of them is in sight.
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
void account.look();

interface Made {
  readonly page: Page;
  readonly bills: Bills;
}

const made = new Map<string, Made>();
let current: Page | null = null;

/** "#/design?text" is the page "design" with the text of its link. */
function address(): { entry: PageEntry; text: string } {
  const [id, ...text] = location.hash.replace(/^#\/?/, "").split("?");
  return { entry: PAGES.find((page) => page.id === id) ?? PAGES[0], text: text.join("?") };
}

async function pageOf(entry: PageEntry): Promise<Made> {
  const known = made.get(entry.id);
  if (known) return known;
  const make = await entry.load();
  const link = {
    read: () => (address().entry === entry ? address().text : ""),
    write: (text: string) => {
      if (address().entry === entry) history.replaceState(null, "", `#/${entry.id}${text && `?${text}`}`);
    },
  };
  const second = made.get(entry.id); // asked for twice before it was loaded
  if (second) return second;
  const bills = new Bills();
  const client = new Client("", (answered) => connection.report(answered), () => account.ask(), bills.hear);
  const page = { page: make({ client, link }), bills };
  made.set(entry.id, page);
  return page;
}

async function show(): Promise<void> {
  const { entry, text } = address();
  const { page, bills } = await pageOf(entry);
  if (address().entry !== entry) return; // another one was asked for meanwhile
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
  if (!lost) for (const { page } of made.values()) page.reconnected();
});
void show();
