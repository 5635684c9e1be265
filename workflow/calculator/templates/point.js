// Balls, cones and discs on half-spaces in closed form, and on films from tables, as solver/point has them.
"use strict";

const EXPONENTS = { sphere: 2, cone: 1, disc: 0 };
const MEANS = { sphere: 2 / 3, cone: Math.PI / 4, disc: 1 }; // int_0^1 (1 - x^2)^(e/2) dx

// N without what couples fields that the punch does not conduct.
const conducted = (N, conducts) => N.map((row, i) => row.map((one, j) => (i === j || ((!i || conducts[i - 1]) && (!j || conducts[j - 1])) ? one : 0)));

// Loads and edge strengths of a half-space by u0 and the profile (points, 3).
function halfspace(compliance, profile) {
  const inverted = inverse(compliance), mean = MEANS[profile], rise = (EXPONENTS[profile] + 1) * mean;
  const wide = (factor, own) => inverted.map((row) => [...row, own * row[0]].map((one) => factor * one));
  return { compliance, loads: wide(4, mean), edges: wide(2 / Math.PI, rise), rates: filled(3, 4) };
}

// A contact of known radius under charges, or potentials where held: solver/point/contact.py.
function state(stiffness, profile, given, held, force) {
  const { compliance, loads, edges, rates } = stiffness, flat = profile === "disc", g = flat ? 0 : 1, e = EXPONENTS[profile];
  const rows = loads.map((row, i) => (held[i - 1] ? [0, 1, 2, 3].map((j) => +(j === i)) : row));
  if (!flat) rows[0] = edges[0];
  const right = [flat ? force : 0, ...given].map((one, i) => [one - g * rows[i][3]]);
  const displacement = solved(rows.map((row) => row.slice(0, 3)), right).map(([one]) => one), causes = [...displacement, g];
  const strengths = edges.map((row, i) => (i || flat ? dot(row, causes) : 0));
  const own = compliance.map((row) => dot(row, strengths));
  const released = [0, 1, 2].map((j) => Math.PI ** 2 * edges.reduce((sum, row, i) => sum + row[j] * own[i], 0));
  const opening = dot(rates[0], causes) + e * edges[0][3], plain = loads.map((row) => row.slice(0, 3));
  const tangent = flat ? plain : plain.map((row, i) => row.map((one, j) => one - (released[i] * edges[0][j]) / opening));
  const row = flat ? plain[0] : edges[0];
  const fixed = [1, 2].map((i) => [1, 2].map((j) => plain[i][j] - (plain[i][0] * row[j]) / row[0]));
  return { displacement, causes, loads: loads.map((line) => -dot(line, causes)), strengths, tangent, fixed };
}

// A half-space: its radius is that of the grounded contact, since the pressure knows nothing of charges.
function onHalfSpace(compliance, profile) {
  const stiffness = halfspace(compliance, profile), inverted = inverse(compliance);
  return {
    stiffness: () => stiffness,
    radius: (size, force) => (force / (state(stiffness, profile, [0, 0], [1, 1]).loads[0] * size)) ** (1 / (EXPONENTS[profile] + 1)),
    pressure: (x, at) => (profile === "disc" ? -at.state.strengths[0] / x : (2 / Math.PI) * inverted[0][0] * profilePressure(profile, x)),
  };
}

// rise e F of the half-space, over C a^(e-1).
function profilePressure(profile, x) {
  if (profile === "sphere") return 4 * x;
  return (Math.PI / 2) * Math.atanh(Math.min(x, 1 - 1e-16)); // a cone: arsinh(x / r)
}

/* Quantities of solver/point/quantities.py by their names, SI.

   `given`: material, punch, force, conducts, charges (T, J) or `voltage`; `film`: a table of a stack, with which the
   material is that of its top layer. */
