const RADIUS = 0.035; // m
const TUBE = 0.012; // m

/** A ring as OBJ with 2 × around × across triangles, closed. */
export function makeTorus(around: number, across: number): string {
  const lines: string[] = [];
  for (let i = 0; i < around; ++i) {
    for (let k = 0; k < across; ++k) {
      const [u, v] = [(2 * Math.PI * i) / around, (2 * Math.PI * k) / across];
      const radius = RADIUS + TUBE * Math.cos(v);
      lines.push(`v ${radius * Math.cos(u)} ${radius * Math.sin(u)} ${TUBE * Math.sin(v)}`);
    }
  }
  const vertex = (i: number, k: number): number => (i % around) * across + (k % across) + 1;
  for (let i = 0; i < around; ++i) {
    for (let k = 0; k < across; ++k) {
      const [a, b, c, d] = [vertex(i, k), vertex(i + 1, k), vertex(i + 1, k + 1), vertex(i, k + 1)];
      lines.push(`f ${a} ${b} ${c}`, `f ${a} ${c} ${d}`);
    }
  }
  return lines.join('\n');
}
