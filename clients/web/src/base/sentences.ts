// The sentences to be announced next: the last one of each topic.

/** Topic of a sentence: a change that the user made, or its outcome. */
export type Topic = "change" | "outcome";

export class Sentences {
  private readonly last: Record<Topic, string> = { change: "", outcome: "" };

  set(topic: Topic, sentence: string): void {
    this.last[topic] = sentence;
  }

  /** Returns all sentences, the change first, and clears them. */
  take(): string {
    const all = [this.last.change, this.last.outcome].filter((sentence) => sentence !== "").join(" ");
    this.last.change = this.last.outcome = "";
    return all;
  }
}
