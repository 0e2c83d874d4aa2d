import { useState } from 'preact/hooks';

import { listCategories, postObject, startTransfer } from '../../api/client';
import { type ProblemError, toProblem } from '../../api/problem';
import type { UploadQuery } from '../../api/types';
import { navigate } from '../../app/navigation';
import { useResource } from '../../app/resource';
import { ProblemNote } from '../../ui/problem_note';
import { SelectField } from '../../ui/select_field';
import { DropZone } from './drop_zone';
import { DEFAULT_SETTINGS, TransferOptions } from './transfer_options';

const AUTO = 'auto';
const OWN_UNITS = '';
const UNITS = [
  [OWN_UNITS, "the file's own, else metres"], ['m', 'metres'], ['mm', 'millimetres'],
  ['cm', 'centimetres'], ['in', 'inches'],
] as const;

type Units = NonNullable<UploadQuery['units']>;
type Stage = 'ready' | 'storing' | 'starting';

/** What the button says while it works. */
const DOING: Readonly<Record<Stage, string>> = {
  ready: 'Find grasps',
  storing: 'Repairing, cutting into parts …',
  starting: 'Starting the transfer …',
};

function isUnits(text: string): text is Units {
  return UNITS.some(([unit]) => unit !== OWN_UNITS && unit === text);
}

export function UploadForm() {
  const categories = useResource('categories', listCategories);
  const [file, setFile] = useState<File | null>(null);
  const [units, setUnits] = useState<string>(OWN_UNITS);
  const [category, setCategory] = useState(AUTO);
  const [settings, setSettings] = useState(DEFAULT_SETTINGS);
  const [stage, setStage] = useState<Stage>('ready');
  const [problem, setProblem] = useState<ProblemError | null>(null);

  const upload = async (chosen: File): Promise<void> => {
    setProblem(null);
    try {
      setStage('storing');
      const object = await postObject(chosen, { category, ...(isUnits(units) && { units }) });
      setStage('starting');
      const job = await startTransfer({ object: object.id, ...settings });
      navigate({ view: 'upload', object: object.id, job: job.id });
    } catch (error) {
      setProblem(toProblem(error));
      setStage('ready');
    }
  };

  return (
    <div class="page narrow">
      <h1>Upload</h1>
      <p class="lead">
        A mesh (OBJ, STL, PLY, OFF, GLB, glTF, DAE) or a point cloud (PLY, PCD, XYZ). It stays in its
        own frame; grasps are transferred from the learned example most like it.
      </p>
      <form
        class="upload"
        onSubmit={(event) => {
          event.preventDefault();
          if (file) void upload(file);
        }}
      >
        <DropZone file={file} onFile={(chosen) => { setFile(chosen); setProblem(null); }} />
        <div class="upload-options">
          <SelectField label="Units of the file" value={units} options={UNITS} onChange={setUnits} />
          <SelectField
            label="Category"
            value={category}
            options={[
              [AUTO, 'auto: the most similar'],
              ...(categories.value?.items ?? []).map(({ name, title }) => [name, title] as const),
            ]}
            onChange={setCategory}
          />
          <TransferOptions settings={settings} onChange={setSettings} />
        </div>
        <button type="submit" class="primary" disabled={!file || stage !== 'ready'}>
          <span aria-live="polite">{DOING[stage]}</span>
        </button>
        <div class="upload-problem">{problem && <ProblemNote problem={problem} />}</div>
      </form>
    </div>
  );
}
