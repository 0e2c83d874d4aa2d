import { useEffect } from 'preact/hooks';

const STEPS: Readonly<Record<string, number>> = {
  ArrowDown: 1,
  ArrowRight: 1,
  ArrowUp: -1,
  ArrowLeft: -1,
  Home: -Infinity,
  End: Infinity,
};

/** Where the arrows already mean something. */
function isTaken(target: EventTarget | null): boolean {
  return target instanceof HTMLElement && target.matches('input, select, textarea, summary');
}

/** The arrows, Home and End choose among items, wherever the focus is. */
export function useArrowKeys(
  ids: readonly string[],
  chosen: string | null,
  onChoose: (id: string) => void,
): void {
  useEffect(() => {
    const step = (event: KeyboardEvent): void => {
      const offset = STEPS[event.key];
      if (offset === undefined || ids.length === 0 || isTaken(event.target)) return;
      if (event.shiftKey || event.altKey || event.ctrlKey || event.metaKey) return;
      event.preventDefault();
      const index = chosen === null ? -1 : ids.indexOf(chosen);
      const next = ids[Math.min(Math.max(index + offset, 0), ids.length - 1)];
      if (next !== undefined) onChoose(next);
    };
    window.addEventListener('keydown', step);
    return () => {
      window.removeEventListener('keydown', step);
    };
  });
}
