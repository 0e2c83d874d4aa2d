import type { ComponentChildren } from 'preact';
import { useEffect, useState } from 'preact/hooks';

import { formatRoute, parseRoute, type Route } from './routes';

const MOVED = 'graspdb:moved';

/** Parameters that stay through all navigation. */
const KEPT = ['stats'] as const;

export function toHref(route: Route): string {
  const url = new URL(formatRoute(route), window.location.origin);
  const here = new URLSearchParams(window.location.search);
  for (const name of KEPT) {
    const value = here.get(name);
    if (value !== null) url.searchParams.set(name, value);
  }
  return url.pathname + url.search;
}

/** Goes there; with `replace`, without a step for the browser's back button. */
export function navigate(route: Route, { replace = false } = {}): void {
  window.history[replace ? 'replaceState' : 'pushState'](null, '', toHref(route));
  window.dispatchEvent(new Event(MOVED));
}

/** The route that the address bar shows. */
export function useRoute(): Route {
  const [search, setSearch] = useState(window.location.search);
  useEffect(() => {
    const follow = (): void => {
      setSearch(window.location.search);
    };
    window.addEventListener('popstate', follow);
    window.addEventListener(MOVED, follow);
    return () => {
      window.removeEventListener('popstate', follow);
      window.removeEventListener(MOVED, follow);
    };
  }, []);
  return parseRoute(search);
}

interface LinkProps {
  readonly to: Route;
  readonly class?: string;
  readonly current?: boolean;
  readonly children: ComponentChildren;
}

/** A link inside the viewer; opens in a new tab as any other. */
export function Link({ to, current = false, children, ...rest }: LinkProps) {
  return (
    <a
      {...rest}
      href={toHref(to)}
      aria-current={current ? 'page' : undefined}
      onClick={(event) => {
        if (event.metaKey || event.ctrlKey || event.shiftKey || event.altKey) return;
        event.preventDefault();
        navigate(to);
        window.scrollTo(0, 0);
      }}
    >
      {children}
    </a>
  );
}
