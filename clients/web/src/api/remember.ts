/** Calls `load` once per arguments and gives the same promise from then on; what
 * failed is forgotten and tried again. For things that never change under their
 * name. */
export function remember<Names extends readonly string[], Value>(
  load: (...names: Names) => Promise<Value>,
): (...names: Names) => Promise<Value> {
  const known = new Map<string, Promise<Value>>();
  return (...names) => {
    const key = names.join('\n');
    const found = known.get(key);
    if (found) return found;
    const loading = load(...names);
    known.set(key, loading);
    loading.catch(() => known.delete(key));
    return loading;
  };
}
