// What is shown, and what changes it: a click on the diagram, the slider, a row of the table.
const report = JSON.parse(document.getElementById("data").textContent);
const find = (id) => document.getElementById(id);
const shown = { branch: report.begins[0], index: report.begins[1], share: 0 };
const boxes = { history: find("history"), portrait: find("portrait") };
let playing = null;

function fill(select, names, chosen) {
  select.replaceChildren(...names.map((name) => new Option(report.names[name] ? report.names[name].text : name, name, false, name === chosen)));
}

function quantity() {
  return find("quantity").value;
}

function present() {
  const branch = report.branches[shown.branch];
  return { branch, orbit: orbitAt(branch, shown.index) };
}

function number(value, digits) {
  return value === null || value === undefined ? "-" : String(Number(value.toPrecision(digits)));
}

function tell({ branch, orbit }) {
  const { index } = shown;
  const value = (name, k) => `${report.names[name].text} = ${number(branch.active[name][k], 6)} ${report.names[name].unit}`.trim();
  const at = (k) => Object.keys(branch.active).map((name) => value(name, k)).join(", ");
  const unstable = branch.unstable[index];
  const label = branch.special.filter((p) => p.index === index).map((p) => p.name).join(", ");
  const told = [`point ${index + 1} of ${horizontalOf(branch).length}${label ? ` (${label})` : ""}`, at(index)];
  told.push(unstable < 0 ? "stability not known" : unstable ? `unstable (${unstable})` : "stable");
  if (branch.curves.period) told.push(`period ${number(branch.curves.period[0][index], 5)} ${report.time_unit}`.trim());
  if (orbit && orbit.index !== index) told.push(`orbit shown: the nearest kept, at ${at(orbit.index)}`);
  find("told").textContent = told.join(" · ");
}

function showRest(branch) {
  const rows = Object.entries(branch.states).map(([name, column]) =>
    `<tr><td>${report.names[name].symbol}</td><td>${number(column[shown.index], 7)}</td><td>${report.names[name].unit_html}</td></tr>`);
  const what = branch.kind === "equilibrium" ? "An equilibrium: nothing moves." : "No orbits were kept along this branch.";
  find("rest").innerHTML = `<p>${what}</p><table>${rows.join("")}</table>`;
}

function plane() {
  return [find("horizontal").value, find("vertical").value];
}

function swing({ branch, orbit }) {
  if (report.vehicle === null) return;
  const angles = anglesAt(report, branch, shown.index, orbit, shown.share);
  swingVehicle(find("top"), angles, Number(find("swing").value));
  const degrees = (angle) => `${(angle * DEGREES).toFixed(2)}°`;
  find("angles").innerHTML = `yaw ${degrees(angles.yaw)} about its mean<br>front <i>δ</i><sub>f</sub> ${degrees(angles.front)}<br>rear <i>δ</i><sub>c</sub> ${degrees(angles.rear)}`;
}

// Draw what belongs to the point that is shown.
async function show() {
  const now = present();
  find("branch").value = String(shown.branch);
  find("place").max = String(horizontalOf(now.branch).length - 1);
  find("place").value = String(shown.index);
  tell(now);
  const moves = now.orbit !== null;
  if (!moves) stop();
  for (const id of ["history", "history-choose", "right"]) find(id).hidden = !moves;
  find("rest").hidden = moves;
  if (!moves) showRest(now.branch);
  for (const row of document.querySelectorAll("tr[data-branch]")) {
    row.classList.toggle("chosen", Number(row.dataset.branch) === shown.branch && Number(row.dataset.index) === shown.index);
  }
  swing(now);
  await moveRing(find("diagram"), report, shown, quantity());
  await drawSpectrum(find("spectrum"), now.branch, shown.index, report.axes);
  if (!moves) return;
  await drawHistory(boxes.history, report, now.orbit, find("state").value, shown.share);
  await drawPortrait(boxes.portrait, report, now.orbit, plane(), shown.share);
}

// Show another point; while one is being drawn the next waits, and only the last one counts.
let drawing = null, again = false;
async function redraw() {
  again = true;
  if (drawing) return drawing;
  drawing = (async () => {
    while (again) {
      again = false;
      await show();
    }
    drawing = null;
    document.body.dataset.shown = `${shown.branch} ${shown.index}`;
  })();
  return drawing;
}

function choose(branch, index) {
  shown.branch = branch;
  shown.index = Math.max(0, Math.min(index, horizontalOf(report.branches[branch]).length - 1));
  return redraw();
}

function phase(share) {
  shown.share = share;
  find("phase").value = String(share);
  const now = present();
  swing(now);
  if (now.orbit && !drawing) moveMarks(boxes, now.orbit, find("state").value, plane(), share);
}

function stop() {
  if (playing !== null) cancelAnimationFrame(playing);
  playing = null;
  find("play").textContent = "▶ play";
  find("pace").textContent = "";
}

// Play in real time where a period can be followed, slower or faster where not.
function play() {
  if (playing !== null) return stop();
  find("play").textContent = "⏸ stop";
  let before = performance.now();
  const frame = (time) => {
    const { orbit } = present();
    if (!orbit) return stop();
    const period = Math.max(periodOf(orbit), 1e-9);
    const length = Math.min(Math.max(period, 1.5), 12);
    const pace = period / length;
    find("pace").textContent = Math.abs(pace - 1) < 0.01 ? "real time" : `${number(pace, 2)} × real time`;
    phase((shown.share + (time - before) / 1000 / length) % 1);
    before = time;
    playing = requestAnimationFrame(frame);
  };
  playing = requestAnimationFrame(frame);
}

function listen() {
  find("place").addEventListener("input", (event) => choose(shown.branch, Number(event.target.value)));
  find("branch").addEventListener("change", (event) => choose(Number(event.target.value), 0));
  find("quantity").addEventListener("change", () => drawDiagram(find("diagram"), report, shown, quantity()));
  for (const id of ["state", "horizontal", "vertical"]) find(id).addEventListener("change", redraw);
  find("phase").addEventListener("input", (event) => phase(Number(event.target.value)));
  find("play").addEventListener("click", play);
  find("swing").addEventListener("change", () => swing(present()));
  find("diagram").on("plotly_click", ({ points }) => {
    const place = points.map((point) => point.customdata).find(Boolean);
    if (place) choose(...place);
  });
  for (const row of document.querySelectorAll("tr[data-branch]")) {
    const go = () => choose(Number(row.dataset.branch), Number(row.dataset.index));
    row.addEventListener("click", () => { go(); scrollTo({ top: 0, behavior: "smooth" }); });
    row.addEventListener("keydown", (event) => { if (event.key === "Enter") go(); });
  }
}

async function begin() {
  const known = [...new Set(report.branches.flatMap((branch) => Object.keys(branch.curves)))];
  fill(find("quantity"), known, report.shown);
  const branches = report.branches.map((branch, k) => new Option(branch.name, String(k)));
  find("branch").replaceChildren(...branches);
  const first = report.states.includes(report.shown) ? report.shown : report.states[0];
  const rate = report.states.includes(`d${first}`) ? `d${first}` : report.states.find((name) => name !== first) || first;
  fill(find("state"), report.states, first);
  fill(find("horizontal"), report.states, first);
  fill(find("vertical"), report.states, rate);
  if (report.vehicle !== null) {
    find("vehicle").hidden = false;
    buildVehicle(find("top"), report.vehicle);
  }
  await drawDiagram(find("diagram"), report, shown, quantity());
  listen();
  await redraw();
  document.body.dataset.ready = "yes";
}

begin();
