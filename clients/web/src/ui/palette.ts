/** Okabe and Ito's colours, which people of every colour vision tell apart. */
const OKABE_ITO = {
  blue: '#0072b2',
  orange: '#e69f00',
  green: '#009e73',
  purple: '#cc79a7',
  sky: '#56b4e9',
  yellow: '#f0e442',
  vermilion: '#d55e00',
} as const;

/** Contacts, and nothing else, are vermilion. */
export const CONTACT_COLOUR = OKABE_ITO.vermilion;

const PART_COLOURS = [
  OKABE_ITO.blue, OKABE_ITO.orange, OKABE_ITO.green, OKABE_ITO.purple, OKABE_ITO.sky,
  OKABE_ITO.yellow,
] as const;

const UNLABELLED = '#8a929c';

/** The colour of the part with this place in its category's list; the same for
 * all objects of the category. */
export function partColour(index: number): string {
  if (index < 0) return UNLABELLED;
  return PART_COLOURS[index % PART_COLOURS.length] ?? UNLABELLED;
}

export const gridColour = (dark: boolean): string => (dark ? '#39424e' : '#c6ccd4');

/** The hand's, of no part's colour. */
export const handColour = (dark: boolean): string => (dark ? '#b4bcc8' : '#747e8c');

export const lineColour = (dark: boolean): string => (dark ? '#ffffff' : '#16181d');

/** Dark to bright through hues that keep their order for all eyes (viridis). */
const RAMP = ['#440154', '#3b528b', '#21918c', '#5ec962', '#fde725'] as const;

/** The ramp's colour nearest to a share of 0..1. */
export function rampColour(share: number): string {
  const index = Math.round(Math.min(Math.max(share, 0), 1) * (RAMP.length - 1));
  return RAMP[index] ?? RAMP[0];
}
