/** A debounced action: it runs once, after a pause in the calls. */
export interface Debounced {
  schedule(): void;
  /** Runs the action at once. */
  flush(): void;
  cancel(): void;
}

export function debounce(action: () => void, pause: number): Debounced {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const cancel = (): void => clearTimeout(timer);
  return {
    schedule() {
      cancel();
      timer = setTimeout(action, pause);
    },
    flush() {
      cancel();
      action();
    },
    cancel,
  };
}
