/** An action that waits for a pause in what asks for it. */
export interface Late {
  ask(): void;
  /** Without waiting. */
  now(): void;
  cancel(): void;
}

export function late(action: () => void, pause: number): Late {
  let timer: ReturnType<typeof setTimeout> | undefined;
  const cancel = (): void => clearTimeout(timer);
  return {
    ask() {
      cancel();
      timer = setTimeout(action, pause);
    },
    now() {
      cancel();
      action();
    },
    cancel,
  };
}
