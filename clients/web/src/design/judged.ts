// The judgements of what a session shows: by simulation wherever there is one.
import type { DesignSession } from "./session";
import { type Freshness, modelError, sameRequirements, sameTilingDesign, type TargetResponse } from "./shown";
import { type JudgedEvidence, judgeAll, type Judgement } from "./verdict";
import { type Grade, gradeWords } from "./verdict_words";
import type { Verification } from "./verification";

/** The judgement of a design whose responses to some of its targets are not known, for example since its search was stopped. */
const PARTLY_KNOWN: Judgement = {
  grade: "unknown",
  source: "model",
  deviation: null,
  isWithinError: false,
  words: gradeWords("unknown"),
  sentence: "Not all targets of this design are known yet.",
  bound: "",
};

function evidenceOf(session: DesignSession, verification: Verification, shown: TargetResponse): JudgedEvidence {
  return { shown, error: modelError(session.catalogue.model(shown.found.family), shown), simulated: verification.curveOf(shown) };
}

/** The judgement of the response to one target. */
export function judgedResponse(session: DesignSession, verification: Verification, shown: TargetResponse): Judgement {
  return judgedResponses(session, verification, [shown]);
}

/** The judgement of a design by its responses to all of its targets. */
export function judgedResponses(session: DesignSession, verification: Verification, all: readonly TargetResponse[]): Judgement {
  return judgeAll(all.map((shown) => evidenceOf(session, verification, shown)));
}

/** The judgement of the design of a response: that of the target that it meets worst. */
export function judgedDesign(session: DesignSession, verification: Verification, inSight: TargetResponse): Judgement {
  const isOfDesign = (shown: TargetResponse): boolean => sameRequirements(shown, inSight) && sameTilingDesign(shown.found, inSight.found);
  const all = session.results.all.get().filter((shown): shown is TargetResponse => shown !== null && isOfDesign(shown));
  if (all.length < inSight.targets.length) return inSight.targets.length === 1 ? judgedResponse(session, verification, inSight) : PARTLY_KNOWN;
  return judgedResponses(session, verification, all);
}

/** The grade that colours a judgement: none for a response that does not belong to the present state. */
export function shownGrade(judgement: Judgement | null, fresh: Freshness): Grade | "" {
  return judgement && fresh === "current" ? judgement.grade : "";
}
