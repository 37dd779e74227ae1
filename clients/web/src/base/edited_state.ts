// An immutable state that the user edits, with undo and redo.
import { History } from "./history";
import { Observable } from "./observable";

export interface Steps {
  readonly undo: boolean;
  readonly redo: boolean;
}

/** A state and its history. A change with intermediate states, such as a drag, becomes one step. */
export class EditedState<State extends object> {
  readonly state: Observable<State>;
  /** Whether there are steps to undo and to redo. */
  readonly steps = new Observable<Steps>({ undo: false, redo: false });
  private history: History<State>;
  private isChanging = false;

  constructor(initial: State) {
    this.state = new Observable(initial);
    this.history = new History(initial);
  }

  /** Begins a new history. */
  begin(state: State): void {
    this.history = new History(state);
    this.state.set(state);
    this.publishSteps();
  }

  /** Whether a change with intermediate states, such as a drag, has begun and not ended. */
  get isBeingChanged(): boolean {
    return this.isChanging;
  }

  /** Begins a change with intermediate states. Returns false if one has begun before. */
  beginChange(): boolean {
    const begins = !this.isChanging;
    this.isChanging = true;
    return begins;
  }

  /** Ends a change with intermediate states; `push` makes it a step. Returns false if none has begun. */
  endChange(): boolean {
    const ends = this.isChanging;
    this.isChanging = false;
    return ends;
  }

  /** Sets some fields, without a step. */
  change(change: Partial<State>): void {
    this.state.set({ ...this.state.get(), ...change });
  }

  /** Makes the present state a step. */
  push(): void {
    this.history.push(this.state.get());
    this.publishSteps();
  }

  /** Replaces the present state without a step, so that undoing leads back before it. */
  amend(state: State): void {
    this.state.set(state);
    if (!this.isChanging) this.history.amend(state);
  }

  /** `restore`: sets the state before the last step. */
  undo(restore: (state: State) => void): void {
    if (this.history.undo()) this.restore(restore);
  }

  redo(restore: (state: State) => void): void {
    if (this.history.redo()) this.restore(restore);
  }

  private restore(restore: (state: State) => void): void {
    restore(this.history.current);
    this.publishSteps();
  }

  private publishSteps(): void {
    this.steps.set({ undo: this.history.canUndo, redo: this.history.canRedo });
  }
}