function solvePoint(given) {
  const { material, punch, force, conducts, film } = given, body = surface(material), { profile } = punch, { units } = body;
  const N = conducted(body.compliance.map((row, i) => row.map((one, j) => (one + (i + j ? 0 : elasticity(punch).compliance)) / (units[i] * units[j]))), conducts);
  const flat = profile === "disc", e = EXPONENTS[profile], on = film ? onFilm(film, N, profile, given.thickness, conducts) : onHalfSpace(N, profile);
  if (film && profile === "sphere") return inAir(given, on);
  const coefficient = { sphere: 1 / (2 * punch.radius), cone: punch.slope, disc: punch.width / 2 }[profile];
  const size = coefficient / units[0], pressing = force * units[0];

  const contact = (charges, potentials, held) => {
    const under = (radius) => {
      const raised = flat ? 1 : size * radius ** e, load = raised * radius;
      const asked = [0, 1].map((q) => (held[q] ? potentials[q] / units[q + 1] / raised : (-charges[q] * units[q + 1]) / load));
      return { radius, raised, load, state: state(on.stiffness(radius), profile, asked, held, -pressing / load) };
    };
    const radius = flat ? coefficient : on.radius(size, pressing, under);
    const at = under(radius), found = at.state;
    return {
      ...at,
      displacement: found.displacement.map((one, i) => one * at.raised * units[i]),
      loads: found.loads.map((one, i) => (one * at.load) / units[i]),
      intensities: found.strengths.map((one, i) => (Math.sqrt(Math.PI * radius) * one * at.raised) / radius / units[i]),
      tangent: found.tangent.map((row, i) => row.map((one, j) => (one * radius) / (units[i] * units[j]))),
      fixed: found.fixed.map((row, i) => row.map((one, j) => (one * radius) / (units[i + 1] * units[j + 1]))),
    };
  };

  const charges = given.charges || [0, 0], driven = given.voltage !== undefined;
  const here = contact(charges, [given.voltage || 0, 0], [driven ? 1 : 0, 0]);
  const uncharged = contact([0, 0], [0, 0], [0, 0]), grounded = contact([0, 0], [0, 0], [1, 1]);
  const sizes = (A) => A.map((row, i) => 1 / Math.sqrt(Math.abs(row[i])));
  const turned = (A) => { const s = sizes(A); return inverse(A.map((row, i) => row.map((one, j) => one * s[i] * s[j]))).map((row, i) => row.map((one, j) => one * s[i] * s[j])); };
  const { radius, tangent } = here, free = turned(uncharged.tangent), over = here.raised / radius / units[0];

  const out = { contact_radius: radius, depth: -here.displacement[0], contact_stiffness: tangent[0][0], contact_stiffness_open: 1 / turned(tangent)[0][0] };
  const pressure = (x) => over * on.pressure(x, here); // x = sqrt(1 - r^2/a^2)
  if (profile === "sphere") out.peak_pressure = Math.max(...(film ? film.samples : [1]).map((x) => pressure(x)));
  [["electric_edge_intensity", "voltage", "voltage_per_force", "charge_per_force", "stroke_per_volt", "blocked_force_per_volt", "capacitance"],
    ["magnetic_edge_intensity", "magnetic_potential", "magnetic_potential_per_force", "flux_per_force", "stroke_per_ampere", "blocked_force_per_ampere", "permeance"]].forEach((names, q) => {
    if (!conducts[q] || (film && q)) return; // tables of films know no magnetic field
    const j = q + 1;
    [here.intensities[j], here.displacement[j], -free[j][0], grounded.loads[j] / force, tangent[0][j] / tangent[0][0], -tangent[0][j], -here.fixed[q][q]]
      .forEach((one, k) => { out[names[k]] = one; });
  });
  const tension = film || material.c12 === undefined ? undefined
    : (-(material.c11 - material.c12) * dot(body.coupling, here.loads)) / (2 * Math.PI * radius ** 2);
  return { ...out, edge_tension: tension, charge: here.loads[1], capacitance: out.capacitance, half: radius, centre: 0, pressure: (X) => pressure(Math.sqrt((1 - X) * (1 + X))), kind: "point" };
}

/* A ball on a film with air beside the contact, open, by the film's table. `on` has the pressure without air at the same
   radius: its course is drawn, with the largest pressure of the table. */
function inAir({ material, punch, force, film, thickness, voltage }, on) {
  if (voltage !== undefined) throw new Error("a film under a ball at a voltage");
  const { range, series } = film.air, load = (force * punch.radius) / (thickness ** 3 * material.c33);
  const places = [Math.log(load), Math.log(punch.radius / thickness) - Math.log(load) / 4];
  const [x, y] = range.map(([low, high], k) => {
    if (places[k] < low || places[k] > high) throw new Error(`this page's table of the film does not reach a ${(places[k] < low) === !k ? "narrower" : "wider"} contact`);
    return (2 * places[k] - low - high) / (high - low);
  });
  const value = (name) => clenshaw(series[name].map((row) => clenshaw(row, y)), x);
  const [radius, depth, peak, stiffness, capacitance] = ["contact_radius", "depth", "peak_pressure", "contact_stiffness", "capacitance"].map((name) => Math.exp(value(name)));
  const out = {
    contact_radius: radius * thickness, depth: depth * thickness, peak_pressure: peak, contact_stiffness: stiffness * thickness,
    capacitance: capacitance * thickness, charge_per_force: value("charge_per_force"), stroke_per_volt: value("stroke_per_volt"),
  };
  const half = out.contact_radius, at = { radius: half, state: state(on.stiffness(half), "sphere", [0, 0], [1, 1], 0) };
  const largest = Math.max(...film.samples.map((one) => on.pressure(one, at)));
  return {
    ...out,
    voltage: (value("charge_ratio") * out.charge_per_force * force) / out.capacitance, blocked_force_per_volt: -out.stroke_per_volt * out.contact_stiffness,
    charge: 0, half, centre: 0, pressure: (X) => (peak / largest) * on.pressure(Math.sqrt((1 - X) * (1 + X)), at), kind: "point",
  };
}

