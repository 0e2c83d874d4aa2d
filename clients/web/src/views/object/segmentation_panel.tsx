import { useState } from 'preact/hooks';

import { listParameters, segmentAgain } from '../../api/client';
import { type ProblemError, toProblem } from '../../api/problem';
import type { Category, Parameter, SettingValues, StoredObject } from '../../api/types';
import { useResource } from '../../app/resource';
import { CascadeQuestion } from '../../ui/cascade_question';
import { formatWords } from '../../ui/format';

const SECTION = 'segmentation.';

interface SegmentationPanelProps {
  readonly object: StoredObject;
  readonly category: Category;
  readonly onChange: (object: StoredObject) => void;
}

/** The settings with the category's own values. */
async function loadSettings(category: Category): Promise<readonly Parameter[]> {
  const { items } = await listParameters();
  return items
    .filter(({ name }) => name.startsWith(SECTION))
    .map((parameter) => {
      const name = parameter.name.slice(SECTION.length);
      return { ...parameter, name, value: category.segmentation[name] ?? parameter.value };
    });
}

function SettingField({ setting, value, onChange }: {
  readonly setting: Parameter;
  readonly value: number | boolean;
  readonly onChange: (value: number | boolean) => void;
}) {
  const name = formatWords(setting.name) + (setting.unit === '1' ? '' : ` (${setting.unit})`);
  if (typeof value === 'boolean') {
    return (
      <label class="field checkbox" title={setting.source}>
        <input
          type="checkbox"
          checked={value}
          onChange={(event) => { onChange(event.currentTarget.checked); }}
        />
        <span>{name}</span>
      </label>
    );
  }
  return (
    <label class="field" title={setting.source}>
      <span>{name}</span>
      <input
        type="number"
        step="any"
        min={setting.minimum}
        max={setting.maximum}
        value={value}
        onChange={(event) => { onChange(Number(event.currentTarget.value)); }}
      />
    </label>
  );
}

/** Cuts the object into parts again, with other settings. */
export function SegmentationPanel({ object, category, onChange }: SegmentationPanelProps) {
  const settings = useResource(category.name, () => loadSettings(category));
  const [changes, setChanges] = useState<SettingValues>({});
  const [busy, setBusy] = useState(false);
  const [problem, setProblem] = useState<ProblemError | null>(null);
  const segment = async (cascade: boolean): Promise<void> => {
    setBusy(true);
    setProblem(null);
    try {
      onChange(await segmentAgain(object.id, changes, cascade));
    } catch (error) {
      setProblem(toProblem(error));
    }
    setBusy(false);
  };
  return (
    <details>
      <summary>Segment again</summary>
      <form
        class="settings"
        onSubmit={(event) => {
          event.preventDefault();
          void segment(false);
        }}
      >
        {settings.value?.map((setting) => (
          <SettingField
            key={setting.name}
            setting={setting}
            value={changes[setting.name] ?? setting.value}
            onChange={(value) => { setChanges({ ...changes, [setting.name]: value }); }}
          />
        ))}
        <button type="submit" class="primary" disabled={busy}>
          {busy ? 'Segmenting …' : 'Segment again'}
        </button>
      </form>
      {problem && (
        <CascadeQuestion
          problem={problem}
          onCascade={() => { void segment(true); }}
          onCancel={() => { setProblem(null); }}
        />
      )}
    </details>
  );
}
