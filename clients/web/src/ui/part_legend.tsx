import type { ColouredPart } from '../scene/object_model';
import { Swatch } from './swatch';

export function PartLegend({ parts }: { readonly parts: readonly ColouredPart[] }) {
  return (
    <ul class="legend" aria-label="Parts">
      {parts.map(({ part, colour }) => (
        <li key={part.id}>
          <Swatch colour={colour} /> {part.label}
        </li>
      ))}
    </ul>
  );
}
