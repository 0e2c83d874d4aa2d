import type { Object3D } from 'three';
import type { ComponentChildren } from 'preact';
import { type Inputs, useEffect, useRef, useState } from 'preact/hooks';

import { Stage } from './stage';
import { StatisticsReadout } from './statistics_readout';

interface ViewportProps {
  /** For those who cannot see it. */
  readonly label: string;
  readonly onStage: (stage: Stage | null) => void;
  /** Over the picture: legends, controls. */
  readonly children?: ComponentChildren;
}

/** A 3-D view of fixed proportions, empty until something is put on its stage. */
export function Viewport({ label, onStage, children }: ViewportProps) {
  const container = useRef<HTMLDivElement>(null);
  const [stage, setStage] = useState<Stage | null>(null);
  const [failure, setFailure] = useState<string | null>(null);
  useEffect(() => {
    if (!container.current) return;
    let made: Stage;
    try {
      made = new Stage(container.current, label);
    } catch {
      setFailure('This browser has no WebGL, which the 3-D view needs.');
      return;
    }
    setStage(made);
    onStage(made);
    return () => {
      onStage(null);
      made.dispose();
    };
  }, []);
  useEffect(() => {
    stage?.describe(label);
  }, [stage, label]);
  return (
    <div class="viewport">
      <div class="viewport-canvas" ref={container} />
      {failure !== null && <p class="viewport-failure">{failure}</p>}
      {stage && (
        <button type="button" class="viewport-reset quiet" onClick={() => { stage.reset(); }}>
          Reset view
        </button>
      )}
      {stage && <StatisticsReadout stage={stage} />}
      {children}
    </div>
  );
}

/** Keeps on the stage what `make` makes, made again when an input changes. */
export function useOnStage<Content extends Object3D>(
  stage: Stage | null,
  make: () => Content | null,
  inputs: Inputs,
): Content | null {
  const [content, setContent] = useState<Content | null>(null);
  useEffect(() => {
    const made = stage ? make() : null;
    setContent(made);
    if (!stage || !made) return;
    stage.add(made);
    return () => {
      stage.remove(made);
      made.dispose();
    };
  }, [stage, ...inputs]);
  return content;
}
