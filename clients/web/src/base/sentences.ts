// What is to be said next: the last sentence of each topic.

/** What a sentence is about: a change that a person made, or what came of it. */
export type Topic = "change" | "outcome";

export class Sentences {
  private readonly last: Record<Topic, string> = { change: "", outcome: "" };

  set(topic: Topic, sentence: string): void {
    this.last[topic] = sentence;
  }

  /** Everything that waits to be said, the change first; nothing waits afterwards. */
  take(): string {
    const all = [this.last.change, this.last.outcome].filter((sentence) => sentence !== "").join(" ");
    this.last.change = this.last.outcome = "";
    return all;
  }
}
