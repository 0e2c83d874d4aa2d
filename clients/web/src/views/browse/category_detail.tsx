import { getCategory, listGraspSpaces, listObjects } from '../../api/client';
import type { GraspSpace, StoredObject } from '../../api/types';
import { Link, navigate } from '../../app/navigation';
import { useResource } from '../../app/resource';
import { Thumbnail } from '../../scene/thumbnail';
import { formatCount, formatShare } from '../../ui/format';
import { partColour } from '../../ui/palette';
import { ProblemNote } from '../../ui/problem_note';
import { Swatch } from '../../ui/swatch';
import { describeObject } from '../../ui/object_name';
import { FilterForm } from '../grasps/filter_form';

async function loadCategory(name: string) {
  const [category, objects, spaces] = await Promise.all([
    getCategory(name),
    listObjects({ category: name }),
    listGraspSpaces({ category: name }),
  ]);
  return {
    category,
    examples: objects.items.filter(({ role }) => role === 'example'),
    novel: objects.items.filter(({ role }) => role === 'novel'),
    spaces: spaces.items,
  };
}

function ObjectCards({ objects }: { readonly objects: readonly StoredObject[] }) {
  return (
    <div class="cards small">
      {objects.map((object) => (
        <Link key={object.id} class="card" to={{ view: 'object', object: object.id }}>
          <Thumbnail object={object} label={describeObject(object)} />
          <span class="card-title">{describeObject(object)}</span>
          <span class="card-note">{formatCount(object.triangles)} triangles</span>
        </Link>
      ))}
    </div>
  );
}

function SpaceTable({ spaces }: { readonly spaces: readonly GraspSpace[] }) {
  return (
    <div class="scroll">
      <table>
        <thead>
          <tr>
            <th>Part</th>
            <th>Hand</th>
            <th class="number">Grasps</th>
            <th class="number">Coverage</th>
          </tr>
        </thead>
        <tbody>
          {spaces.map((space) => (
            <tr key={space.id}>
              <td>
                <Link to={{ view: 'grasps', filters: { grasp_space: space.id, stage: 'learned' } }}>
                  {space.part}
                </Link>
              </td>
              <td>{space.hand}</td>
              <td class="number">{formatCount(space.grasps)}</td>
              <td class="number">{formatShare(space.coverage)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

/** A category's parts, objects, what was learned, and a form to look for grasps. */
export function CategoryDetail({ name }: { readonly name: string }) {
  const loaded = useResource(name, () => loadCategory(name));
  if (loaded.problem) return <ProblemNote problem={loaded.problem} retry={loaded.reload} />;
  if (!loaded.value) return <div class="skeleton category-skeleton" aria-hidden="true" />;
  const { category, examples, novel, spaces } = loaded.value;
  return (
    <section class="category" aria-labelledby="category-title">
      <h2 id="category-title">{category.title}</h2>
      <ul class="part-notes">
        {category.parts.map(({ label, tasks = {} }, index) => (
          <li key={label}>
            <Swatch colour={partColour(index)} /> <strong>{label}</strong>
            {Object.entries(tasks).map(([task, note]) => (
              <span key={task} class="task">
                {task}: {note}
              </span>
            ))}
          </li>
        ))}
      </ul>
      <div class="columns">
        <div>
          <h3>Examples</h3>
          <ObjectCards objects={examples} />
          <h3>Novel objects</h3>
          {novel.length === 0 ? (
            <p class="empty">
              None yet: <Link to={{ view: 'upload' }}>upload one</Link>.
            </p>
          ) : (
            <ObjectCards objects={novel} />
          )}
        </div>
        <aside>
          <h3>Find grasps</h3>
          <FilterForm
            filters={{ category: name, stage: 'assembly', sort: 'merit' }}
            submitLabel="Show grasps"
            onSubmit={(filters) => {
              navigate({ view: 'grasps', filters });
            }}
          />
          <h3>Learned</h3>
          {spaces.length === 0 ? (
            <p class="empty">Nothing yet.</p>
          ) : (
            <SpaceTable spaces={spaces} />
          )}
          <p>
            <Link to={{ view: 'insight', category: name }}>Insight into {name}</Link>
          </p>
        </aside>
      </div>
    </section>
  );
}
