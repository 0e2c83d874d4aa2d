import { useEffect, useRef, useState } from 'preact/hooks';

import type { StoredObject } from '../api/types';
import { loadObjectModel } from './object_model';
import { drawThumbnail } from './thumbnail_renderer';

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
    loadObjectModel(object).then(
      (model) => {
        if (wanted && canvas.current) {
          drawThumbnail(model, canvas.current);
          setState('drawn');
        }
        model.geometry.dispose();
      },
      () => {
        if (wanted) setState('failed');
      },
    ).catch(() => {
      if (wanted) setState('failed'); // Without WebGL the name must do.
    });
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
