// The tabs of the targets above the plot. The selected target is shown and edited; searches use all of them.
import { percent } from "../base/format";
import { Tabs } from "../base/tabs";
import { judgedResponse } from "./judged";
import type { DesignSession } from "./session";
import { MAX_NAME_LENGTH, MAX_TARGETS, sameTargets, targetsOf, targetWords } from "./target_list";
import type { Judgement } from "./verdict";
import type { Verification } from "./verification";

/** `panel` shows the selected target. */
export function targetTabs(session: DesignSession, verification: Verification, panel: HTMLElement): HTMLElement {
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
      const detail = found && targets.length > 1 && sameTargets(found.targets, targets) ? tabWords(judgedResponse(session, verification, found), found.deviation) : "";
      return { words: targetWords(target), defaultWords: targetWords({ ...target, name: "" }), detail };
    });
    tabs.show(shown, state.at, targets.length < MAX_TARGETS && state.points.length > 0);
  }

  for (const part of [session.state, session.results.all, verification.simulations.list]) part.watch(show);
  return tabs.element;
}

/** The simulated deviation where there is one, otherwise that of the model. */
function tabWords({ source, deviation }: Judgement, byModel: number): string {
  return percent(source === "simulation" && deviation !== null ? deviation : byModel);
}
