import { useEffect, useState } from 'preact/hooks';

import { getCategory, listCategories, listHands } from '../../api/client';
import { useResource } from '../../app/resource';
import { type GraspFilters, type GraspSort, SORTS, STAGES } from '../../app/routes';
import { SelectField } from '../../ui/select_field';

interface FilterFormProps {
  readonly filters: GraspFilters;
  /** Without it each change is submitted at once. */
  readonly submitLabel?: string;
  readonly onSubmit: (filters: GraspFilters) => void;
}

const ANY = '';
/** The server's. */
const DEFAULT_SORT: GraspSort = 'epsilon';
const SORT_NAMES = {
  epsilon: 'Quality ε',
  merit: 'Merit',
  hybrid: 'Hybrid measure',
  robust: 'Robustness',
  newest: 'Newest',
} as const;

async function loadVocabulary(category: string | undefined) {
  const [categories, hands, own] = await Promise.all([
    listCategories(),
    listHands(),
    category === undefined ? null : getCategory(category),
  ]);
  const parts = (own ? [own] : categories.items).flatMap((each) => each.parts);
  return {
    categories: categories.items.map(({ name }) => name),
    hands: hands.items.map(({ name }) => name),
    parts: [...new Set(parts.map(({ label }) => label))],
    tasks: [...new Set(parts.flatMap(({ tasks = {} }) => Object.keys(tasks)))],
  };
}

/** Sets a filter, or drops it when the value is empty. */
function changeFilter(
  filters: GraspFilters,
  name: keyof GraspFilters,
  value: string | number,
): GraspFilters {
  const { [name]: before, ...rest } = filters;
  return value === ANY || value === 0 ? rest : { ...rest, [name]: value };
}

/** The filters of GET /v1/grasps. */
export function FilterForm({ filters, submitLabel, onSubmit }: FilterFormProps) {
  const [draft, setDraft] = useState(filters);
  useEffect(() => {
    setDraft(filters);
  }, [JSON.stringify(filters)]);
  const vocabulary = useResource(`vocabulary ${draft.category ?? ANY}`, () =>
    loadVocabulary(draft.category),
  );
  const change = (name: keyof GraspFilters, value: string | number): void => {
    const changed = changeFilter(draft, name, value);
    // Another category has other parts and tasks.
    const kept = name === 'category'
      ? changeFilter(changeFilter(changed, 'part', ANY), 'task', ANY)
      : changed;
    setDraft(kept);
    if (submitLabel === undefined) onSubmit(kept);
  };
  const select = (
    label: string,
    name: keyof GraspFilters,
    words: readonly string[],
  ) => (
    <SelectField
      label={label}
      value={String(draft[name] ?? ANY)}
      options={[[ANY, 'any'], ...words.map((word) => [word, word] as const)]}
      onChange={(value) => {
        change(name, value);
      }}
    />
  );
  return (
    <form
      class="filters"
      aria-label="Filters"
      onSubmit={(event) => {
        event.preventDefault();
        onSubmit(draft);
      }}
    >
      {submitLabel === undefined && select('Category', 'category', vocabulary.value?.categories ?? [])}
      {select('Part', 'part', vocabulary.value?.parts ?? [])}
      {select('Task', 'task', vocabulary.value?.tasks ?? [])}
      {select('Hand', 'hand', vocabulary.value?.hands ?? [])}
      {select('Stage', 'stage', STAGES)}
      {submitLabel === undefined && (
        <SelectField
          label="Sorted by"
          value={draft.sort ?? DEFAULT_SORT}
          options={SORTS.map((sort) => [sort, SORT_NAMES[sort]] as const)}
          onChange={(value) => { change('sort', value); }}
        />
      )}
      <label class="field">
        <span>ε at least</span>
        <input
          type="number"
          min="0"
          max="1"
          step="0.01"
          value={draft.min_epsilon ?? 0}
          onChange={(event) => {
            change('min_epsilon', Number(event.currentTarget.value));
          }}
        />
      </label>
      <label class="field checkbox" title="Held in the simulator through every push">
        <input
          type="checkbox"
          checked={draft.verified === 'physical'}
          onChange={(event) => {
            change('verified', event.currentTarget.checked ? 'physical' : ANY);
          }}
        />
        <span>Verified</span>
      </label>
      {submitLabel !== undefined && <button type="submit" class="primary">{submitLabel}</button>}
    </form>
  );
}
