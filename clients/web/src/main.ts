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
import { JobTray } from "./jobs/job_tray";
import { JobWatch } from "./jobs/job_watch";
import { type KeptJob, KeptJobs } from "./jobs/kept_jobs";
import type { Page } from "./page";
import { type PageEntry, PAGES } from "./pages";

startTheme();
watchWriting(document);

const connection = new Connection(isServing);
const account = new Account();
const bill = new BillMenu();
const jobs = new KeptJobs();
const jobWatch = new JobWatch(new Client("", (answered) => connection.report(answered), () => account.ask()), jobs);
const tray = new JobTray(jobs, jobWatch, connection, openJob, ({ page }) => page === address().entry.id);
const { element, main, select } = frame(connection, account.element, bill.element, tray.element);
document.body.append(element, liveRegion, account.dialog);
void account.checkSession();

interface OpenedPage {
  readonly page: Page;
  readonly bills: Bills;
}

const openedPages = new Map<string, OpenedPage>();
let current: Page | null = null;
/** The job whose result the next page that is shown is to show. */
let opening: KeptJob | null = null;

/** The page that the address names, and the text of its link: "#/design?text" is the page "design" with "text". */
function address(): { entry: PageEntry; text: string } {
  const [id, ...text] = location.hash.replace(/^#\/?/, "").split("?");
  return { entry: PAGES.find((page) => page.id === id) ?? PAGES[0], text: text.join("?") };
}

async function pageOf(entry: PageEntry): Promise<OpenedPage> {
  const cached = openedPages.get(entry.id);
  if (cached) return cached;
  const make = await entry.load();
  let written = "";
  const link = {
    read: () => (address().entry === entry ? address().text : ""),
    write: (text: string) => {
      written = text;
      if (address().entry === entry) history.replaceState(null, "", `#/${entry.id}${text && `?${text}`}`);
    },
  };
  const concurrent = openedPages.get(entry.id); // a second call that began before the page was loaded
  if (concurrent) return concurrent;
  const bills = new Bills();
  const client = new Client("", (answered) => connection.report(answered), () => account.ask(), bills.record, jobs.of(() => ({ page: entry.id, link: link.read() || written })));
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
  const job = opening?.page === entry.id ? opening : null;
  opening = null;
  await page.open(text);
  // What the page follows already goes on.
  if (job && !jobs.isFollowed(job.id)) await page.resume?.(job.path, job.link);
}

/** Shows the result of a job on its page, or how far it is. */
function openJob(job: KeptJob): void {
  opening = job;
  jobs.want(job.id);
  const hash = `#/${job.page}${job.link && `?${job.link}`}`;
  if (location.hash === hash) void show();
  else location.hash = hash; // the page is shown by the listener below
}

addEventListener("hashchange", () => void show());
connection.lost.watch((lost) => {
  if (lost) return;
  for (const { page } of openedPages.values()) page.reconnected();
  void jobWatch.begin();
});
void show();
