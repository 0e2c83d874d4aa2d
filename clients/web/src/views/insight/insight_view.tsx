import { listCategories } from '../../api/client';
import { navigate } from '../../app/navigation';
import { useResource } from '../../app/resource';
import type { Route } from '../../app/routes';
import { ProblemNote } from '../../ui/problem_note';
import { SelectField } from '../../ui/select_field';
import { CategoryInsight } from './category_insight';
import { TransferInsight } from './transfer_insight';

type InsightRoute = Extract<Route, { view: 'insight' }>;

/** Charts about a category, or about one transfer. */
export function InsightView({ route }: { readonly route: InsightRoute }) {
  const categories = useResource('categories', listCategories);
  if (route.transfer !== undefined) return <TransferInsight key={route.transfer} id={route.transfer} />;
  const names = categories.value?.items.map(({ name }) => name) ?? [];
  const category = route.category ?? names[0];
  return (
    <div class="page">
      <div class="page-head">
        <h1>Insight</h1>
        <SelectField
          label="Category"
          value={category ?? ''}
          options={names.map((name) => [name, name] as const)}
          onChange={(name) => { navigate({ view: 'insight', category: name }); }}
        />
      </div>
      {categories.problem && <ProblemNote problem={categories.problem} retry={categories.reload} />}
      {category !== undefined && <CategoryInsight key={category} name={category} />}
    </div>
  );
}
