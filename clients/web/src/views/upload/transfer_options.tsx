/** What a transfer is asked for, as POST /v1/grasps names it. */
export interface TransferSettings {
  readonly sources: number;
  readonly friction: number;
  /** Ends with so many sure grasps; without it all source grasps are tried. */
  readonly count?: number;
}

/** The server's, but for an end as soon as there is something to look at. */
export const DEFAULT_SETTINGS: TransferSettings = { sources: 40, friction: 0.5, count: 10 };

interface TransferOptionsProps {
  readonly settings: TransferSettings;
  readonly onChange: (settings: TransferSettings) => void;
}

export function TransferOptions({ settings, onChange }: TransferOptionsProps) {
  return (
    <>
      <label class="field">
        <span>Grasps wanted (empty: all)</span>
        <input
          type="number"
          min="1"
          max="1000"
          value={settings.count}
          onChange={(event) => {
            const count = event.currentTarget.valueAsNumber;
            const { sources, friction } = settings;
            onChange(Number.isNaN(count) ? { sources, friction } : { ...settings, count });
          }}
        />
      </label>
      <label class="field">
        <span>Source grasps per part</span>
        <input
          type="number"
          min="1"
          max="1000"
          required
          value={settings.sources}
          onChange={(event) => { onChange({ ...settings, sources: event.currentTarget.valueAsNumber }); }}
        />
      </label>
      <label class="field">
        <span>Friction μ</span>
        <input
          type="number"
          min="0.01"
          max="2"
          step="0.01"
          required
          value={settings.friction}
          onChange={(event) => { onChange({ ...settings, friction: event.currentTarget.valueAsNumber }); }}
        />
      </label>
    </>
  );
}
