// The card of the training: its budget, the estimate, the running training with the errors that it has reached, and the network at its end.
import { announce } from "../base/announce";
import { button, Select, Slider } from "../base/controls";
import { ConvergencePlot } from "../base/convergence_plot";
import { h, replace, writeText } from "../base/dom";
import { percent } from "../base/format";
import type { Observable } from "../base/observable";
import { ProgressRow } from "../base/progress_row";
import type { Activity, WorkInWords } from "../contract/runner";
import type { FamilySession } from "./session";
import { CORE_HOURS, ERRORS } from "./state";
import { type TrainingRun, type TrainingSession, trainsNoNetworks } from "./training_session";
import { ERROR_WORDS, outcomeSentence, planSentence, runWords } from "./training_words";

export function trainingCard(session: FamilySession, training: TrainingSession): HTMLElement {
  const hours = new Slider({
    label: "Core time",
    lower: CORE_HOURS[0],
    upper: CORE_HOURS[1],
    step: 0.25,
    digits: 2,
    unit: "h",
    changed: (coreHours, done) => {
      session.preview({ coreHours });
      if (done) session.finish();
    },
  });
  const goal = new Select<string>("End earlier at a mean error of", ERRORS.map((error) => ({ value: String(error), words: error === 0 ? "Never" : percent(error) })),
    (value) => session.apply({ error: Number(value) }));
  const estimate = button("Estimate", () => void training.estimate(), { title: "Says what the core time is spent on. The server simulates four designs for it." });
  const train = button("Train a network", () => void training.train(), { kind: "primary" });
  const needs = h("p", { class: "note plain", hidden: true });
  const plan = h("p", { class: "plan", hidden: true });
  const planStatus = activityRow(training.planActivity, "Progress of the estimate", () => training.cancelEstimate());
  const status = activityRow(training.activity, "Progress of the training", () => training.cancel());
  const element = h("section", { class: "card training controls", "aria-label": "Training" }, h("h2", {}, "Network"),
    h("p", { class: "muted" }, "Designs ask a network, which learns from simulations. It takes hours, goes on when you leave the page, and its job is in the tray."), needs,
    hours.element, goal.element, h("div", { class: "row" }, estimate, train), planStatus, plan, status, runPart(session, training));

  session.redraws.follow([session.state, session.families, training.plan, training.run, training.activity, training.planActivity], () => {
    const state = session.state.get();
    const run = training.run.get();
    const isTraining = training.activity.get().kind === "busy";
    hours.value = state.coreHours;
    goal.value = String(state.error);
    const isStored = session.isStored;
    needs.hidden = isStored;
    writeText(needs, "A training needs the family on the server: add it first.");
    estimate.disabled = !isStored || training.planActivity.get().kind === "busy";
    train.disabled = !isStored || isTraining;
    const isStopped = run?.isCancelled && run.answer === null && run.family === state.definition.id;
    writeText(train.querySelector("span") ?? train, isStopped ? "Go on" : "Train a network");
    const current = training.currentPlan;
    plan.hidden = current === null;
    if (current) writeText(plan, planSentence(current));
  });
  training.plan.watch((shown) => shown && announce(planSentence(shown.plan)));
  return element;
}

/** What runs, or why it has failed. */
function activityRow(activity: Observable<Activity<WorkInWords>>, label: string, cancel: () => void): HTMLElement {
  const status = h("div", { class: "status" });
  const row = new ProgressRow(label, cancel);
  activity.watch((now) => {
    if (now.kind === "busy") return row.show(status, now.words, now.progress);
    if (now.kind !== "failed") return replace(status);
    const sentence = trainsNoNetworks(now.error)
      ? "This server trains no networks: it has no program supple-lab, or is of an earlier version. Its administrator can install it beside the server." : now.sentence;
    announce(sentence);
    replace(status, h("p", { class: "note" }, sentence));
  });
  return status;
}

/** The training that runs or has ended: its errors over designs, and its outcome. */
function runPart(session: FamilySession, training: TrainingSession): HTMLElement {
  const plot = new ConvergencePlot(ERROR_WORDS);
  const stage = h("div", { class: "convergence-stage" }, plot.element);
  const words = h("p", { class: "run-words" });
  const element = h("div", { class: "training-run", hidden: true }, words, stage);
  new ResizeObserver(() => plot.resize(stage.clientWidth, stage.clientHeight)).observe(stage);
  session.redraws.follow([training.run, training.activity], () => {
    const run = training.run.get();
    const { kind } = training.activity.get();
    element.hidden = run === null || (kind === "failed" && run.errors.length === 0);
    if (!run) return;
    writeText(words, runWords(run, kind === "busy"));
    stage.hidden = run.errors.length === 0;
    const steps = run.errors.map(({ designs, error }) => ({ count: designs, value: error }));
    plot.update({ steps, tolerance: run.goal, current: steps.at(-1)?.count ?? null });
  });
  let announced: TrainingRun["answer"] = null;
  training.run.watch((run) => {
    if (!run?.answer || run.answer === announced) return;
    announced = run.answer;
    announce(outcomeSentence(run.answer));
  });
  return element;
}
