// The vehicle from above, forward is up. Angles are counter-clockwise; SVG's are clockwise.
const TRACK = 0.72, OVERHANG = 0.75, DEGREES = 180 / Math.PI;

function wheel(x, y) {
  return `<rect class="wheel" x="${x - 0.1}" y="${y - 0.32}" width="0.2" height="0.64" rx="0.06"/>`;
}

function buildVehicle(svg, { a, b, c }) {
  const hinge = b - c, front = -a;
  svg.setAttribute("viewBox", `-1.7 ${front - OVERHANG - 0.5} 3.4 ${a + b + 2 * OVERHANG + 1}`);
  svg.innerHTML = `<line class="road" x1="0" x2="0" y1="${front - 2}" y2="${b + 2}"/>
<g class="car"><line class="axle" x1="${-TRACK}" x2="${TRACK}" y1="${front}" y2="${front}"/>
<rect class="body" x="-0.85" y="${front - OVERHANG}" width="1.7" height="${a + b + 2 * OVERHANG}" rx="0.35" fill-opacity="0.75"/>
<path class="glass" d="M-.6 ${front + 0.75} Q0 ${front + 0.45} .6 ${front + 0.75} L.5 ${front + 1.15} H-.5 Z"/>
<g class="front left" data-centre="${-TRACK} ${front}">${wheel(-TRACK, front)}</g>
<g class="front right" data-centre="${TRACK} ${front}">${wheel(TRACK, front)}</g>
<g class="rear" data-centre="0 ${hinge}"><path d="M0 ${hinge} L${-TRACK} ${b} H${TRACK} Z"/>${wheel(-TRACK, b)}${wheel(TRACK, b)}</g>
<circle class="hinge" cx="0" cy="${hinge}" r="0.08"/></g>`;
}

function turn(part, angle, centre) {
  part.setAttribute("transform", `rotate(${(-angle * DEGREES).toFixed(3)} ${centre})`);
}

function swingVehicle(svg, { yaw, front, rear }, factor) {
  turn(svg.querySelector(".car"), factor * yaw, "0 0");
  for (const part of svg.querySelectorAll(".front")) turn(part, factor * front, part.dataset.centre);
  const axle = svg.querySelector(".rear");
  turn(axle, factor * rear, axle.dataset.centre);
}

// The angles of the vehicle at a point of a branch and a share of the period.
function anglesAt(report, branch, index, orbit, share) {
  const steered = branch.active.delta_f;
  const front = steered ? steered[index] : report.vehicle.delta_f;
  if (orbit === null) return { yaw: 0, front, rear: branch.states.delta_c ? branch.states.delta_c[index] : 0 };
  return { yaw: sampled(orbit, orbit.yaw, share), front, rear: sampled(orbit, orbit.states.delta_c, share) };
}
