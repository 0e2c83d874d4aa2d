import { useState } from 'preact/hooks';

import { formatCount } from '../../ui/format';

const SUFFIXES = '.obj,.stl,.ply,.off,.glb,.gltf,.dae,.pcd,.xyz';

interface DropZoneProps {
  readonly file: File | null;
  readonly onFile: (file: File) => void;
}

/** Takes a file that is dropped on it or chosen by a click or a key. */
export function DropZone({ file, onFile }: DropZoneProps) {
  const [over, setOver] = useState(false);
  const take = (files: FileList | null | undefined): void => {
    const first = files?.[0];
    if (first) onFile(first);
  };
  return (
    <label
      class={over ? 'drop-zone is-over' : 'drop-zone'}
      onDragOver={(event) => {
        event.preventDefault();
        setOver(true);
      }}
      onDragLeave={() => { setOver(false); }}
      onDrop={(event) => {
        event.preventDefault();
        setOver(false);
        take(event.dataTransfer?.files);
      }}
    >
      <input type="file" accept={SUFFIXES} onChange={(event) => { take(event.currentTarget.files); }} />
      <strong>{file ? file.name : 'Drop a file here, or choose one'}</strong>
      <span>{file ? `${formatCount(file.size)} bytes` : 'up to the size that the server takes'}</span>
    </label>
  );
}
