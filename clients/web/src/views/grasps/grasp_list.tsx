import { useEffect, useRef } from 'preact/hooks';

import type { Grasp } from '../../api/types';
import { formatNumber, formatShare } from '../../ui/format';
import { useArrowKeys } from './arrow_keys';

interface GraspListProps {
  readonly grasps: readonly Grasp[];
  readonly loading: boolean;
  /** Gets more of them; null when there are none. */
  readonly loadMore: (() => void) | null;
  readonly chosen: string | null;
  readonly onChoose: (id: string) => void;
}

const idOf = (grasp: string): string => `grasp-${grasp}`;

/** A bar as long as ε, out of the best that is listed. */
function QualityBar({ share }: { readonly share: number }) {
  return (
    <svg class="quality-bar" viewBox="0 0 100 6" preserveAspectRatio="none" aria-hidden="true">
      <rect class="quality-bar-track" width="100" height="6" />
      <rect class="quality-bar-fill" width={100 * share} height="6" />
    </svg>
  );
}

/** The grasps in the order of the server. The arrows move the choice. */
export function GraspList({ grasps, loading, loadMore, chosen, onChoose }: GraspListProps) {
  const list = useRef<HTMLUListElement>(null);
  useEffect(() => {
    const item = chosen === null ? null : document.getElementById(idOf(chosen));
    // Only the list may scroll, never the page.
    if (item && list.current) {
      const { offsetTop, offsetHeight } = item;
      const { scrollTop, clientHeight } = list.current;
      if (offsetTop < scrollTop) list.current.scrollTop = offsetTop;
      const end = offsetTop + offsetHeight;
      if (end > scrollTop + clientHeight) list.current.scrollTop = end - clientHeight;
    }
  }, [chosen, grasps]);
  useArrowKeys(grasps.map(({ id }) => id), chosen, onChoose);
  if (loading) return <div class="skeleton list-skeleton" aria-hidden="true" />;
  if (grasps.length === 0) return <p class="empty list-skeleton">No grasp meets these filters.</p>;
  const best = Math.max(...grasps.map(({ quality }) => quality.epsilon), Number.EPSILON);
  const chosenInList = grasps.some(({ id }) => id === chosen);
  return (
    <>
      <ul
        class="grasp-list"
        role="listbox"
        aria-label="Grasps"
        tabIndex={0}
        ref={list}
        aria-activedescendant={chosen !== null && chosenInList ? idOf(chosen) : undefined}
      >
        {grasps.map(({ id, part, stage, quality }, index) => (
          <li
            key={id}
            id={idOf(id)}
            role="option"
            aria-selected={id === chosen}
            onClick={() => { onChoose(id); }}
          >
            <span class="grasp-rank">{index + 1}</span>
            <span class="grasp-part">{part}</span>
            <span class="grasp-stage">{stage}</span>
            <span class="grasp-epsilon">{formatNumber(quality.epsilon)}</span>
            <QualityBar share={quality.epsilon / best} />
            <span class="grasp-robust">
              robust {formatShare(quality.robust)} · grip {formatShare(quality.grip)}
            </span>
          </li>
        ))}
      </ul>
      <p class="list-note">
        {loadMore ? `The first ${grasps.length}` : `${grasps.length} ${grasps.length === 1 ? 'grasp' : 'grasps'}`}
        {' '}· arrow keys step through
        {loadMore && (
          <>
            {' '}· <button type="button" class="quiet" onClick={loadMore}>More</button>
          </>
        )}
      </p>
    </>
  );
}
