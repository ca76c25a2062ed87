// Plays a recorded scene in Meshcat's viewer. Meshcat's own animations move rigid objects only;
// a cable bends, so each frame sets the links' poses and bends the cable's tube anew.
"use strict";
(() => {
  const THREE = MeshCat.THREE;
  const byId = (id) => document.getElementById(id);
  const recording = JSON.parse(byId("recording").textContent);
  const bytes = (text) => Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const whole = (text) => new Int16Array(bytes(text).buffer);

  const viewer = new MeshCat.Viewer(byId("pane"));
  recording.commands.forEach((command) => viewer.handle_command_bytearray(bytes(command)));

  const {times, links, width} = recording;
  const data = whole(recording.frames);
  const traces = recording.traces.map(([time, points]) => [time, vectors(whole(points))]);
  const linkObjects = links.map((name) => viewer.scene_tree.find(["robot", name]).object);
  // A cell without a cable has no trace either.
  const cables = recording.cables.map((count, number) => ({
    mesh: viewer.scene_tree.find([number ? `cable_${number}` : "cable", "<object>"]).object, count,
  }));
  const trace = viewer.scene_tree.find(["trace", "<object>"]).object;
  const end = times[times.length - 1];
  let now = 0, playing = false, last = null, shownTrace = null;
  const shownOverlays = {};

  function vectors(numbers) {
    const points = [];
    for (let i = 0; i < numbers.length; i += 3) {
      points.push(new THREE.Vector3(numbers[i], numbers[i + 1], numbers[i + 2])
        .multiplyScalar(recording.metre));
    }
    return points;
  }

  function bend(mesh, points, radius) {
    const curve = new THREE.CatmullRomCurve3(points, false, "catmullrom");
    curve.arcLengthDivisions = 2 * points.length;
    mesh.geometry.dispose();
    mesh.geometry = new THREE.TubeGeometry(curve, 2 * points.length, radius, recording.sides);
  }

  // The last entry of [[time, value], ...] that is not later than a time.
  function latest(entries, time) {
    let low = 0, high = entries.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (entries[middle][0] <= time) low = middle + 1; else high = middle;
    }
    return low === 0 ? null : entries[low - 1][1];
  }

  const frames = times.map((time, index) => [time, index]);

  function show(time) {
    now = Math.min(Math.max(time, 0), end);
    const first = latest(frames, now) ?? 0;
    const second = Math.min(first + 1, times.length - 1);
    const share = second > first ? (now - times[first]) / (times[second] - times[first]) : 0;
    const a = data.subarray(first * width, (first + 1) * width);
    const b = data.subarray(second * width, (second + 1) * width);
    const mixed = Float32Array.from(a, (value, i) => value + share * (b[i] - value));

    linkObjects.forEach((object, i) => {
      const at = 7 * i;
      object.position.set(mixed[at], mixed[at + 1], mixed[at + 2])
        .multiplyScalar(recording.metre);
      const turn = (from) => new THREE.Quaternion(from[at + 3], from[at + 4], from[at + 5],
        from[at + 6]).normalize();
      object.quaternion.copy(turn(a)).slerp(turn(b), share);
    });
    let from = 7 * links.length;
    for (const {mesh, count} of cables) {
      bend(mesh, vectors(mixed.subarray(from, from + 3 * count)), recording.cable_radius);
      from += 3 * count;
    }

    const points = latest(traces, now) ?? [];
    trace.visible = points.length > 0;
    if (trace.visible && points !== shownTrace) bend(trace, points, recording.trace_radius);
    shownTrace = points;

    for (const [name, changes] of Object.entries(recording.overlays)) {
      const command = latest(changes, now);
      if (command === (shownOverlays[name] ?? null)) continue;
      if (command) viewer.handle_command_bytearray(bytes(command));
      else viewer.delete_path(["overlays", name]);
      shownOverlays[name] = command;
    }

    byId("note").textContent = latest(recording.captions, now) ?? "";
    byId("slider").value = now;
    byId("clock").textContent = `${now.toFixed(1)} s of ${end.toFixed(1)} s`;
    viewer.set_dirty();
  }

  function play(on) {
    if (on && now >= end) now = 0;
    playing = on;
    last = null;
    byId("play").innerHTML = on ? "&#10074;&#10074;" : "&#9654;";
  }

  function advance(stamp) {
    if (playing) {
      if (last !== null) show(now + byId("rate").value * (stamp - last) / 1000);
      last = stamp;
      if (now >= end) play(false);
    }
    requestAnimationFrame(advance);
  }

  byId("slider").max = end;
  byId("slider").addEventListener("input", (event) => { play(false); show(+event.target.value); });
  byId("play").addEventListener("click", () => play(!playing));
  document.addEventListener("keydown", (event) => {
    const step = {ArrowLeft: -1, ArrowRight: 1}[event.key];
    if (event.key === " ") play(!playing);
    else if (step) { play(false); show(now + step); }
    else return;
    event.preventDefault();
  });
  // A page around this one says where in time to stand, on the cell's clock.
  window.addEventListener("message", (event) => {
    if (event.origin !== location.origin || typeof event.data?.seek_s !== "number") return;
    play(false);
    show(event.data.seek_s - recording.start);
  });
  // #t=12.5 in the address opens the page at that time, paused.
  const asked = /#t=([\d.]+)/.exec(location.hash);
  show(asked ? +asked[1] : 0);
  play(!asked);
  requestAnimationFrame(advance);
})();
