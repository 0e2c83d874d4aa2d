import type { GraspStage } from '../../api/types';

interface StageSwitchProps {
  /** The ids of the same source grasp's transfer by stage. */
  readonly stages: Readonly<Partial<Record<GraspStage, string>>>;
  readonly current: GraspStage | null;
  readonly onStage: (stage: GraspStage) => void;
}

const NAMES = [
  ['transfer', 'Before replanning', 'as transferred to the part alone'],
  ['assembly', 'After replanning', 'for the whole object'],
] as const;

/** Before and after replanning for the whole object. */
export function StageSwitch({ stages, current, onStage }: StageSwitchProps) {
  return (
    <div class="toggles" role="group" aria-label="Replanning">
      {NAMES.map(([stage, name, title]) => (
        <button
          key={stage}
          type="button"
          title={title}
          aria-pressed={current === stage}
          disabled={stages[stage] === undefined}
          onClick={() => { onStage(stage); }}
        >
          {name}
        </button>
      ))}
    </div>
  );
}
