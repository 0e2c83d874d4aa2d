import { type ComponentType, type FunctionComponent } from 'preact';
import { useEffect, useState } from 'preact/hooks';

import { type ProblemError, toProblem } from '../api/problem';
import { ProblemNote } from '../ui/problem_note';

/** A view whose code is fetched when it is first shown: the start page need not
 * wait for all that draws in 3-D. */
export function lazyView<Props extends object>(
  load: () => Promise<ComponentType<Props>>,
): FunctionComponent<Props> {
  let loaded: ComponentType<Props> | null = null;
  return function LazyView(props) {
    const [View, setView] = useState<ComponentType<Props> | null>(() => loaded);
    const [problem, setProblem] = useState<ProblemError | null>(null);
    useEffect(() => {
      if (View) return;
      load().then(
        (view) => {
          loaded = view;
          setView(() => view);
        },
        (error: unknown) => { setProblem(toProblem(error)); },
      );
    }, []);
    if (problem) return <ProblemNote problem={problem} />;
    return View && <View {...props} />;
  };
}
