import { getGrasp, getGraspSpace, getTransfer } from '../../api/client';
import { remember } from '../../api/remember';
import type { Attempt, ContactMap, Grasp, GraspStage, Transfer } from '../../api/types';

/** Where a grasp comes from. */
export interface Lineage {
  /** At which it was judged. */
  readonly friction: number;
  /** On the example; null for a learned grasp, which is its own source. */
  readonly source: Grasp | null;
  readonly contactMap: ContactMap | null;
  /** The same source grasp on the part and, replanned, on the whole object. */
  readonly stages: Readonly<Partial<Record<GraspStage, string>>>;
}

/** The server's, should a record not say it. */
const DEFAULT_FRICTION = 0.5;

// Records of what is done never change.
const loadTransfer = remember(getTransfer);
const loadGraspSpace = remember(getGraspSpace);
const loadGrasp = remember(getGrasp);

function readFriction(parameters: Transfer['parameters']): number {
  const friction = parameters['contact']?.['friction'];
  return typeof friction === 'number' ? friction : DEFAULT_FRICTION;
}

function isAttemptOf({ id, provenance }: Grasp, attempt: Attempt): boolean {
  return (
    attempt.source_grasp === provenance.source_grasp &&
    (attempt.transferred_grasp === id || attempt.assembled_grasp === id)
  );
}

/** Follows a grasp's provenance. */
export async function loadLineage(grasp: Grasp): Promise<Lineage> {
  const { transfer: transferId, source_grasp, grasp_space } = grasp.provenance;
  if (transferId === null || source_grasp === null) {
    const { parameters } = await loadGraspSpace(grasp_space);
    return { friction: readFriction(parameters), source: null, contactMap: null, stages: {} };
  }
  const [transfer, source] = await Promise.all([loadTransfer(transferId), loadGrasp(source_grasp)]);
  const attempt = transfer.attempts.find((each) => isAttemptOf(grasp, each));
  return {
    friction: readFriction(transfer.parameters),
    source,
    contactMap: transfer.contact_maps.find(({ novel_part }) => novel_part === grasp.part_id) ?? null,
    stages: {
      ...(typeof attempt?.transferred_grasp === 'string' && { transfer: attempt.transferred_grasp }),
      ...(typeof attempt?.assembled_grasp === 'string' && { assembly: attempt.assembled_grasp }),
    },
  };
}
