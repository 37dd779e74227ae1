// The targets of the design as tabs above the plot: one is in sight and edited, all of them are asked for.
import { percent } from "../base/format";
import { Tabs } from "../base/tabs";
import type { DesignSession } from "./session";
import { MOST_NAME, MOST_TARGETS, sameTargets, targetsOf, targetWords } from "./target_list";

/** `panel` shows the target in sight. */
export function targetTabs(session: DesignSession, panel: HTMLElement): HTMLElement {
  const tabs = new Tabs(
    { label: "Targets of the design", noun: "target", addTitle: "Add a further target of the same design", longestName: MOST_NAME, panel },
    { select: (at) => session.select(at), add: () => void session.add(), rename: (name) => session.rename(name), remove: (at) => session.remove(at) });

  function show(): void {
    const state = session.state.get();
    const targets = targetsOf(state);
    const all = session.all.get();
    const shown = targets.map((target, k) => {
      const found = all[k];
      const detail = found && targets.length > 1 && sameTargets(found.targets, targets) ? percent(found.deviation) : "";
      return { words: targetWords(target), plainWords: targetWords({ ...target, name: "" }), detail };
    });
    tabs.show(shown, state.at, targets.length < MOST_TARGETS && state.points.length > 0);
  }

  for (const part of [session.state, session.all]) part.watch(show);
  return tabs.element;
}
