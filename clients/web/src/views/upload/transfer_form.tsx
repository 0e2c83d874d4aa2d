import { useState } from 'preact/hooks';

import { getObject, startTransfer } from '../../api/client';
import { type ProblemError, toProblem } from '../../api/problem';
import { Link, navigate } from '../../app/navigation';
import { useResource } from '../../app/resource';
import { Thumbnail } from '../../scene/thumbnail';
import { describeObject } from '../../ui/object_name';
import { ProblemNote } from '../../ui/problem_note';
import { DEFAULT_SETTINGS, TransferOptions } from './transfer_options';

/** Starts a transfer to an object that is stored already. */
export function TransferForm({ object: id }: { readonly object: string }) {
  const object = useResource(id, () => getObject(id));
  const [settings, setSettings] = useState(DEFAULT_SETTINGS);
  const [busy, setBusy] = useState(false);
  const [problem, setProblem] = useState<ProblemError | null>(null);
  const start = async (): Promise<void> => {
    setBusy(true);
    setProblem(null);
    try {
      const job = await startTransfer({ object: id, ...settings });
      navigate({ view: 'upload', object: id, job: job.id });
    } catch (error) {
      setProblem(toProblem(error));
      setBusy(false);
    }
  };
  const shown = object.problem ?? problem;
  return (
    <div class="page narrow">
      <h1>Transfer grasps</h1>
      <p class="subtitle">
        to{' '}
        <Link to={{ view: 'object', object: id }}>{object.value ? describeObject(object.value) : '…'}</Link>
      </p>
      <div class="card still">
        {object.value ? (
          <Thumbnail object={object.value} label="The object" />
        ) : (
          <div class="thumbnail" />
        )}
      </div>
      <form
        class="upload"
        onSubmit={(event) => {
          event.preventDefault();
          void start();
        }}
      >
        <div class="upload-options">
          <TransferOptions settings={settings} onChange={setSettings} />
        </div>
        <button type="submit" class="primary" disabled={busy}>
          {busy ? 'Starting …' : 'Find grasps'}
        </button>
        {shown && <ProblemNote problem={shown} />}
      </form>
    </div>
  );
}
