// The words of a training: what it takes, how far it is, and its outcome.
import type { ConvergenceWords } from "../base/convergence_plot";
import { digits, percent } from "../base/format";
import type { Training, TrainingPlan } from "../contract/types";
import type { TrainingRun } from "./training_session";

/** Words of the plot of errors over designs. */
export const ERROR_WORDS: ConvergenceWords = {
  xTitle: "Simulated designs",
  yTitle: "Mean error of the stress",
  counted: "simulated designs",
  tolerance: "wanted",
  valueWords: percent,
  tickWords: percent,
  multiples: [2, 5],
};

/** Hours of one core, in words. */
export function coreTimeWords(seconds: number): string {
  const hours = seconds / 3600;
  return hours >= 1 ? `${digits(hours, 2)} h` : `${Math.max(1, Math.round(seconds / 60))} min`;
}

export function planSentence({ estimate: { simulation, training, designs } }: Pick<TrainingPlan, "estimate">): string {
  const simulations = `${coreTimeWords(simulation)} for simulations of ${designs.toLocaleString("en")} designs`;
  return `About ${coreTimeWords(simulation + training)} of one core: ${simulations} and ${coreTimeWords(training)} for networks.`;
}

export function outcomeSentence({ model, error, designs }: Pick<Training, "model" | "error" | "designs">): string {
  return `The network ${model} has learned from ${designs.toLocaleString("en")} designs. On designs that were held out, its stress errs by ${percent(error)} in the mean.`;
}

/** What is known of a training so far. */
export function runWords({ family, errors, answer, isCancelled }: TrainingRun, isRunning: boolean): string {
  if (answer) return outcomeSentence(answer);
  const last = errors.at(-1);
  const reached = last ? ` So far: ${percent(last.error)} in the mean, with ${last.designs.toLocaleString("en")} designs.` : "";
  if (isRunning) return last ? `${family} is being trained.${reached}` : `${family} is being trained. Its errors are drawn here as soon as there are any.`;
  return isCancelled ? `The training of ${family} is stopped. What is done is kept: “Go on” goes on with it.${reached}` : `The training of ${family} has not ended.${reached}`;
}
