import { listCategories, listObjects } from '../../api/client';
import { Link } from '../../app/navigation';
import { useResource } from '../../app/resource';
import type { Route } from '../../app/routes';
import { Thumbnail } from '../../scene/thumbnail';
import { ProblemNote } from '../../ui/problem_note';
import { CategoryDetail } from './category_detail';

type BrowseRoute = Extract<Route, { view: 'browse' }>;

async function loadCategories() {
  const [categories, objects] = await Promise.all([listCategories(), listObjects({})]);
  return categories.items.map((category) => {
    const own = objects.items.filter((object) => object.category === category.name);
    return {
      category,
      example: own.find(({ role }) => role === 'example') ?? own[0],
      numExamples: own.filter(({ role }) => role === 'example').length,
      numNovel: own.filter(({ role }) => role === 'novel').length,
    };
  });
}

function SkeletonCards() {
  return (
    <div class="cards" aria-hidden="true">
      {[0, 1, 2, 3].map((index) => (
        <div class="card skeleton" key={index} />
      ))}
    </div>
  );
}

export function BrowseView({ route }: { readonly route: BrowseRoute }) {
  const categories = useResource('categories', loadCategories);
  return (
    <div class="page">
      <h1>Categories</h1>
      {categories.problem && <ProblemNote problem={categories.problem} retry={categories.reload} />}
      {categories.loading && !categories.value && <SkeletonCards />}
      {categories.value?.length === 0 && (
        <p class="empty">
          Nothing is stored yet. <code>graspdb populate data</code> brings the bundled categories in.
        </p>
      )}
      <div class="cards">
        {categories.value?.map(({ category, example, numExamples, numNovel }) => (
          <Link
            key={category.name}
            class="card"
            to={{ view: 'browse', category: category.name }}
            current={route.category === category.name}
          >
            {example ? (
              <Thumbnail object={example} label={`Example of ${category.title}`} />
            ) : (
              <div class="thumbnail" />
            )}
            <span class="card-title">{category.title}</span>
            <span class="card-note">
              {numExamples} {numExamples === 1 ? 'example' : 'examples'} · {numNovel} novel
            </span>
          </Link>
        ))}
      </div>
      {route.category !== undefined && <CategoryDetail key={route.category} name={route.category} />}
    </div>
  );
}
