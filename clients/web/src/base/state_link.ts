// The link of a page whose whole state is in its address.
import { debounce } from "./debounce";
import type { EditedState } from "./edited_state";

const PAUSE_MS = 250;

export interface StateText<State> {
  /** The text of a link; empty for a state that has none. */
  write(state: State): string;
  /** Null if the text is no valid link. */
  read(text: string): State | null;
}

/** Writes the state into the address: after a pause in the changes, and at once when a change is complete, so that a reload does not revert it. */
export class StateLink<State extends object> {
  /** A change with intermediate states, such as a drag, ends with a step, which writes the link: writing one takes longer than a redraw may. */
  private readonly later = debounce(() => !this.edited.isBeingChanged && this.write(), PAUSE_MS);

  /** `isReady`: whether the state is one to share. It is not before the page has started. */
  constructor(
    private readonly link: { write(text: string): void },
    private readonly edited: Pick<EditedState<State>, "state" | "steps" | "isBeingChanged">,
    private readonly text: StateText<State>,
    isReady: () => boolean,
  ) {
    edited.state.watch(() => {
      if (isReady()) this.later.schedule();
    });
    edited.steps.watch(() => {
      if (isReady()) this.later.flush();
    });
  }

  write(): void {
    this.link.write(this.text.write(this.edited.state.get()));
  }

  /** The state of a link that is followed, or null if it is the present one, or none. In that case the address is written again. */
  follow(text: string): State | null {
    const linked = text === "" || text === this.text.write(this.edited.state.get()) ? null : this.text.read(text);
    if (!linked) this.write();
    return linked;
  }

  close(): void {
    this.later.cancel();
  }
}
