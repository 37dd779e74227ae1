// The judgements of what a session shows: by simulation wherever there is one.
import type { DesignSession } from "./session";
import { modelError, sameRequirements, type TargetResponse } from "./shown";
import { type JudgedEvidence, judgeAll, type Judgement } from "./verdict";
import type { Verification } from "./verification";

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
  const all = session.results.all.get().filter((shown): shown is TargetResponse => shown !== null && sameRequirements(shown, inSight));
  return judgedResponses(session, verification, all.length > 0 ? all : [inSight]);
}
