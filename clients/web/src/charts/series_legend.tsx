import { Swatch } from '../ui/swatch';

/** A name and the colour of its marks. */
export interface SeriesKey {
  readonly name: string;
  readonly colour: string;
}

export function SeriesLegend({ series }: { readonly series: readonly SeriesKey[] }) {
  return (
    <ul class="legend">
      {series.map(({ name, colour }) => (
        <li key={name}>
          <Swatch colour={colour} /> {name}
        </li>
      ))}
    </ul>
  );
}
