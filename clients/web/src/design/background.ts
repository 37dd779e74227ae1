// What the page does by itself while the target rests: it verifies the shown design, and looks for ways out of a target that is not reached.
import { debounce } from "../base/debounce";
import { Observable } from "../base/observable";
import { judgedDesign } from "./judged";
import type { DesignSession } from "./session";
import type { Verification } from "./verification";
import type { WaysOut } from "./ways_out";

/** Entry of the browser's storage that switches the work off. Tests set it to "off" before the page is loaded. */
export const BACKGROUND_KEY = "supple-background";
/** Time after the last change of target or design. */
export const REST_MS = 1500;

/** Whether the page can be seen. `watch` calls back when that changes. */
export interface Visibility {
  isHidden(): boolean;
  watch(changed: () => void): void;
}

const DOCUMENT: Visibility = {
  isHidden: () => document.hidden,
  watch: (changed) => document.addEventListener("visibilitychange", changed),
};

export class Background {
  /** Whether the user wants the work. */
  readonly isOn = new Observable<boolean>(stored());
  /** Whether the page of the design is open. */
  private isOpen = true;
  private later: ReturnType<typeof setTimeout> | undefined;
  private readonly rest = debounce(() => this.begin(), REST_MS);

  constructor(
    private readonly session: DesignSession,
    private readonly verification: Verification,
    private readonly waysOut: WaysOut,
    private readonly visibility: Visibility = DOCUMENT,
  ) {
    for (const part of [session.state, session.results.shown, session.search.activity]) part.watch(() => this.rest.schedule());
    verification.state.watch(({ kind }) => kind !== "running" && this.rest.schedule());
    waysOut.state.watch(({ kind }) => kind === "none" && this.rest.schedule());
    visibility.watch(() => this.rest.schedule());
  }

  switch(isOn: boolean): void {
    this.isOn.set(isOn);
    try {
      if (isOn) localStorage.removeItem(BACKGROUND_KEY);
      else localStorage.setItem(BACKGROUND_KEY, "off");
    } catch {
      // storage is blocked: the choice lasts as long as the page
    }
    if (isOn) return this.rest.schedule();
    this.rest.cancel();
    this.waysOut.clear();
    this.verification.dropBackground();
  }

  /** Called when the server answers again. */
  reconnected(): void {
    this.waysOut.pauses.clear();
    this.verification.resume();
    this.rest.schedule();
  }

  /** Called when the user opens the design page, and when another one is opened. What has begun goes on. */
  setOpen(isOpen: boolean): void {
    this.isOpen = isOpen;
    if (isOpen) this.rest.schedule();
  }

  private begin(): void {
    const { session, verification, waysOut } = this;
    const shown = session.results.shown.get();
    const rests = session.search.activity.get().kind === "idle" && !session.edited.isBeingChanged && session.results.isCurrent;
    if (!this.isOn.get() || !this.isOpen || this.visibility.isHidden() || !rests || !shown || shown.provisional) return;
    if (["missed", "close"].includes(judgedDesign(session, verification, shown).grade)) waysOut.look();
    if (verification.isWanted) void verification.verify({ background: true });
    this.beginLater();
  }

  /** Begins again after the pauses of what the server was too busy for. */
  private beginLater(): void {
    clearTimeout(this.later);
    const pauses = [this.verification.pauses.remaining, this.waysOut.pauses.remaining].filter((pause) => pause > 0);
    if (pauses.length > 0) this.later = setTimeout(() => this.begin(), Math.min(...pauses));
  }
}

function stored(): boolean {
  try {
    return localStorage.getItem(BACKGROUND_KEY) !== "off";
  } catch {
    return true;
  }
}
