import { useState } from 'preact/hooks';

import { useNarrow } from '../../app/media';
import type { GraspFilters } from '../../app/routes';
import { FilterForm } from './filter_form';

interface FilterBoxProps {
  readonly filters: GraspFilters;
  readonly onChange: (filters: GraspFilters) => void;
}

/** The filters, folded away where they would push the list off the screen. */
export function FilterBox({ filters, onChange }: FilterBoxProps) {
  const narrow = useNarrow();
  const [open, setOpen] = useState(!narrow);
  const numSet = Object.keys(filters).filter((name) => name !== 'sort').length;
  return (
    <details open={open} onToggle={(event) => { setOpen(event.currentTarget.open); }}>
      <summary>Filters{numSet > 0 && ` · ${numSet} set`}</summary>
      <FilterForm filters={filters} onSubmit={onChange} />
    </details>
  );
}