const clenshaw = (series, t) => {
  let one = 0, two = 0;
  for (let k = series.length - 1; k > 0; k--) [one, two] = [2 * t * one - two + series[k], one];
  return t * one - two + (series[0] || 0);
};

// d/dt of a Chebyshev series, as one.
function derived(series) {
  const found = new Array(Math.max(series.length - 1, 1)).fill(0);
  for (let k = series.length - 1; k > 0; k--) found[k - 1] = 2 * k * series[k] + (found[k + 1] || 0);
  found[0] /= 2;
  return found;
}

/* A film by its table: what the layers add to the half-space of the top at log(radius/thickness), in the channels
   displacement and voltage; causes are these and the profile: of a ball, of a cone; a disc has none. */
function onFilm(film, N, profile, thickness, conducts) {
  const own = halfspace(N, profile), [low, high] = film.range, rates = film.rates || (film.rates = film.loads.map(derived));
  const pressing = (2 / Math.PI) * inverse(N)[0][0], flat = profile === "disc", local = (place) => (2 * place - low - high) / (high - low);
  if (!conducts[0]) throw new Error("films are tabled under punches that conduct");
  const causes = [0, 1, 1, profile === "cone" ? 3 : 2];
  const wide = (rows, values) => rows.map((row, i) => row.map((one, j) => (i < 2 && j !== 2 && !(flat && j === 3) ? one + values[4 * i + causes[j]] : one)));
  const stiffness = (radius) => {
    const t = local(Math.log(radius / thickness)), values = film.loads.map((series) => clenshaw(series, t));
    const slopes = rates.map((series) => (clenshaw(series, t) * 2) / (high - low));
    return { compliance: N, loads: wide(own.loads, values), edges: wide(own.edges, values.slice(8)), rates: wide(filled(3, 4), slopes.slice(8)) };
  };
  const inside = (radius) => {
    const place = Math.log(radius / thickness);
    if (place < low - 1e-9 || place > high + 1e-9)
      throw new Error(`the contact is ${place < low ? "narrower" : "wider"} than this page's table of the film: ${digits(Math.exp(low), 2)} to ${digits(Math.exp(high), 2)} of radius over thickness`);
    return radius;
  };
  return {
    stiffness: (radius) => stiffness(inside(radius)),
    radius(size, force, under) {
      const excess = (place) => { const at = under(thickness * Math.exp(place)); return at.state.loads[0] * at.load - force; };
      const places = Array.from({ length: 41 }, (_, k) => low + ((high - low) * k) / 40), values = places.map(excess);
      const changes = values.map((one, k) => k && (one >= 0) !== (values[k - 1] >= 0)).reduce((all, one, k) => (one ? [...all, k] : all), []);
      if (!changes.length) inside(values[0] >= 0 ? thickness * Math.exp(low - 1) : thickness * Math.exp(high + 1));
      if (changes.length > 1) throw new Error("contacts of several radii carry the force: the voltage is too large for it");
      let [a, b] = [places[changes[0] - 1], places[changes[0]]];
      for (let step = 0; step < 60 && b - a > 1e-15; step++) {
        const middle = (a + b) / 2;
        if (excess(middle) < 0) a = middle; else b = middle;
      }
      return thickness * Math.exp((a + b) / 2);
    },
    pressure(x, at) {
      const t = local(Math.log(at.radius / thickness)), moved = [0, 1, 3].map((j) => at.state.causes[j]);
      const added = film.samples.map((_, k) => dot([0, 1, 3].map((j) => clenshaw(film.pressures[4 * k + causes[j]], t)), moved));
      const places = [0, ...film.samples], values = [0, ...added]; // nothing is added at the edge but its strength
      let k = places.findIndex((one) => one >= x - 1e-12);
      if (k < 1) k = k ? places.length - 1 : 1;
      const share = (x - places[k - 1]) / (places[k] - places[k - 1]), between = values[k - 1] + share * (values[k] - values[k - 1]);
      return between + (flat ? -at.state.strengths[0] / x : pressing * profilePressure(profile, x));
    },
  };
}
