import type { Grasp } from '../../api/types';
import { Link } from '../../app/navigation';
import { Facts, type Fact } from '../../ui/facts';
import { formatLength, formatNumber, formatPoint, formatShare, formatWords } from '../../ui/format';
import { CopyJson } from './copy_json';

function describeQuality({ quality }: Grasp): Fact[] {
  return [
    ['Quality ε', formatNumber(quality.epsilon)],
    ['… of the source', formatNumber(quality.example_epsilon)],
    ['… of open-close', formatNumber(quality.open_close_epsilon)],
    ['Volume', formatNumber(quality.volume)],
    ['Hybrid measure', formatNumber(quality.hybrid, 1)],
    ['Robust', formatShare(quality.robust)],
    ['Grip', formatShare(quality.grip)],
    ['Held in simulation', quality.physical === null ? 'not tried' : formatShare(quality.physical)],
  ];
}

function describePlace({
  X_OH: { position, orientation }, penetration_m, pregrasp, clearances,
}: Grasp): Fact[] {
  const { x, y, z, w } = orientation;
  return [
    ['Position', `${formatPoint(position)} m`],
    ['Orientation x y z w', formatPoint([x, y, z, w])],
    ['Pre-grasp', `${formatLength(pregrasp.distance)} back`],
    ['Penetration', formatLength(penetration_m)],
    ...Object.entries(clearances).map(([part, gap]): Fact => [`Gap to the ${part}`, formatLength(gap)]),
  ];
}

function JointTable({ grasp: { joints, pregrasp } }: { readonly grasp: Grasp }) {
  return (
    <div class="scroll">
      <table>
        <thead>
          <tr><th>Joint</th><th class="number">Pre-grasp</th><th class="number">Grasp</th></tr>
        </thead>
        <tbody>
          {Object.entries(joints).map(([name, value]) => (
            <tr key={name}>
              <td>{name}</td>
              <td class="number">{formatNumber(pregrasp.joints[name] ?? null)} rad</td>
              <td class="number">{formatNumber(value)} rad</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

function ContactTable({ grasp: { contacts } }: { readonly grasp: Grasp }) {
  return (
    <div class="scroll">
      <table>
        <thead>
          <tr><th>Link</th><th>p_O (m)</th></tr>
        </thead>
        <tbody>
          {contacts.map(({ link, p_O, seen }, index) => (
            <tr key={index}>
              <td>{link}{!seen && ' (unseen)'}</td>
              <td class="number">{formatPoint(p_O)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

/** A grasp in numbers. */
export function GraspDetails({ grasp, source }: { readonly grasp: Grasp; readonly source: Grasp | null }) {
  return (
    <>
      <header class="panel-head">
        <h2>
          {grasp.part} · {formatWords(grasp.stage)}
        </h2>
        <p class="subtitle">
          <Link to={{ view: 'object', object: grasp.object }}>the object</Link>
          {source && (
            <>
              {' '}· from the{' '}
              <Link to={{ view: 'grasps', filters: { grasp_space: source.provenance.grasp_space, stage: 'learned' }, grasp: source.id }}>
                source grasp
              </Link>
            </>
          )}
          {source && grasp.provenance.transfer !== null && (
            <>
              {' '}· <Link to={{ view: 'insight', transfer: grasp.provenance.transfer }}>its transfer</Link>
            </>
          )}
        </p>
        <CopyJson value={grasp} />
      </header>
      <section>
        <h3>Quality</h3>
        <Facts facts={describeQuality(grasp)} />
      </section>
      <section>
        <h3>Hand H in frame O</h3>
        <Facts facts={describePlace(grasp)} />
      </section>
      <section>
        <h3>Joints</h3>
        <JointTable grasp={grasp} />
      </section>
      <section>
        <h3>Contacts</h3>
        <ContactTable grasp={grasp} />
      </section>
    </>
  );
}
