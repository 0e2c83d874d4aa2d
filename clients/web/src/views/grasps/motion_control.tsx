import { useEffect, useState } from 'preact/hooks';

import { useReducedMotion } from '../../app/media';

const DURATION = 2.5; // s

interface MotionControlProps {
  readonly progress: number;
  readonly onProgress: (progress: number) => void;
  readonly disabled: boolean;
}

/** Plays the motion from the pre-grasp to the grasp; a slider takes it anywhere. */
export function MotionControl({ progress, onProgress, disabled }: MotionControlProps) {
  const [playing, setPlaying] = useState(false);
  const still = useReducedMotion();
  useEffect(() => {
    if (!playing) return;
    let start: number | null = null;
    const step = (now: number): void => {
      start ??= now;
      const next = Math.min((now - start) / 1000 / DURATION, 1);
      onProgress(next);
      if (next < 1) request = requestAnimationFrame(step);
      else setPlaying(false);
    };
    let request = requestAnimationFrame(step);
    return () => {
      cancelAnimationFrame(request);
    };
  }, [playing]);
  const play = (): void => {
    // Who wants no motion goes back and forth between both ends.
    if (still) onProgress(progress === 0 ? 1 : 0);
    else setPlaying(!playing);
  };
  return (
    <div class="motion">
      <button type="button" disabled={disabled} onClick={play}>
        {playing ? 'Pause' : still ? 'Pre-grasp' : 'Play'}
      </button>
      <label class="motion-slider">
        <span>Pre-grasp</span>
        <input
          type="range"
          min="0"
          max="1"
          step="0.01"
          value={progress}
          disabled={disabled}
          aria-label="Motion from the pre-grasp to the grasp"
          onInput={(event) => {
            setPlaying(false);
            onProgress(Number(event.currentTarget.value));
          }}
        />
        <span>Grasp</span>
      </label>
    </div>
  );
}
