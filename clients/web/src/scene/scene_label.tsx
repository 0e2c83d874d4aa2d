import type { ComponentChildren } from 'preact';
import { useEffect, useRef } from 'preact/hooks';
import type { Vector3 } from 'three';

import type { Stage } from './stage';

interface SceneLabelProps {
  readonly stage: Stage;
  readonly point: Vector3;
  readonly children: ComponentChildren;
}

/** Words that stay below a point of the scene. */
export function SceneLabel({ stage, point, children }: SceneLabelProps) {
  const label = useRef<HTMLSpanElement>(null);
  useEffect(
    () =>
      stage.onFrame(() => {
        const { x, y } = stage.project(point);
        if (label.current) label.current.style.transform = `translate(${x}px, ${y}px)`;
      }),
    [stage, point.x, point.y, point.z],
  );
  return (
    <span class="scene-label" ref={label}>
      <span>{children}</span>
    </span>
  );
}
