"use strict";
// Draws each figure of class "model": a surface, its touches in order, and the squares of the sensor, which a reader turns.
// The surface is drawn into a depth buffer by this script: no library and no WebGL is needed.
(() => {
  const DISTANCE = 3; // from the eye to the middle, in object radii, as in the views
  const REACH = 1.25; // half of the stage in object radii at zoom 1: numbers stand beside the object
  const [STEP, ZOOM, MOST_ZOOM] = [15, 1.25, 12]; // degrees and factor per key; largest zoom
  const LIGHT_RISE = (25 * Math.PI) / 180; // angle from the viewing axis up to the light, as in the views
  const [AMBIENT, DIRECTED] = [0.45, 0.6];
  const [YELLOW, OPAQUE] = [[255, 210, 63], 0.55]; // of squares
  const PIECES = 24; // of a line, each of which is hidden or not
  const LIFT = 0.006; // of squares above the surface, in object radii
  const MOST_PIXELS = 1600; // edge of the drawing
  const DISC = 9; // radius of a number, in pixels of the page
  const [GAPS, TURNS] = [[8, 18, 30, 50], [0, 1, -1, 2, -2, 3, -3, 4, -4, 5, -5, 6]]; // from squares to numbers in pixels, directions in 30 degrees
  const MOST_BESIDE = 12; // touches whose numbers stand beside their squares; more numbers stand on them
  const ALL = "all";

  async function unpack(base64) {
    const packed = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
    return new Response(stream).arrayBuffer();
  }

  const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
  const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
  const moved = (a, by, length) => a.map((value, axis) => value + by[axis] * length);

  async function readModel(figure) {
    const block = await unpack(figure.querySelector(".geometry").textContent);
    const [vertices, faces, touches] = ["vertices", "faces", "touches"].map((name) => Number(figure.dataset[name]));
    let offset = 0;
    const take = (Type, count) => new Type(block.slice(offset, offset += count * Type.BYTES_PER_ELEMENT));
    const scaled = (count) => Float32Array.from(take(Int16Array, count), (value) => value / COORDINATE_STEPS);
    const [points, poses] = [3 * vertices, 10 * touches].map(scaled);
    const [corners, colours] = [take(Uint32Array, 3 * faces), take(Uint8Array, 3 * faces)];
    const keys = JSON.parse(figure.querySelector(".touch-keys").textContent);
    return { points, corners, colours, normals: faceNormals(points, corners), touches: keys.map((key, row) => readTouch(key, poses.slice(10 * row, 10 * row + 10))) };
  }

  function faceNormals(points, corners) {
    const normals = new Float32Array(corners.length);
    for (let start = 0; start < corners.length; start += 3) {
      const [a, b, c] = [0, 1, 2].map((corner) => points.subarray(3 * corners[start + corner], 3 * corners[start + corner] + 3));
      const normal = cross(minus(b, a), minus(c, a));
      const length = Math.hypot(...normal) || 1;
      normals.set(normal.map((value) => value / length), start);
    }
    return normals;
  }

  function readTouch([strategy, viewpoint, number, state], pose) {
    const [point, normal, across, size] = [[...pose.slice(0, 3)], [...pose.slice(3, 6)], [...pose.slice(6, 9)], pose[9]];
    const down = cross(across, normal);
    const centre = moved(point, normal, LIFT);
    const corners = [[-1, -1], [1, -1], [1, 1], [-1, 1]].map(([a, b]) => moved(moved(centre, across, 0.5 * size * a), down, 0.5 * size * b));
    return { strategy, viewpoint, number, state, size, centre, corners };
  }

  // The directions right, up and back, from the middle to the eye, in the object's axes.
  function axesOf({ azimuth, elevation }) {
    const [a, e] = [azimuth, elevation].map((degrees) => (degrees * Math.PI) / 180);
    const back = [Math.sin(a) * Math.cos(e), Math.sin(e), Math.cos(a) * Math.cos(e)];
    const right = [Math.cos(a), 0, -Math.sin(a)];
    return { right, up: cross(back, right), back };
  }

  // Returns a function from a point to its column, row and nearness, 1 / distance, which is linear within a triangle.
  function projection(eye, edge) {
    const { right, up, back } = axesOf(eye);
    const scale = (0.5 * edge * DISTANCE * eye.zoom) / REACH;
    return (point) => {
      const nearness = 1 / (DISTANCE - dot(back, point));
      return [0.5 * edge + scale * nearness * dot(right, point), 0.5 * edge - scale * nearness * dot(up, point), nearness];
    };
  }

  // Calls paint(index, nearness) for the pixels of a triangle.
  function fill(edge, [x0, y0, n0], [x1, y1, n1], [x2, y2, n2], paint) {
    const area = (x1 - x0) * (y2 - y0) - (x2 - x0) * (y1 - y0);
    if (!area) return;
    const [sx, tx] = [(y2 - y0) / area, (y0 - y1) / area];
    const [sy, ty] = [(x0 - x2) / area, (x1 - x0) / area];
    const last = Math.min(edge - 1, Math.ceil(Math.max(y0, y1, y2)));
    for (let y = Math.max(0, Math.floor(Math.min(y0, y1, y2))); y <= last; y++) {
      const s0 = (0.5 - x0) * sx + (y + 0.5 - y0) * sy, t0 = (0.5 - x0) * tx + (y + 0.5 - y0) * ty;
      let from = 0, to = edge - 1;
      // Within the triangle s, t and 1 - s - t are at least 0. A little less leaves no gap between neighbours.
      for (let side = 0; side < 3; side++) {
        const value = 1e-4 + (side === 0 ? s0 : side === 1 ? t0 : 1 - s0 - t0);
        const slope = side === 0 ? sx : side === 1 ? tx : -sx - tx;
        if (slope > 0) from = Math.max(from, Math.ceil(-value / slope));
        else if (slope < 0) to = Math.min(to, Math.floor(-value / slope));
        else if (value < 0) to = -1;
      }
      for (let x = from; x <= to; x++) {
        const s = s0 + x * sx, t = t0 + x * tx;
        paint(y * edge + x, n0 + s * (n1 - n0) + t * (n2 - n0));
      }
    }
  }

  // Draws the surface; returns the nearness of each pixel, 0 beside the surface.
  function drawSurface(model, eye, edge, pixels) {
    const { up, back } = axesOf(eye);
    const light = moved(back.map((value) => value * Math.cos(LIGHT_RISE)), up, Math.sin(LIGHT_RISE));
    const project = projection(eye, edge);
    const places = Array.from({ length: model.points.length / 3 }, (_, row) => project(model.points.subarray(3 * row, 3 * row + 3)));
    const nearest = new Float32Array(edge * edge);
    for (let start = 0; start < model.corners.length; start += 3) {
      const shade = Math.min(1, AMBIENT + DIRECTED * Math.abs(dot(model.normals.subarray(start, start + 3), light)));
      const [red, green, blue] = [0, 1, 2].map((channel) => model.colours[start + channel] * shade);
      const colour = (255 << 24) | (blue << 16) | (green << 8) | red;
      const [a, b, c] = [0, 1, 2].map((corner) => places[model.corners[start + corner]]);
      fill(edge, a, b, c, (index, nearness) => {
        if (nearness > nearest[index]) {
          nearest[index] = nearness;
          pixels[index] = colour;
        }
      });
    }
    return nearest;
  }

  // Tints the pixels of a square where the surface does not hide it.
  function tintSquare(corners, edge, pixels, nearest) {
    const bytes = new Uint8Array(pixels.buffer);
    const paint = (index, nearness) => {
      if (nearness < nearest[index]) return;
      const byte = 4 * index, share = bytes[byte + 3] ? OPAQUE : 1; // beside the surface nothing lies below a square
      for (let channel = 0; channel < 3; channel++) bytes[byte + channel] = YELLOW[channel] * share + bytes[byte + channel] * (1 - share);
      bytes[byte + 3] = Math.max(bytes[byte + 3], 255 * OPAQUE);
    };
    fill(edge, corners[0], corners[1], corners[2], paint);
    fill(edge, corners[0], corners[2], corners[3], paint);
  }

  // Returns the vector from each square to its number, such that numbers cover neither squares nor numbers.
  function numberOffsets(places, radii, edge, unit) {
    const taken = [];
    return places.map(([x, y], index) => {
      // Directions away from the middle come first: there the object is not behind a number.
      const away = Math.atan2(y - 0.5 * edge, x - 0.5 * edge);
      const offered = GAPS.flatMap((gap) => TURNS.map((turn) => {
        const [angle, length] = [away + (turn * Math.PI) / 6, radii[index] + gap * unit + DISC * unit];
        return [length * Math.cos(angle), length * Math.sin(angle)];
      }));
      const room = ([a, b]) => Math.min(
        0, 0.5 * edge - DISC * unit - Math.abs(x + a - 0.5 * edge), 0.5 * edge - DISC * unit - Math.abs(y + b - 0.5 * edge),
        ...places.map((other, row) => Math.hypot(x + a - other[0], y + b - other[1]) - radii[row] - DISC * unit),
        ...taken.map((other) => Math.hypot(x + a - other[0], y + b - other[1]) - 2.2 * DISC * unit),
      );
      const rooms = offered.map(room);
      const best = offered[rooms.indexOf(Math.max(...rooms))];
      taken.push([x + best[0], y + best[1]]);
      return best;
    });
  }

  // Draws the rims of the squares, the line from touch to touch, and the numbers; a hidden touch has a hollow number. Returns
  // the numbers' places.
  function drawTouches(pen, { touches, eye, edge, nearest, unit, ink, offsets }) {
    const project = projection(eye, edge);
    const isSeen = ([x, y, nearness]) => {
      const [column, row] = [Math.floor(x), Math.floor(y)];
      const inside = column >= 0 && row >= 0 && column < edge && row < edge;
      return !inside || nearness >= 0.995 * nearest[row * edge + column];
    };
    const line = (from, to, seen) => {
      pen.globalAlpha = seen ? 1 : 0.25;
      pen.beginPath();
      pen.moveTo(from[0], from[1]);
      pen.lineTo(to[0], to[1]);
      pen.stroke();
    };
    // Draws a line in space; its hidden pieces are faint, or left out.
    const lineInSpace = (from, to, showsHidden) => {
      const way = minus(to, from);
      const steps = Array.from({ length: PIECES + 1 }, (_, step) => project(moved(from, way, step / PIECES)));
      const seen = steps.map(isSeen);
      for (let piece = 0; piece < PIECES; piece++) {
        const whole = seen[piece] && seen[piece + 1];
        if (whole || showsHidden) line(steps[piece], steps[piece + 1], whole);
      }
    };
    pen.strokeStyle = "#111";
    pen.lineWidth = 1.3 * unit;
    for (const { corners } of touches) corners.forEach((corner, row) => lineInSpace(corner, corners[(row + 1) % 4], false));
    pen.strokeStyle = ink;
    pen.lineWidth = 2 * unit;
    touches.slice(1).forEach((touch, row) => {
      if (touches[row].viewpoint === touch.viewpoint) lineInSpace(touches[row].centre, touch.centre, true);
    });
    const places = touches.map(({ centre }) => project(centre));
    const seen = places.map(isSeen);
    const numbers = places.map(([x, y], row) => [x + offsets[row][0], y + offsets[row][1]]);
    pen.lineWidth = unit;
    places.forEach((place, row) => line(place, numbers[row], seen[row]));
    pen.globalAlpha = 1;
    pen.font = `700 ${11 * unit}px system-ui, "DejaVu Sans", sans-serif`;
    pen.textAlign = "center";
    pen.textBaseline = "middle";
    // The first touch is drawn last, on top.
    for (let row = touches.length - 1; row >= 0; row--) {
      const [x, y] = numbers[row];
      pen.beginPath();
      pen.arc(x, y, DISC * unit, 0, 2 * Math.PI);
      pen.fillStyle = seen[row] ? "#111" : "rgb(255 255 255 / 0.75)";
      pen.strokeStyle = seen[row] ? "#fff" : "#111";
      pen.setLineDash(seen[row] ? [] : [2 * unit, 2 * unit]);
      pen.fill();
      pen.stroke();
      pen.fillStyle = seen[row] ? "#fff" : "#111";
      pen.fillText(touches[row].number, x, y);
    }
    pen.setLineDash([]);
    return numbers;
  }

  function start(figure, model) {
    const find = (name) => figure.querySelector(name);
    const [stage, felt, touched, strategies, viewpoints] = [".stage", ".felt", ".touched", ".strategies", ".viewpoints"].map(find);
    const sheets = JSON.parse(find(".imprint-sheets").textContent);
    const canvas = document.createElement("canvas");
    const pen = canvas.getContext("2d", { willReadFrequently: true }); // kept in memory, where this script writes
    let [eye, numbers, offsets, waiting, dragged] = [null, [], null, false, null];

    const chosen = () => model.touches.filter((touch) =>
      touch.strategy === strategies?.value && [ALL, String(touch.viewpoint)].includes(viewpoints?.value ?? ALL));
    const standing = () => {
      const { azimuth, elevation } = viewpoints?.selectedOptions[0].dataset ?? figure.dataset;
      return { azimuth: Number(azimuth), elevation: Number(elevation), zoom: 1 };
    };

    function draw() {
      waiting = false;
      const wide = stage.clientWidth, high = stage.clientHeight;
      if (!wide || !high) return;
      const across = Math.min(wide, high);
      // Two pixels for one have smooth edges; one is enough while the object moves.
      const edge = Math.min(MOST_PIXELS, Math.round(across * (dragged ? 1 : Math.max(2, devicePixelRatio))));
      const unit = edge / across;
      if (canvas.width !== edge) canvas.width = canvas.height = edge;
      canvas.style.width = canvas.style.height = `${across}px`;
      const picture = pen.createImageData(edge, edge);
      const pixels = new Uint32Array(picture.data.buffer);
      const nearest = drawSurface(model, eye, edge, pixels);
      const touches = chosen();
      const project = projection(eye, edge);
      const squares = touches.map(({ corners }) => corners.map(project));
      for (const square of squares) tintSquare(square, edge, pixels, nearest);
      pen.putImageData(picture, 0, 0);
      if (offsets === null || offsets.length !== touches.length) {
        const places = touches.map(({ centre }) => project(centre));
        const radii = squares.map((square, row) => Math.max(...square.map((corner) => Math.hypot(corner[0] - places[row][0], corner[1] - places[row][1]))));
        offsets = touches.length > MOST_BESIDE ? touches.map(() => [0, 0]) : numberOffsets(places, radii, edge, unit).map((offset) => offset.map((value) => value / unit));
      }
      numbers = drawTouches(pen, {
        touches, eye, edge, nearest, unit, ink: getComputedStyle(stage).color, offsets: offsets.map((offset) => offset.map((value) => value * unit)),
      }).map((place) => place.map((value) => value / unit));
      for (const name of ["azimuth", "elevation", "zoom"]) canvas.dataset[name] = eye[name].toFixed(2);
    }

    function redraw() {
      if (!waiting) requestAnimationFrame(draw);
      waiting = true;
    }

    // Numbers find their places again, except while the object is dragged.
    function stand(next) {
      eye = {
        azimuth: next.azimuth, elevation: Math.max(-90, Math.min(90, next.elevation)),
        zoom: Math.max(1 / MOST_ZOOM, Math.min(MOST_ZOOM, next.zoom)),
      };
      if (!dragged) offsets = null;
      redraw();
    }
    const turn = (across, up) => stand({ ...eye, azimuth: eye.azimuth + across, elevation: eye.elevation + up });
    const zoom = (factor) => stand({ ...eye, zoom: eye.zoom * factor });

    // Shows the imprint of a touch, cut out of the strategy's sheet of imprints.
    function show(touch) {
      const columns = Math.max(...model.touches.filter(({ strategy }) => strategy === touch.strategy).map(({ number }) => number));
      const picture = document.createElement("span");
      picture.className = "cell";
      picture.setAttribute("role", "img");
      picture.setAttribute("aria-label", `Imprint of touch ${touch.number}`);
      const position = `${-96 * (touch.number - 1)}px ${-96 * touch.viewpoint}px`;
      picture.style.background = `url(${sheets[touch.strategy]}) ${position} / ${96 * columns}px auto`;
      felt.replaceChildren(picture, `Touch ${touch.number}: edge ${touch.size.toFixed(3)} object radii, contact ${touch.state.replaceAll("_", " ")}`);
      felt.hidden = false;
      const row = chosen().indexOf(touch);
      [...touched.children].forEach((button, index) => button.setAttribute("aria-pressed", String(index === row)));
    }

    // Adds one button per touch; focus, pointer and tap show the touch's imprint.
    function offer() {
      felt.hidden = true;
      touched.replaceChildren(...chosen().map((touch) => {
        const button = document.createElement("button");
        button.type = "button";
        button.textContent = touch.number;
        button.setAttribute("aria-label", `Imprint of touch ${touch.number}`);
        button.setAttribute("aria-pressed", "false");
        for (const event of ["focus", "pointerenter", "click"]) button.addEventListener(event, () => show(touch));
        return button;
      }));
    }

    function enlarge(large) {
      figure.classList.toggle("large", large);
      const button = find(".enlarge");
      button.setAttribute("aria-pressed", String(large));
      offsets = null;
      redraw();
      button.scrollIntoView({ block: "nearest" });
    }

    function showNearest(event) {
      const box = canvas.getBoundingClientRect();
      const away = ([x, y]) => Math.hypot(event.clientX - box.left - x, event.clientY - box.top - y);
      const row = numbers.findIndex((place) => away(place) < 1.5 * DISC);
      if (row >= 0) show(chosen()[row]);
    }

    stage.onpointerdown = (event) => {
      dragged = { x: event.clientX, y: event.clientY, eye };
      stage.setPointerCapture(event.pointerId);
    };
    stage.onpointermove = (event) => {
      if (!dragged) return showNearest(event);
      const degrees = 180 / canvas.clientWidth;
      const { azimuth, elevation } = dragged.eye;
      return stand({ ...eye, azimuth: azimuth - degrees * (event.clientX - dragged.x), elevation: elevation + degrees * (event.clientY - dragged.y) });
    };
    stage.onpointerup = stage.onpointercancel = (event) => {
      dragged = null;
      stand(eye);
      showNearest(event);
    };
    // The wheel scrolls the page until the reader chooses the model.
    stage.addEventListener("wheel", (event) => {
      if (document.activeElement !== stage) return;
      event.preventDefault();
      zoom(Math.exp(-Math.sign(event.deltaY) * 0.15));
    }, { passive: false });
    const keys = {
      ArrowLeft: () => turn(-STEP, 0), ArrowRight: () => turn(STEP, 0), ArrowUp: () => turn(0, STEP), ArrowDown: () => turn(0, -STEP),
      "+": () => zoom(ZOOM), "=": () => zoom(ZOOM), "-": () => zoom(1 / ZOOM), Home: () => stand(standing()),
    };
    stage.onkeydown = (event) => {
      if (!(event.key in keys) || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      keys[event.key]();
    };
    figure.onkeydown = ({ key }) => { if (key === "Escape" && figure.classList.contains("large")) enlarge(false); };
    find(".enlarge").onclick = () => enlarge(!figure.classList.contains("large"));
    for (const button of figure.querySelectorAll(".turns button:not(.enlarge)")) {
      button.onclick = () => {
        if (button.dataset.zoom) zoom(Number(button.dataset.zoom));
        else turn(...button.dataset.turn.split(",").map(Number));
      };
    }
    if (strategies) strategies.onchange = () => { offsets = null; redraw(); offer(); };
    if (viewpoints) viewpoints.onchange = () => { stand(standing()); offer(); };
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw);
    stage.replaceChildren(canvas);
    stage.classList.add("open");
    stage.tabIndex = 0;
    stage.setAttribute("role", "img");
    stage.setAttribute("aria-label", `Model of ${figure.dataset.name}${model.touches.length ? " with numbered touches" : ""}; drag it or use the arrow keys to turn it, plus and minus to zoom`);
    find(".controls").hidden = false;
    if (touched) offer();
    if (figure.dataset.focus) stage.focus({ preventScroll: true });
    stand(standing());
    return () => { offsets = null; redraw(); };
  }

  // A model is read when its stage is first in sight, and drawn again when its size changes.
  const begun = new WeakMap();
  const sizes = new ResizeObserver((entries) => {
    for (const { target: stage, contentRect } of entries.filter((entry) => entry.contentRect.width)) {
      const figure = stage.closest(".model");
      if (!begun.has(stage)) {
        begun.set(stage, null);
        readModel(figure).then((model) => begun.set(stage, start(figure, model))).catch((error) => {
          stage.textContent = `This browser can't draw the model (${error.message}).`;
        });
      } else if (contentRect.width) begun.get(stage)?.();
    }
  });
  if (typeof DecompressionStream === "function") {
    for (const stage of document.querySelectorAll(".model .stage")) {
      stage.querySelector("p").textContent = "The model is read …";
      sizes.observe(stage);
    }
  }
})();
