import { useEffect, useState } from 'preact/hooks';

function useMedia(query: string): boolean {
  const [list] = useState(() => window.matchMedia(query));
  const [matches, setMatches] = useState(list.matches);
  useEffect(() => {
    const follow = (): void => {
      setMatches(list.matches);
    };
    list.addEventListener('change', follow);
    return () => {
      list.removeEventListener('change', follow);
    };
  }, [list]);
  return matches;
}

export const useDark = (): boolean => useMedia('(prefers-color-scheme: dark)');
/** As the style sheets' narrowest layout. */
export const useNarrow = (): boolean => useMedia('(max-width: 760px)');
export const useReducedMotion = (): boolean => useMedia('(prefers-reduced-motion: reduce)');
