import { useState } from 'preact/hooks';

import { renamePart } from '../../api/client';
import { type ProblemError, toProblem } from '../../api/problem';
import type { StoredObject } from '../../api/types';
import type { ColouredPart } from '../../scene/object_model';
import { CascadeQuestion } from '../../ui/cascade_question';
import { formatQuantity, formatShare } from '../../ui/format';
import { Swatch } from '../../ui/swatch';

interface PartsPanelProps {
  readonly object: StoredObject;
  readonly parts: readonly ColouredPart[];
  /** That the category has. */
  readonly labels: readonly string[];
  readonly onHighlight: (label: string | null) => void;
  readonly onChange: (object: StoredObject) => void;
}

interface Renaming {
  readonly id: string;
  readonly label: string;
  readonly problem: ProblemError | null;
}

/** The parts; the label of each can be another of the category's. */
export function PartsPanel({ object, parts, labels, onHighlight, onChange }: PartsPanelProps) {
  const [renaming, setRenaming] = useState<Renaming | null>(null);
  const rename = async (id: string, label: string, cascade: boolean): Promise<void> => {
    setRenaming({ id, label, problem: null });
    try {
      onChange(await renamePart(id, label, cascade));
      setRenaming(null);
    } catch (error) {
      setRenaming({ id, label, problem: toProblem(error) });
    }
  };
  if ((object.parts ?? []).length === 0) {
    return (
      <section>
        <h2>Parts</h2>
        <p class="empty">It has none: it was stored without a category.</p>
      </section>
    );
  }
  return (
    <section>
      <h2>Parts</h2>
      <div class="scroll">
        <table class="parts">
          <thead>
            <tr>
              <th>Label</th>
              <th class="number">Area (m²)</th>
              <th class="number">Volume (m³)</th>
              <th class="number">Confidence</th>
            </tr>
          </thead>
          <tbody>
            {parts.map(({ part, colour }) => (
              <tr
                key={part.id}
                onPointerEnter={() => { onHighlight(part.label); }}
                onPointerLeave={() => { onHighlight(null); }}
              >
                <td>
                  <span class="part-name">
                    <Swatch colour={colour} />
                    <select
                      aria-label={`Label of the part ${part.label}`}
                      value={renaming?.id === part.id ? renaming.label : part.label}
                      onFocus={() => { onHighlight(part.label); }}
                      onBlur={() => { onHighlight(null); }}
                      onChange={(event) => { void rename(part.id, event.currentTarget.value, false); }}
                    >
                      {[...new Set([part.label, ...labels])].map((label) => (
                        <option key={label} value={label}>{label}</option>
                      ))}
                    </select>
                  </span>
                </td>
                <td class="number">{formatQuantity(part.area)}</td>
                <td class="number">{formatQuantity(part.volume)}</td>
                <td class="number">{formatShare(part.confidence)}</td>
              </tr>
            ))}
          </tbody>
        </table>
      </div>
      {renaming?.problem && (
        <CascadeQuestion
          problem={renaming.problem}
          onCascade={() => { void rename(renaming.id, renaming.label, true); }}
          onCancel={() => { setRenaming(null); }}
        />
      )}
    </section>
  );
}
