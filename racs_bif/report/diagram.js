// The bifurcation diagram: curves, special points with labels that keep clear of each other, and
// the ring around the point that is shown.
const DASHES = { stable: "solid", unstable: "dash", unknown: "dot" };
const FONT = { family: 'system-ui, "DejaVu Sans", sans-serif', size: 12, color: "#111" };
const AXIS = { showline: true, mirror: true, ticks: "inside", zeroline: false, gridcolor: "#eee", linecolor: "#333", automargin: true, exponentformat: "power" };
const QUIET = { displaylogo: false, displayModeBar: false, responsive: true };

function curvesOf(branch, quantity) {
  return branch.curves[quantity] || [];
}

function horizontalOf(branch) {
  return branch.active[branch.parameter];
}

function diagramTraces(report, quantity) {
  const traces = [], titles = new Set();
  report.branches.forEach((branch, number) => {
    const x = horizontalOf(branch);
    for (const y of curvesOf(branch, quantity)) {
      for (const part of branch.parts) {
        const title = `${branch.title}, ${part.kind}`;
        const [from, to] = [part.first, part.last + 1];
        traces.push({
          x: x.slice(from, to), y: y.slice(from, to), name: title, legendgroup: title,
          showlegend: !titles.has(title), mode: "lines",
          line: { color: branch.colour, width: 1.8, dash: DASHES[part.kind] },
          customdata: x.slice(from, to).map((_, k) => [number, from + k]),
          hovertemplate: `${branch.name}, ${part.kind}<br>%{x:.6g}, %{y:.5g}<extra></extra>`,
        });
        titles.add(title);
      }
      traces.push(specialTrace(branch, number, x, y));
    }
  });
  return traces;
}

function specialTrace(branch, number, x, y) {
  const points = branch.special;
  return {
    x: points.map((p) => x[p.index]), y: points.map((p) => y[p.index]), mode: "markers",
    showlegend: false, customdata: points.map((p) => [number, p.index]),
    marker: { color: branch.colour, size: 9, symbol: points.map((p) => p.symbol), line: { color: "#fff", width: 1 } },
    text: points.map((p) => `${p.name}, ${p.title}`),
    hovertemplate: "%{text}<br>%{x:.8g}, %{y:.5g}<extra></extra>",
  };
}

function ring(report, shown, quantity) {
  const branch = report.branches[shown.branch];
  const curves = curvesOf(branch, quantity);
  return { x: curves.map(() => horizontalOf(branch)[shown.index]), y: curves.map((y) => y[shown.index]) };
}

function ringTrace(report, shown, quantity) {
  return {
    ...ring(report, shown, quantity), mode: "markers", showlegend: false, hoverinfo: "skip",
    marker: { size: 15, color: "#D55E00", symbol: "circle-open", line: { width: 2.5, color: "#D55E00" } },
  };
}

// Labels as annotations, each where it covers no marker, no other label and the fewest curve points.
function labels(report, quantity, box) {
  const axes = box._fullLayout;
  const pixel = (x, y) => [axes.xaxis.l2p(x), axes.yaxis.l2p(y)];
  const places = [], lines = [];
  report.branches.forEach((branch) => {
    const x = horizontalOf(branch), curves = curvesOf(branch, quantity);
    for (const y of curves) lines.push(...polyline(x, y, pixel));
    if (curves.length) for (const p of branch.special.filter((p) => p.named)) {
      const at = [x[p.index], curves[0][p.index]];
      if (at.every((value) => value !== null)) places.push({ text: p.name, at, spot: pixel(...at) });
    }
  });
  const taken = places.map(({ spot: [x, y] }) => [x - 5, y - 5, x + 5, y + 5]);
  return places.map(({ text, at, spot }) => {
    const best = roomiest(spot, 8 * text.length, taken, lines, axes);
    taken.push(best.area);
    return {
      x: at[0], y: at[1], text, ax: best.shift[0], ay: best.shift[1], showarrow: true, arrowhead: 0,
      arrowwidth: 0.7, arrowcolor: "#888", standoff: 4, font: { ...FONT, size: 11.5 }, captureevents: false,
    };
  });
}

function polyline(x, y, pixel) {
  const found = [];
  for (let k = 1; k < x.length; k += 1) {
    if (y[k] === null || y[k - 1] === null) continue;
    const [a, b] = [pixel(x[k - 1], y[k - 1]), pixel(x[k], y[k])];
    const count = Math.min(200, Math.ceil(Math.hypot(b[0] - a[0], b[1] - a[1]) / 4));
    for (let j = 0; j < count; j += 1) found.push([a[0] + (j / count) * (b[0] - a[0]), a[1] + (j / count) * (b[1] - a[1])]);
  }
  return found;
}

function roomiest([x, y], width, taken, lines, axes) {
  let best = null;
  for (const far of [16, 24, 34, 46, 60]) {
    for (let k = 0; k < 12; k += 1) {
      const shift = [far * Math.cos((k * Math.PI) / 6), -far * Math.sin((k * Math.PI) / 6)];
      const [cx, cy] = [x + shift[0], y + shift[1]];
      const area = [cx - width / 2 - 2, cy - 8, cx + width / 2 + 2, cy + 8];
      const outside = area[0] < 2 || area[1] < 2 || area[2] > axes.xaxis._length - 2 || area[3] > axes.yaxis._length - 2;
      const over = taken.filter((t) => t[0] < area[2] && t[2] > area[0] && t[1] < area[3] && t[3] > area[1]).length;
      const crossed = lines.filter(([u, v]) => u > area[0] && u < area[2] && v > area[1] && v < area[3]).length;
      const cost = 1e5 * outside + 1e3 * over + 20 * crossed + far;
      if (best === null || cost < best.cost) best = { cost, shift, area };
    }
  }
  return best;
}

function horizontalRange(report) {
  const ends = report.branches.map(horizontalOf).map((x) => [Math.min(...x), Math.max(...x)]);
  const [low, high] = [Math.min(...ends.map((e) => e[0])), Math.max(...ends.map((e) => e[1]))];
  const margin = 0.02 * (high - low) || 0.02 * Math.abs(low) || 1;
  return [low - margin, high + margin];
}

async function drawDiagram(box, report, shown, quantity) {
  const first = report.branches[0];
  const layout = {
    margin: { l: 10, r: 10, t: 34, b: 10 }, font: FONT, hovermode: "closest", hoverdistance: 80,
    legend: { orientation: "h", x: 0, y: 1.01, yanchor: "bottom", font: { size: 11 } },
    xaxis: { ...AXIS, range: horizontalRange(report), title: { text: report.names[first.parameter].axis, standoff: 6 } },
    yaxis: { ...AXIS, title: { text: report.names[quantity].axis, standoff: 6 } },
  };
  const traces = [...diagramTraces(report, quantity), ringTrace(report, shown, quantity)];
  await Plotly.react(box, traces, layout, QUIET);
  await Plotly.relayout(box, { annotations: labels(report, quantity, box) });
}

function moveRing(box, report, shown, quantity) {
  const { x, y } = ring(report, shown, quantity);
  return Plotly.restyle(box, { x: [x], y: [y] }, [box.data.length - 1]);
}
