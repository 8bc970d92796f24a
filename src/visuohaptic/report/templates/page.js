"use strict";
// The page is complete without scripts. This one adds 3D models, a filter of objects, and a button that copies the methods text.
(() => {
  const MOST_OPEN = 6; // browsers limit the number of WebGL contexts
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
    let place = 0;
    const take = (Type, count) => {
      const end = place + count * Type.BYTES_PER_ELEMENT;
      const values = new Type(block.slice(place, end));
      place = end;
      return values;
    };
    const scaled = (values) => Array.from(values, (value) => value / COORDINATE_STEPS);
    const keys = JSON.parse(figure.querySelector(".touch-keys").textContent);
    const model = {
      vertices: scaled(take(Int16Array, 3 * vertices)),
      touches: scaled(take(Int16Array, 10 * touches)),
      corners: take(Uint32Array, 3 * faces),
      colours: take(Uint8Array, 3 * faces),
    };
    model.keys = keys.map(([strategy, viewpoint, number, state], row) => ({
      strategy, viewpoint, number, state, pose: model.touches.slice(10 * row, 10 * row + 10),
    }));
    return model;
  }

  const column = (values, width, place) => Array.from({ length: values.length / width }, (_, row) => values[row * width + place]);

  function surfaceTrace(model) {
    const [i, j, k] = [0, 1, 2].map((place) => column(model.corners, 3, place));
    const [x, y, z] = [0, 1, 2].map((place) => column(model.vertices, 3, place));
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

  function touchTraces(model, strategy, viewpoint, ink) {
    const chosen = model.keys.filter((key) => key.strategy === strategy && key.viewpoint === viewpoint);
    const squares = chosen.map((key) => square(key.pose));
    const outline = squares.flatMap((corners) => [...corners, corners[0], [null, null, null]]);
    const filled = squares.flat();
    const starts = squares.map((_, place) => 4 * place);
    const centres = chosen.map(({ pose }) => [0, 1, 2].map((axis) => pose[axis] + 0.05 * pose[axis + 3]));
    const axes = (rows) => Object.fromEntries(["x", "y", "z"].map((name, axis) => [name, rows.map((row) => row[axis])]));
    return [
      {
        type: "mesh3d", ...axes(filled), i: starts.flatMap((s) => [s, s]), j: starts.flatMap((s) => [s + 1, s + 2]),
        k: starts.flatMap((s) => [s + 2, s + 3]), color: "#ffd23f", opacity: 0.55, hoverinfo: "skip",
        lighting: { ambient: 1, diffuse: 0, specular: 0 },
      },
      { type: "scatter3d", mode: "lines", ...axes(outline), line: { color: "#111", width: 3 }, hoverinfo: "skip" },
      {
        type: "scatter3d", mode: "lines+markers+text", ...axes(centres),
        line: { color: ink, width: 2 }, marker: { size: 14, color: "#111", line: { color: "#fff", width: 2 } },
        text: chosen.map((key) => String(key.number)), textfont: { color: "#fff", size: 14 }, textposition: "middle center",
        customdata: chosen.map((key) => [key.pose[9].toFixed(3), key.state.replaceAll("_", " ")]),
        hovertemplate: "touch %{text}<br>edge %{customdata[0]} object radii<br>contact %{customdata[1]}<extra></extra>",
      },
    ];
  }

  function eyeAt(azimuth, elevation, distance) {
    const [a, e] = [azimuth, elevation].map((degrees) => (degrees * Math.PI) / 180);
    return { x: distance * Math.sin(a) * Math.cos(e), y: distance * Math.sin(e), z: distance * Math.cos(a) * Math.cos(e) };
  }

  function whereIs({ x, y, z }) {
    const distance = Math.hypot(x, y, z);
    return [(Math.atan2(x, z) * 180) / Math.PI, (Math.asin(y / distance) * 180) / Math.PI, distance];
  }

  async function open(figure) {
    const stage = figure.querySelector(".stage");
    stage.setAttribute("aria-busy", "true");
    const [Plotly, model] = await Promise.all([loadPlotly(), readModel(figure)]);
    if (opened.length >= MOST_OPEN) close(opened.shift());
    const rest = [...stage.children];
    const ink = () => getComputedStyle(document.body).color;
    const [strategies, viewpoints] = ["strategies", "viewpoints"].map((name) => figure.querySelector(`.${name}`));
    const shown = () => [surfaceTrace(model), ...touchTraces(model, strategies.value, Number(viewpoints.value), ink())];
    const standing = () => {
      const { azimuth, elevation } = viewpoints.selectedOptions[0].dataset;
      return { eye: eyeAt(Number(azimuth), Number(elevation), 1.5), up: { x: 0, y: 1, z: 0 }, center: { x: 0, y: 0, z: 0 } };
    };
    // The same range along all axes keeps the object's proportions, and its size among objects.
    const hidden = { visible: false, showspikes: false, range: [-1, 1], autorange: false };
    const layout = {
      scene: { xaxis: hidden, yaxis: hidden, zaxis: hidden, aspectmode: "cube", camera: standing(), dragmode: "orbit" },
      margin: { l: 0, r: 0, t: 0, b: 0 }, showlegend: false, paper_bgcolor: "rgba(0,0,0,0)",
    };
    stage.replaceChildren();
    stage.classList.add("open");
    stage.setAttribute("role", "img");
    stage.setAttribute("aria-label", `Model of ${figure.dataset.name} with numbered touches; rotate it with the buttons below or by dragging`);
    await Plotly.newPlot(stage, shown(), layout, { displayModeBar: false, responsive: true, scrollZoom: false });
    const redraw = () => Plotly.react(stage, shown(), stage.layout, { displayModeBar: false, responsive: true, scrollZoom: false });
    const stand = (camera) => Plotly.relayout(stage, { "scene.camera": camera });
    strategies.onchange = redraw;
    viewpoints.onchange = () => redraw().then(() => stand(standing()));
    for (const button of figure.querySelectorAll(".turns button")) {
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
    Plotly.purge(stage);
    for (const name of ["role", "aria-label"]) stage.removeAttribute(name);
    stage.classList.remove("open");
    stage.replaceChildren(...rest);
    figure.querySelector(".controls").hidden = true;
  }

  function drawsIn3D() {
    return typeof DecompressionStream === "function" && Boolean(window.WebGLRenderingContext);
  }

  for (const figure of drawsIn3D() ? document.querySelectorAll(".model") : []) {
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

  // A link to an object unfolds it, and shows it even if the filter hides it.
  const reveal = () => {
    const target = document.getElementById(location.hash.slice(1));
    if (!target?.classList.contains("object")) return;
    target.hidden = false;
    target.querySelector(".fold").open = true;
    target.scrollIntoView();
  };
  window.addEventListener("hashchange", reveal);
  reveal();
  window.addEventListener("beforeprint", () => {
    for (const details of document.querySelectorAll("main details")) details.open = true;
  });
})();
