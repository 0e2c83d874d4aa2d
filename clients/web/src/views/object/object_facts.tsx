import type { StoredObject } from '../../api/types';
import { Facts, type Fact } from '../../ui/facts';
import { formatCount, formatNumber, formatPoint, formatQuantity, formatShare, formatWords } from '../../ui/format';

function describeFile({ file_name, format, units, bytes, triangles, work_triangles }: StoredObject): Fact[] {
  return [
    ['File', file_name || '–'],
    ['Format', `${format}, in ${units === 'file' ? 'its own unit' : units}`],
    ['Size', `${formatCount(bytes)} bytes`],
    ['Triangles', formatCount(triangles)],
    ['… searched on', formatCount(work_triangles)],
  ];
}

function describeShape({ bounding_box: { min, max }, mass_properties: mass }: StoredObject): Fact[] {
  const size = max.map((most, axis) => (most - (min[axis] ?? 0)).toFixed(4));
  return [
    ['Extent', `${size.join(' × ')} m`],
    ['Volume', formatQuantity(mass.volume, 'm³')],
    ['Area', formatQuantity(mass.area, 'm²')],
    ['Centre of mass', `${formatPoint(mass.centre)} m`],
    ['Largest radius', formatQuantity(mass.max_radius, 'm')],
  ];
}

function describeCloud({ cloud }: StoredObject): Fact[] {
  if (!cloud) return [];
  return [
    ['Points', formatCount(cloud.points)],
    ['… left out', formatCount(cloud.outliers)],
    ['Spacing', formatQuantity(cloud.spacing, 'm')],
    ['Noise', formatQuantity(cloud.noise, 'm')],
    ['Seen', `${formatShare(cloud.seen_share)}${cloud.one_sided ? ', from one side' : ''}`],
  ];
}

function describeSegmentation({ segmentation }: StoredObject): Fact[] {
  if (!segmentation) return [];
  return [
    ['Method', formatWords(segmentation.method)],
    ['Verdict', segmentation.verdict],
    ['Similarity', formatNumber(segmentation.similarity, 2)],
  ];
}

/** Statistics, mass properties, repairs, and how it came by its parts. */
export function ObjectFacts({ object }: { readonly object: StoredObject }) {
  const cloud = describeCloud(object);
  const warnings = object.segmentation?.warnings ?? [];
  return (
    <>
      <section>
        <h2>Shape</h2>
        <Facts facts={describeShape(object)} />
      </section>
      <section>
        <h2>Repairs</h2>
        {object.repairs.length === 0 ? (
          <p class="empty">None was needed.</p>
        ) : (
          <ul class="plain-list">
            {object.repairs.map((repair) => (
              <li key={repair}>{repair}</li>
            ))}
          </ul>
        )}
      </section>
      <section>
        <h2>File</h2>
        <Facts facts={describeFile(object)} />
      </section>
      {cloud.length > 0 && (
        <section>
          <h2>Point cloud</h2>
          <Facts facts={cloud} />
        </section>
      )}
      {object.segmentation && (
        <section>
          <h2>Segmentation</h2>
          <Facts facts={describeSegmentation(object)} />
          {warnings.map((warning) => (
            <p class="warning" key={warning}>{warning}</p>
          ))}
        </section>
      )}
    </>
  );
}
