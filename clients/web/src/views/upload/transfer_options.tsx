/** What a transfer is asked for, as POST /v1/grasps names it. */
export interface TransferSettings {
  readonly sources: number;
  readonly friction: number;
}

/** The server's. */
export const DEFAULT_SETTINGS: TransferSettings = { sources: 40, friction: 0.5 };

interface TransferOptionsProps {
  readonly settings: TransferSettings;
  readonly onChange: (settings: TransferSettings) => void;
}

export function TransferOptions({ settings, onChange }: TransferOptionsProps) {
  return (
    <>
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
