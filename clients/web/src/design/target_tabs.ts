// The tabs of the targets above the plot. The selected target is shown and edited; searches use all of them.
import { percent } from "../base/format";
import { Tabs } from "../base/tabs";
import type { DesignSession } from "./session";
import { MAX_NAME_LENGTH, MAX_TARGETS, sameTargets, targetsOf, targetWords } from "./target_list";

/** `panel` shows the selected target. */
export function targetTabs(session: DesignSession, panel: HTMLElement): HTMLElement {
  const tabs = new Tabs(
    { label: "Targets of the design", noun: "target", addTitle: "Add a further target of the same design", maxNameLength: MAX_NAME_LENGTH, panel },
    {
      select: (at) => session.targetEdits.select(at),
      add: () => void session.targetEdits.add(),
      rename: (name) => session.targetEdits.rename(name),
      remove: (at) => session.targetEdits.remove(at),
    },
  );

  function show(): void {
    const state = session.state.get();
    const targets = targetsOf(state);
    const all = session.results.all.get();
    const shown = targets.map((target, k) => {
      const found = all[k];
      const detail = found && targets.length > 1 && sameTargets(found.targets, targets) ? percent(found.deviation) : "";
      return { words: targetWords(target), defaultWords: targetWords({ ...target, name: "" }), detail };
    });
    tabs.show(shown, state.at, targets.length < MAX_TARGETS && state.points.length > 0);
  }

  for (const part of [session.state, session.results.all]) part.watch(show);
  return tabs.element;
}
