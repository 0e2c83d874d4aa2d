/** Numbers for people, in the units of the server: metres, radians, seconds. */
const EM_DASH = '–';

export function formatNumber(value: number | null, digits = 3): string {
  return value === null ? EM_DASH : value.toFixed(digits);
}

export const formatLength = (metres: number): string => `${metres.toFixed(4)} m`;

export const formatShare = (share: number | null): string =>
  share === null ? EM_DASH : `${(100 * share).toFixed(0)} %`;

/** With three digits that count, as 6.59 × 10⁻⁵ when that is shorter. */
export function formatQuantity(value: number, unit: string): string {
  if (value === 0) return `0 ${unit}`;
  const exponent = Math.floor(Math.log10(Math.abs(value)));
  if (exponent >= -3 && exponent < 6) return `${Number(value.toPrecision(3))} ${unit}`;
  return `${(value / 10 ** exponent).toFixed(2)} × 10${toSuperscript(exponent)} ${unit}`;
}

function toSuperscript(exponent: number): string {
  return [...String(exponent)]
    .map((sign) => (sign === '-' ? '⁻' : ('⁰¹²³⁴⁵⁶⁷⁸⁹'[Number(sign)] ?? sign)))
    .join('');
}

export const formatCount = (count: number): string => count.toLocaleString('en');

export const formatWords = (identifier: string): string => identifier.replaceAll('_', ' ');
