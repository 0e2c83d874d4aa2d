import { useState } from 'preact/hooks';

import { getObject, startTransfer } from '../../api/client';
import { type ProblemError, toProblem } from '../../api/problem';
import { Link, navigate } from '../../app/navigation';
import { useResource } from '../../app/resource';
import { Thumbnail } from '../../scene/thumbnail';
import { describeObject } from '../../ui/object_name';
import { ProblemNote } from '../../ui/problem_note';

const DEFAULT_SOURCES = 40;
const DEFAULT_FRICTION = 0.5;

/** Starts a transfer to an object that is stored already. */
export function TransferForm({ object: id }: { readonly object: string }) {
  const object = useResource(id, () => getObject(id));
  const [sources, setSources] = useState(DEFAULT_SOURCES);
  const [friction, setFriction] = useState(DEFAULT_FRICTION);
  const [busy, setBusy] = useState(false);
  const [problem, setProblem] = useState<ProblemError | null>(null);
  const start = async (): Promise<void> => {
    setBusy(true);
    setProblem(null);
    try {
      const job = await startTransfer({ object: id, sources, friction });
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
        <Thumbnail object={id} label="The object" />
      </div>
      <form
        class="upload"
        onSubmit={(event) => {
          event.preventDefault();
          void start();
        }}
      >
        <div class="upload-options">
          <label class="field">
            <span>Source grasps per part</span>
            <input type="number" min="1" max="1000" value={sources}
              onChange={(event) => { setSources(Number(event.currentTarget.value)); }} />
          </label>
          <label class="field">
            <span>Friction μ</span>
            <input type="number" min="0.01" max="2" step="0.01" value={friction}
              onChange={(event) => { setFriction(Number(event.currentTarget.value)); }} />
          </label>
        </div>
        <button type="submit" class="primary" disabled={busy}>
          {busy ? 'Starting …' : 'Find grasps'}
        </button>
        {shown && <ProblemNote problem={shown} />}
      </form>
    </div>
  );
}
