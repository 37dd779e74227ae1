const MAX_STEPS = 200;

/** The past values, the present one and the undone ones. Values are immutable. */
export class History<Value> {
  private past: Value[] = [];
  private future: Value[] = [];

  constructor(private present: Value) {}

  get current(): Value {
    return this.present;
  }

  get canUndo(): boolean {
    return this.past.length > 0;
  }

  get canRedo(): boolean {
    return this.future.length > 0;
  }

  /** Makes a value the present one, as a step that can be undone. */
  push(value: Value): void {
    this.past.push(this.present);
    if (this.past.length > MAX_STEPS) this.past.shift();
    this.present = value;
    this.future = [];
  }

  /** Replaces the present value without adding a step. */
  amend(value: Value): void {
    this.present = value;
  }

  undo(): boolean {
    const value = this.past.pop();
    if (value === undefined) return false;
    this.future.push(this.present);
    this.present = value;
    return true;
  }

  redo(): boolean {
    const value = this.future.pop();
    if (value === undefined) return false;
    this.past.push(this.present);
    this.present = value;
    return true;
  }
}
