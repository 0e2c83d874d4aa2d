/** Numbers for people, in the units of the server: metres, radians, seconds. */
const NOTHING = '–';

/** Fixed digits, and no minus before a zero. */
export function formatNumber(value: number | null, digits = 3): string {
  if (value === null) return NOTHING;
  const text = value.toFixed(digits);
  return Number(text) === 0 ? text.replace('-', '') : text;
}

/** To a tenth of a millimetre. */
const LENGTH_DIGITS = 4;

export const formatLength = (metres: number): string => `${formatNumber(metres, LENGTH_DIGITS)} m`;

export const formatPoint = (point: readonly number[]): string =>
  point.map((x) => formatNumber(x, LENGTH_DIGITS)).join(', ');

export const formatShare = (share: number | null): string =>
  share === null ? NOTHING : `${(100 * share).toFixed(0)} %`;

/** With three digits that count, as 6.59 × 10⁻⁵ when that is shorter. */
export function formatQuantity(value: number, unit = ''): string {
  const suffix = unit === '' ? '' : ` ${unit}`;
  if (value === 0) return `0${suffix}`;
  const exponent = Math.floor(Math.log10(Math.abs(value)));
  if (exponent >= -3 && exponent < 6) return `${Number(value.toPrecision(3))}${suffix}`;
  return `${(value / 10 ** exponent).toFixed(2)} × 10${toSuperscript(exponent)}${suffix}`;
}

function toSuperscript(exponent: number): string {
  return Array.from(String(exponent))
    .map((sign) => (sign === '-' ? '⁻' : ('⁰¹²³⁴⁵⁶⁷⁸⁹'[Number(sign)] ?? sign)))
    .join('');
}

export const formatCount = (count: number): string => count.toLocaleString('en');

export const formatWords = (identifier: string): string => identifier.replaceAll('_', ' ');
