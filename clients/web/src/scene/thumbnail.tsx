import { useEffect, useRef, useState } from 'preact/hooks';

import type { StoredObject } from '../api/types';

const WIDTH = 400;
const HEIGHT = 300;

interface ThumbnailProps {
  readonly object: StoredObject;
  readonly label: string;
}

/** A small picture of an object; its place is kept until it is there. */
export function Thumbnail({ object, label }: ThumbnailProps) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [state, setState] = useState<'waiting' | 'drawn' | 'failed'>('waiting');
  useEffect(() => {
    let wanted = true;
    setState('waiting');
    const draw = async (): Promise<void> => {
      // Names and numbers are there before all that draws has come.
      const { drawThumbnail } = await import('./thumbnail_renderer');
      if (canvas.current) await drawThumbnail(object, canvas.current, () => wanted);
    };
    draw().then(
      () => { if (wanted) setState('drawn'); },
      () => { if (wanted) setState('failed'); }, // Without WebGL the name must do.
    );
    return () => {
      wanted = false;
    };
  }, [object.id]);
  return (
    <canvas
      class={`thumbnail is-${state}`}
      ref={canvas}
      width={WIDTH}
      height={HEIGHT}
      role="img"
      aria-label={label}
    />
  );
}
