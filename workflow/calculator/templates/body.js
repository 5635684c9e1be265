// The surface of a body as solver/halfplane/surface.py has it: Barnett-Lothe tensors by the matrix sign function.
"use strict";

const filled = (rows, columns, value = 0) => Array.from({ length: rows }, () => new Array(columns).fill(value));
const dot = (a, b) => a.reduce((sum, one, k) => sum + one * b[k], 0);
const product = (A, B) => A.map((row) => B[0].map((_, j) => row.reduce((sum, one, k) => sum + one * B[k][j], 0)));
const transposed = (A) => A[0].map((_, j) => A.map((row) => row[j]));
const combined = (A, B, value) => A.map((row, i) => row.map((one, j) => value(one, B[i][j])));
const norm = (A) => Math.sqrt(A.flat().reduce((sum, one) => sum + one * one, 0));

// Columns X of A X = B, by Gauss' elimination with pivots from the column.
function solved(A, B) {
  const size = A.length, rows = A.map((row, i) => [...row, ...B[i]]);
  for (let k = 0; k < size; k++) {
    let best = k;
    for (let i = k + 1; i < size; i++) if (Math.abs(rows[i][k]) > Math.abs(rows[best][k])) best = i;
    if (!(Math.abs(rows[best][k]) > 0)) throw new Error("constants beyond what double precision can solve");
    [rows[k], rows[best]] = [rows[best], rows[k]];
    for (let i = k + 1; i < size; i++) {
      const share = rows[i][k] / rows[k][k];
      if (share) for (let j = k; j < rows[i].length; j++) rows[i][j] -= share * rows[k][j];
    }
  }
  const found = filled(size, B[0].length);
  for (let c = 0; c < B[0].length; c++)
    for (let i = size - 1; i >= 0; i--) {
      let rest = rows[i][size + c];
      for (let j = i + 1; j < size; j++) rest -= rows[i][j] * found[j][c];
      found[i][c] = rest / rows[i][i];
    }
  return found;
}

const inverse = (A) => solved(A, A.map((_, i) => A.map((__, j) => (i === j ? 1 : 0))));

// Why constants are inadmissible, as Material.check says it; nothing where they are not.
function fault(m, units) {
  const wrong = (name, rule) => `${name} = ${digits(m[name], 6)} ${units[name]}: ${rule}`;
  for (const name of ["c11", "c33", "c44", "eps11", "eps33", "mu11", "mu33"]) if (!(m[name] > 0)) return wrong(name, "must be positive");
  if (!(m.c13 ** 2 < m.c11 * m.c33)) return wrong("c13", "needs c13² < c11 c33 (positive definite stiffness)");
  if (m.c12 !== undefined) {
    if (!(Math.abs(m.c12) < m.c11)) return wrong("c12", "needs |c12| < c11 (positive definite stiffness)");
    if (!(2 * m.c13 ** 2 < (m.c11 + m.c12) * m.c33)) return wrong("c13", "needs 2 c13² < (c11 + c12) c33 (positive definite stiffness)");
  }
  for (const axis of ["11", "33"])
    if (!(m[`g${axis}`] ** 2 < m[`eps${axis}`] * m[`mu${axis}`])) return wrong(`g${axis}`, `needs g${axis}² < eps${axis} mu${axis}`);
  return "";
}

// Blocks Q, R, T of Stroh's formalism (theory, 2).
function blocks(m) {
  return {
    Q: [[m.c11, 0, 0, 0], [0, m.c44, m.e15, m.f15], [0, m.e15, -m.eps11, -m.g11], [0, m.f15, -m.g11, -m.mu11]],
    R: [[0, m.c13, m.e31, m.f31], [m.c44, 0, 0, 0], [m.e15, 0, 0, 0], [m.f15, 0, 0, 0]],
    T: [[m.c44, 0, 0, 0], [0, m.c33, m.e33, m.f33], [0, m.e33, -m.eps33, -m.g33], [0, m.f33, -m.g33, -m.mu33]],
  };
}

// What the surface answers: N and k of (2.2), (L^-1)_xx and c11 - h T3^-1 h, SI; `scale` brings all to order one.
function surface(m) {
  const scale = [m.c33, m.c33, m.eps33, m.mu33].map((one) => 1 / Math.sqrt(one));
  const scaled = (A) => A.map((row, i) => row.map((one, j) => one * scale[i] * scale[j]));
  const { Q, R, T } = Object.fromEntries(Object.entries(blocks(m)).map(([name, A]) => [name, scaled(A)]));
  const N2 = inverse(T), N1 = product(N2, transposed(R)).map((row) => row.map((one) => -one));
  const N3 = combined(product(R, N1), Q, (a, b) => -a - b), across = transposed(N1);
  let X = [...N1.map((row, i) => [...row, ...N2[i]]), ...N3.map((row, i) => [...row, ...across[i]])];
  let change = Infinity, step = 0;
  for (; step < 40; step++) {
    const inverted = inverse(X), size = Math.sqrt(norm(inverted) / norm(X)), mu = Math.abs(size - 1) < 0.1 ? 1 : size;
    const next = combined(X, inverted, (a, b) => (mu * a - b / mu) / 2);
    const largest = (A) => Math.max(...A.flat().map(Math.abs)), last = change;
    change = largest(combined(next, X, (a, b) => a - b)) / largest(next);
    X = next;
    if (change <= 1e-13 || (change <= 1e-8 && change >= last / 2)) break;
  }
  if (step === 40) throw new Error("not elliptic: a Stroh root is (nearly) real");
  X = combined(X, inverse(X), (a, b) => (a - b) / 2);
  const S = X.slice(0, 4).map((row) => row.slice(0, 4)), inverted = inverse(X.slice(4).map((row) => row.slice(0, 4).map((one) => -one)));
  const local = scaled(product(S, inverted)), nonlocal = scaled(combined(inverted, transposed(inverted), (a, b) => (a + b) / 2));
  const own = scale.slice(1), h = [m.c13, m.e31, m.f31];
  const T3 = T.slice(1).map((row) => row.slice(1)), share = solved(T3, h.map((one, i) => [one * own[i]])).map(([one], i) => one * own[i]);
  return {
    units: own,
    compliance: nonlocal.slice(1).map((row) => row.slice(1)),
    coupling: local.slice(1).map((row) => -row[0]),
    tangential: nonlocal[0][0],
    inPlane: m.c11 - dot(h, share),
  };
}

// N_p and k_p of an isotropic punch (theory, 9); without a modulus it is rigid.
function elasticity({ modulus, poisson } = {}) {
  if (!modulus) return { compliance: 0, coupling: 0 };
  return { compliance: (2 * (1 - poisson ** 2)) / modulus, coupling: (-(1 + poisson) * (1 - 2 * poisson)) / modulus };
}
