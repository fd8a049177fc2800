// What belongs to one point: its eigenvalues or multipliers, its orbit in time and in a plane.
const BLUE = "#0072B2", VERMILION = "#D55E00";
const MOST = 3; // how far the multipliers' window reaches at most, so that the circle is seen

function complexText([re, im]) {
  const real = re.toPrecision(4);
  return im === 0 ? real : `${real} ${im < 0 ? "−" : "+"} ${Math.abs(im).toPrecision(4)} i`;
}

function drawSpectrum(box, branch, index, axes) {
  const roots = branch.spectrum[index];
  return branch.cycles ? drawMultipliers(box, roots) : drawEigenvalues(box, branch, roots, axes);
}

function rootTrace(roots, bad, inner) {
  return {
    x: roots.map((r) => r[0]), y: roots.map((r) => r[1]), mode: "markers", showlegend: false,
    marker: {
      size: 9, symbol: inner, line: { width: 1.5 },
      color: roots.map((r) => (bad(r) ? VERMILION : BLUE)),
    },
    hovertemplate: "%{x:.7g} %{y:+.7g} i<extra></extra>",
  };
}

// The window is one for the whole branch, so that a slider shows roots move, not axes.
function eigenvalueWindow(branch) {
  let [high, right, leading] = [0, 0, 1e-12];
  for (const roots of branch.spectrum) {
    for (const [re, im] of roots) {
      high = Math.max(high, Math.abs(im));
      right = Math.max(right, re);
    }
    for (const [re] of roots.slice(0, 2)) leading = Math.max(leading, Math.abs(re));
  }
  if (high < 1e-3 * leading) high = leading; // all real, but for rounding
  const left = Math.max(0.6 * high, right);
  return { x: [-1.15 * left, 1.15 * Math.max(right, 0.35 * left)], y: [-1.2 * high, 1.2 * high] };
}

function drawEigenvalues(box, branch, roots, axes) {
  const view = eigenvalueWindow(branch);
  const beyond = roots.filter((r) => r[0] < view.x[0]).length;
  const note = beyond ? `${beyond} more farther left` : "";
  return Plotly.react(box, [rootTrace(roots, (r) => r[0] > 0, "x-thin-open")], {
    ...small("eigenvalues", axes.rate, axes.frequency),
    xaxis: { ...AXIS, range: view.x, title: { text: axes.rate, standoff: 4 } },
    yaxis: { ...AXIS, range: view.y, title: { text: axes.frequency, standoff: 4 } },
    shapes: [{ type: "line", x0: 0, x1: 0, yref: "paper", y0: 0, y1: 1, line: { color: "#333", width: 1.2 }, layer: "between" }],
    annotations: remark(note),
  }, QUIET);
}

function drawMultipliers(box, roots) {
  const far = Math.min(MOST, Math.max(1.3, 1.15 * Math.max(0, ...roots.map((r) => Math.hypot(...r)))));
  const beyond = roots.filter((r) => Math.max(Math.abs(r[0]), Math.abs(r[1])) > far).map(complexText);
  const trivial = roots.length ? 0 : -1; // the trivial one comes first
  const outside = (r) => Math.hypot(...r) > 1 && r !== roots[trivial];
  return Plotly.react(box, [rootTrace(roots, outside, "x-thin-open")], {
    ...small("multipliers", "Re", "Im"),
    xaxis: { ...AXIS, range: [-far, far], title: { text: "Re", standoff: 4 } },
    yaxis: { ...AXIS, range: [-far, far], title: { text: "Im", standoff: 4 }, scaleanchor: "x" },
    shapes: [{ type: "circle", x0: -1, x1: 1, y0: -1, y1: 1, line: { color: "#333", width: 1.2 }, layer: "between" }],
    annotations: remark(roots.length ? beyond.length && `beyond: ${beyond.join(", ")}` : "not known here"),
  }, QUIET);
}

function small(title, x, y) {
  return {
    margin: { l: 10, r: 12, t: title ? 26 : 8, b: 8 }, font: FONT, hovermode: "closest",
    title: { text: title, font: { size: 13 }, y: 0.99, yanchor: "top" },
    xaxis: { ...AXIS, title: { text: x, standoff: 4 } }, yaxis: { ...AXIS, title: { text: y, standoff: 4 } },
  };
}

function remark(text) {
  if (!text) return [];
  return [{ text, xref: "paper", yref: "paper", x: 0.02, y: 0.98, xanchor: "left", yanchor: "top", showarrow: false, bgcolor: "rgba(255,255,255,.8)", font: { size: 11 } }];
}

// The orbit that was kept nearest to a point, or null.
function orbitAt(branch, index) {
  const places = Object.keys(branch.orbits).map(Number);
  if (!places.length) return null;
  const nearest = places.reduce((a, b) => (Math.abs(b - index) < Math.abs(a - index) ? b : a));
  return { index: nearest, ...branch.orbits[nearest] };
}

function periodOf(orbit) {
  return orbit.times[orbit.times.length - 1];
}

// A column of an orbit at a share of its period, between the samples by a straight line.
function sampled(orbit, column, share) {
  const { times } = orbit, now = share * periodOf(orbit);
  let [low, high] = [0, times.length - 1];
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (times[middle] <= now) low = middle; else high = middle;
  }
  const width = times[high] - times[low];
  return column[low] + (width > 0 ? (now - times[low]) / width : 0) * (column[high] - column[low]);
}

function mark(x, y) {
  return { x, y, mode: "markers", showlegend: false, hoverinfo: "skip", marker: { size: 10, color: VERMILION } };
}

function line(x, y) {
  return { x, y, mode: "lines", showlegend: false, line: { color: BLUE, width: 1.8 }, hovertemplate: "%{x:.5g}, %{y:.5g}<extra></extra>" };
}

function drawHistory(box, report, orbit, state, share) {
  const column = orbit.states[state];
  const now = [share * periodOf(orbit)];
  const layout = small("", report.axes.time, report.names[state].axis);
  layout.xaxis.range = [0, periodOf(orbit)];
  return Plotly.react(box, [line(orbit.times, column), mark(now, [sampled(orbit, column, share)])], layout, QUIET);
}

function drawPortrait(box, report, orbit, plane, share) {
  const [x, y] = plane;
  const layout = small("", report.names[x].axis, report.names[y].axis);
  const now = mark([sampled(orbit, orbit.states[x], share)], [sampled(orbit, orbit.states[y], share)]);
  return Plotly.react(box, [line(orbit.states[x], orbit.states[y]), now], layout, QUIET);
}

function moveMarks(boxes, orbit, state, plane, share) {
  const at = (name) => [sampled(orbit, orbit.states[name], share)];
  const now = [share * periodOf(orbit)];
  return Promise.all([
    Plotly.restyle(boxes.history, { x: [now], y: [at(state)] }, [1]),
    Plotly.restyle(boxes.portrait, { x: [at(plane[0])], y: [at(plane[1])] }, [1]),
  ]);
}
