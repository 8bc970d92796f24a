"use strict";
// The page is complete without scripts. This script adds 3D models, a filter of objects, and a button that copies the methods text.
(() => {
  const MOST_OPEN = 6; // browsers limit the number of WebGL contexts
  const [SQUARES, LEADERS, NUMBERS] = [1, 4, 5]; // indices of their traces
  const LABEL = 0.09; // radius of a number, in object radii
  const [REACHES, TURNS] = [[0.15, 0.22, 0.3, 0.45], [0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6]]; // distances of numbers from squares in object radii, and directions in 30 degrees
  const MOST_ASIDE = 1.05; // largest distance of a number from the middle, in object radii: farther numbers leave the stage
  const opened = [];
  let library = null;

  async function unpack(base64) {
    const packed = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).arrayBuffer();
  }

  function loadPlotly() {
    library ??= unpack(document.getElementById("plotly-library").textContent).then((source) => {
      const script = document.createElement("script");
      script.textContent = new TextDecoder().decode(source);
      document.head.append(script);
      return window.Plotly;
    });
    return library;
  }

  async function readModel(figure) {
    const block = await unpack(figure.querySelector(".geometry").textContent);
    const { vertices, faces, touches } = figure.dataset;
    let offset = 0;
    const take = (Type, count) => new Type(block.slice(offset, offset += count * Type.BYTES_PER_ELEMENT));
    const scaled = (values) => Array.from(values, (value) => value / COORDINATE_STEPS);
    const keys = JSON.parse(figure.querySelector(".touch-keys").textContent);
    const [points, poses] = [3 * vertices, 10 * touches].map((count) => scaled(take(Int16Array, count)));
    return {
      vertices: points, corners: take(Uint32Array, 3 * faces), colours: take(Uint8Array, 3 * faces),
      keys: keys.map(([strategy, viewpoint, number, state], row) => ({
        strategy, viewpoint, number, state, pose: poses.slice(10 * row, 10 * row + 10),
      })),
    };
  }

  const column = (values, width, index) => Array.from({ length: values.length / width }, (_, row) => values[row * width + index]);

  function surfaceTrace(model) {
    const [i, j, k] = [0, 1, 2].map((index) => column(model.corners, 3, index));
    const [x, y, z] = [2, 0, 1].map((index) => column(model.vertices, 3, index));
    const facecolor = i.map((_, face) => `rgb(${model.colours.subarray(3 * face, 3 * face + 3).join()})`);
    return {
      type: "mesh3d", x, y, z, i, j, k, facecolor, flatshading: true, hoverinfo: "skip",
      lighting: { ambient: 0.55, diffuse: 0.65, specular: 0.05, roughness: 0.9 },
    };
  }

  // Corners of a touch's square, lifted a little so that the surface does not hide it.
  function square([px, py, pz, nx, ny, nz, tx, ty, tz, size]) {
    const [n, t] = [[nx, ny, nz], [tx, ty, tz]];
    const down = [t[1] * n[2] - t[2] * n[1], t[2] * n[0] - t[0] * n[2], t[0] * n[1] - t[1] * n[0]];
    return [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([a, b]) =>
      [px, py, pz].map((centre, axis) => centre + 0.006 * n[axis] + 0.5 * size * (a * t[axis] + b * down[axis])));
  }

  // Returns a position for each number beside its square, such that numbers cover no square as seen from the eye.
  function labelPlaces(poses, eye) {
    const [right, up, towards] = screenAxes(eye);
    const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    const centres = poses.map((pose) => ({ x: dot(pose, right), y: dot(pose, up), radius: 0.71 * pose[9] }));
    const taken = [];
    return poses.map((pose, index) => {
      const { x, y, radius } = centres[index];
      // Directions away from the object's middle come first: there the object is not behind a number.
      const places = REACHES.flatMap((reach) => TURNS.map((turn) => {
        const angle = Math.atan2(y, x) + (turn * Math.PI) / 6;
        return { a: (radius + reach) * Math.cos(angle), b: (radius + reach) * Math.sin(angle) };
      }));
      const room = ({ a, b }) => Math.min(
        0, MOST_ASIDE - Math.abs(x + a), MOST_ASIDE - Math.abs(y + b),
        ...centres.map((other) => Math.hypot(x + a - other.x, y + b - other.y) - other.radius - LABEL),
        ...taken.map((other) => Math.hypot(x + a - other.x, y + b - other.y) - 2 * LABEL),
      );
      const rooms = places.map(room);
      const best = places[rooms.indexOf(Math.max(...rooms))];
      taken.push({ x: x + best.a, y: y + best.b });
      return [0, 1, 2].map((axis) => pose[axis] + best.a * right[axis] + best.b * up[axis] + 0.25 * towards[axis]);
    });
  }

  // The object's y is up; Plotly's turntable turns about z.
  const axes = (rows) => Object.fromEntries(["x", "y", "z"].map((name, axis) => [name, rows.map((row) => row[(axis + 2) % 3])]));

  function touchTraces(chosen, eye, ink) {
    const squares = chosen.map((key) => square(key.pose));
    const outline = squares.flatMap((corners) => [...corners, corners[0], [null, null, null]]);
    const starts = squares.map((_, index) => 4 * index);
    const centres = chosen.map(({ pose }) => [0, 1, 2].map((axis) => pose[axis] + 0.01 * pose[axis + 3]));
    const labels = labelPlaces(chosen.map(({ pose }) => pose), eye);
    const leaders = labels.flatMap((label, index) => [centres[index], label, [null, null, null]]);
    const line = { type: "scatter3d", mode: "lines", hoverinfo: "skip" };
    return [
      {
        type: "mesh3d", ...axes(squares.flat()), i: starts.flatMap((s) => [s, s]), j: starts.flatMap((s) => [s + 1, s + 2]),
        k: starts.flatMap((s) => [s + 2, s + 3]), color: "#ffd23f", opacity: 0.55, hoverinfo: "none",
        lighting: { ambient: 1, diffuse: 0, specular: 0 },
      },
      { ...line, ...axes(outline), line: { color: "#111", width: 3 } },
      { ...line, ...axes(centres), line: { color: ink, width: 3 } },
      { ...line, ...axes(leaders), line: { color: ink, width: 1 } },
      {
        type: "scatter3d", mode: "markers+text", ...axes(labels), hoverinfo: "none",
        marker: { size: 10, color: "#111", line: { color: "#fff", width: 1 } },
        text: chosen.map((key) => String(key.number)), textfont: { color: "#fff", size: 12 }, textposition: "middle center",
      },
    ];
  }

  function eyeAt(azimuth, elevation, distance) {
    const [a, e] = [azimuth, elevation].map((degrees) => (degrees * Math.PI) / 180);
    return { x: distance * Math.cos(a) * Math.cos(e), y: distance * Math.sin(a) * Math.cos(e), z: distance * Math.sin(e) };
  }

  function whereIs({ x, y, z }) {
    const distance = Math.hypot(x, y, z);
    return [(Math.atan2(y, x) * 180) / Math.PI, (Math.asin(z / distance) * 180) / Math.PI, distance];
  }

  // Returns the directions right, up and towards the eye, as seen from the eye, in the object's axes.
  function screenAxes(eye) {
    const [azimuth, elevation] = whereIs(eye).map((degrees) => (degrees * Math.PI) / 180);
    const [s, c, rise, level] = [Math.sin(azimuth), Math.cos(azimuth), Math.sin(elevation), Math.cos(elevation)];
    return [[c, 0, -s], [-s * rise, level, -c * rise], [s * level, rise, c * level]];
  }

  // Shows the imprint of a touch, cut out of the strategy's sheet of imprints.
  function showImprint(figure, sheets, keys, key) {
    const felt = figure.querySelector(".felt");
    const columns = Math.max(...keys.filter(({ strategy }) => strategy === key.strategy).map(({ number }) => number));
    const picture = document.createElement("span");
    picture.className = "cell";
    picture.setAttribute("role", "img");
    picture.setAttribute("aria-label", `Imprint of touch ${key.number}`);
    const position = `${-96 * (key.number - 1)}px ${-96 * key.viewpoint}px`;
    picture.style.background = `url(${sheets[key.strategy]}) ${position} / ${96 * columns}px auto`;
    const edge = key.pose[9].toFixed(3);
    felt.replaceChildren(picture, `Touch ${key.number}: edge ${edge} object radii, contact ${key.state.replaceAll("_", " ")}`);
    felt.hidden = false;
    for (const button of figure.querySelectorAll(".touched button")) {
      button.setAttribute("aria-pressed", String(button.textContent === String(key.number)));
    }
  }

  // Adds one button per touch; focus, pointer and tap show the touch's imprint.
  function offerTouches(figure, chosen, show) {
    figure.querySelector(".felt").hidden = true;
    figure.querySelector(".touched").replaceChildren(...chosen.map((key) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = key.number;
      button.setAttribute("aria-label", `Imprint of touch ${key.number}`);
      button.setAttribute("aria-pressed", "false");
      for (const event of ["focus", "pointerenter", "click"]) button.addEventListener(event, () => show(key));
      return button;
    }));
  }

  function enlarge(figure, stage, Plotly, large) {
    figure.classList.toggle("large", large);
    const button = figure.querySelector(".enlarge");
    button.setAttribute("aria-pressed", String(large));
    Plotly.Plots.resize(stage);
    button.scrollIntoView({ block: "nearest" });
  }

  async function open(figure) {
    const stage = figure.querySelector(".stage");
    stage.setAttribute("aria-busy", "true");
    const [Plotly, model] = await Promise.all([loadPlotly(), readModel(figure)]);
    if (opened.length >= MOST_OPEN) close(opened.shift());
    const rest = [...stage.children];
    const sheets = JSON.parse(figure.querySelector(".imprint-sheets").textContent);
    const [strategies, viewpoints] = ["strategies", "viewpoints"].map((name) => figure.querySelector(`.${name}`));
    const chosen = () => model.keys.filter((key) => key.strategy === strategies.value && key.viewpoint === Number(viewpoints.value));
    const touches = () => touchTraces(chosen(), (stage.layout?.scene.camera ?? standing()).eye, getComputedStyle(document.body).color);
    const shown = () => [surfaceTrace(model), ...touches()];
    const show = (key) => showImprint(figure, sheets, model.keys, key);
    const offer = () => offerTouches(figure, chosen(), show);
    const standing = () => {
      const { azimuth, elevation } = viewpoints.selectedOptions[0].dataset;
      return { eye: eyeAt(Number(azimuth), Number(elevation), 1.15), up: { x: 0, y: 0, z: 1 }, center: { x: 0, y: 0, z: 0 } };
    };
    // The same range along all axes keeps the object's proportions and makes sizes comparable between objects. The range
    // leaves room for the numbers beside the object.
    const hidden = { visible: false, showspikes: false, range: [-1.4, 1.4], autorange: false };
    const layout = {
      scene: { xaxis: hidden, yaxis: hidden, zaxis: hidden, aspectmode: "cube", camera: standing(), dragmode: "turntable" },
      margin: { l: 0, r: 0, t: 0, b: 0 }, showlegend: false, paper_bgcolor: "rgba(0,0,0,0)",
    };
    stage.replaceChildren();
    stage.classList.add("open");
    stage.setAttribute("role", "img");
    stage.setAttribute("aria-label", `Model of ${figure.dataset.name} with numbered touches; rotate it with the buttons below or by dragging`);
    const settings = { displayModeBar: false, responsive: true, scrollZoom: false };
    await Plotly.newPlot(stage, shown(), layout, settings);
    const redraw = () => Plotly.react(stage, shown(), stage.layout, settings);
    const stand = (camera) => Plotly.relayout(stage, { "scene.camera": camera });
    const point = ({ points: [{ curveNumber, pointNumber }] }) => {
      if (curveNumber === SQUARES) show(chosen()[Math.floor(pointNumber / 4)]);
      if (curveNumber === NUMBERS) show(chosen()[pointNumber]);
    };
    // Numbers are placed for one position of the eye, so they are placed again when the eye moves.
    const renumber = () => {
      const moved = touches().slice(LEADERS - NUMBERS - 1);
      const places = ["x", "y", "z"].map((axis) => [axis, moved.map((trace) => trace[axis])]);
      Plotly.restyle(stage, Object.fromEntries(places), [LEADERS, NUMBERS]);
    };
    stage.on("plotly_relayout", renumber);
    stage.on("plotly_hover", point);
    stage.on("plotly_click", point);
    offer();
    strategies.onchange = () => redraw().then(offer);
    viewpoints.onchange = () => redraw().then(() => stand(standing())).then(offer);
    figure.querySelector(".enlarge").onclick = () => enlarge(figure, stage, Plotly, !figure.classList.contains("large"));
    figure.onkeydown = ({ key }) => { if (key === "Escape" && figure.classList.contains("large")) enlarge(figure, stage, Plotly, false); };
    for (const button of figure.querySelectorAll(".turns button:not(.enlarge)")) {
      button.onclick = () => {
        const [azimuth, elevation, distance] = whereIs(stage.layout.scene.camera.eye);
        const [across, up] = (button.dataset.turn ?? "0,0").split(",").map(Number);
        const height = Math.max(-85, Math.min(85, elevation + up));
        stand({ ...standing(), eye: eyeAt(azimuth + across, height, distance * Number(button.dataset.zoom ?? 1)) });
      };
    }
    figure.querySelector(".controls").hidden = false;
    stage.removeAttribute("aria-busy");
    opened.push({ figure, stage, rest, Plotly });
  }

  function close({ figure, stage, rest, Plotly }) {
    if (figure.classList.contains("large")) enlarge(figure, stage, Plotly, false);
    Plotly.purge(stage);
    figure.querySelector(".felt").hidden = true;
    for (const name of ["role", "aria-label"]) stage.removeAttribute(name);
    stage.classList.remove("open");
    stage.replaceChildren(...rest);
    figure.querySelector(".controls").hidden = true;
  }

  const drawsIn3D = typeof DecompressionStream === "function" && Boolean(window.WebGLRenderingContext);
  for (const figure of drawsIn3D ? document.querySelectorAll(".model") : []) {
    const button = figure.querySelector(".open");
    figure.querySelector(".stage p").textContent = "The model with its touches; it can be rotated.";
    figure.querySelector(".stage").classList.add("ready");
    button.hidden = false;
    button.addEventListener("click", () => {
      button.disabled = true;
      open(figure).catch((error) => {
        figure.querySelector(".stage").textContent = `This browser can't draw the model (${error.message}); the views below show it from all sides.`;
      }).finally(() => { button.disabled = false; });
    });
  }

  const filter = document.getElementById("object-filter");
  const objects = [...document.querySelectorAll(".object")];
  if (filter) {
    filter.closest(".filter").hidden = false;
    filter.addEventListener("input", () => {
      const wanted = filter.value.trim().toLowerCase();
      for (const object of objects) object.hidden = !object.dataset.name.toLowerCase().includes(wanted);
      document.getElementById("object-count").value = `${objects.filter((object) => !object.hidden).length} of ${objects.length}`;
    });
  }

  const copy = document.getElementById("copy-methods");
  if (copy && navigator.clipboard) {
    copy.hidden = false;
    copy.addEventListener("click", async () => {
      await navigator.clipboard.writeText(document.getElementById("methods-text").innerText.trim());
      document.getElementById("copied").textContent = "Copied.";
    });
  }

  // A link unfolds its target and everything around the target, and shows an object even if the filter hides it.
  const reveal = () => {
    const target = document.getElementById(location.hash.slice(1));
    if (!target) return;
    target.hidden = false;
    const fold = target.querySelector(":scope > .fold");
    if (fold) fold.open = true;
    for (let around = target.closest("details"); around; around = around.parentElement.closest("details")) around.open = true;
    target.scrollIntoView();
  };
  window.addEventListener("hashchange", reveal);
  reveal();
})();
