"use strict";
// Gives every figure a control that copies it, with its caption, as an SVG drawing or a PNG picture.
// What is shown is drawn again from the places that the browser gave it, so one function serves all figures.
(() => {
  const SVG = new DOMParser().parseFromString("<svg>", "text/html").body.firstChild.namespaceURI;
  const MARGIN = 20; // pixels around the drawing
  const DENSITY = 2; // pixels of a PNG for one of the page
  const STYLES = [
    "fill", "fill-opacity", "stroke", "stroke-width", "stroke-opacity", "stroke-dasharray", "paint-order",
    "opacity", "font-family", "font-size", "font-weight", "text-anchor", "image-rendering",
  ];
  const measure = document.createElement("canvas").getContext("2d");

  function make(name, attributes, ...children) {
    const made = document.createElementNS(SVG, name);
    for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
    made.append(...children);
    return made;
  }

  // Copies a part of a drawing with its looks, which the page's style gave it; what it refers to is kept in `shared`.
  function copyDrawing(source, shared) {
    const copy = source.cloneNode(false);
    for (const { name } of [...copy.attributes]) {
      if (/^(id|class|style|role|tabindex|aria-.*|data-.*)$/.test(name)) copy.removeAttribute(name);
    }
    if (source.localName !== "title") {
      const style = getComputedStyle(source);
      const group = ["svg", "g", "defs"].includes(source.localName);
      for (const name of group ? ["opacity"] : STYLES) copy.setAttribute(name, style.getPropertyValue(name));
      if (style.transform !== "none") copy.setAttribute("transform", style.transform);
      if (source.localName === "svg") copy.setAttribute("overflow", style.overflowY === "visible" ? "visible" : "hidden");
    }
    const target = source.localName === "use" && source.getAttribute("href").slice(1);
    if (target && !shared.has(target)) {
      const kept = copyDrawing(document.getElementById(target), shared);
      kept.id = target;
      shared.set(target, kept);
    }
    for (const child of source.childNodes) {
      if (child.nodeType === Node.TEXT_NODE) copy.append(child.data);
      if (child.nodeType === Node.ELEMENT_NODE) copy.append(copyDrawing(child, shared));
    }
    return copy;
  }

  // Draws a text line by line, as the browser broke it.
  function* drawText(text, at) {
    const style = getComputedStyle(text.parentElement);
    const range = document.createRange();
    const lines = [];
    // A line may end after a hyphen, and a very long word anywhere.
    for (const piece of text.data.matchAll(/[^\s-]{1,12}-?|-/g)) {
      const end = piece.index + piece[0].length;
      range.setStart(text, piece.index);
      range.setEnd(text, end);
      const box = range.getClientRects()[0];
      if (!box?.width) continue;
      const line = lines.at(-1);
      if (line && Math.abs(line.box.top - box.top) < 2) line.end = end;
      else lines.push({ box, start: piece.index, end });
    }
    measure.font = style.font;
    const { fontBoundingBoxAscent: ascent, fontBoundingBoxDescent: descent } = measure.measureText("x");
    for (const { box, start, end } of lines) {
      const { x, y } = at(box);
      yield make("text", {
        x, y: y + (box.height * ascent) / (ascent + descent), fill: style.color,
        "font-family": style.fontFamily, "font-size": style.fontSize, "font-weight": style.fontWeight,
      }, text.data.slice(start, end).replace(/[ \t\n\r]+/g, " "));
    }
  }

  // Models keep the page's own ground, for their numbers are drawn in its ink.
  function* drawParts(node, at, shared, stages) {
    if (node.nodeType === Node.TEXT_NODE) yield* drawText(node, at);
    if (node.nodeType !== Node.ELEMENT_NODE || node.matches("script, button, .copies, .controls")) return;
    const style = getComputedStyle(node);
    const box = node.getBoundingClientRect();
    if (style.display === "none" || style.visibility === "hidden") return;
    const place = { ...at(box), width: box.width, height: box.height };
    if (stages.pictures.has(node)) {
      yield make("rect", { ...place, fill: stages.ground });
      yield make("image", { ...place, href: stages.pictures.get(node) });
    } else if (node.localName === "svg") {
      const copy = copyDrawing(node, shared);
      for (const [name, value] of Object.entries(place)) copy.setAttribute(name, value);
      yield copy;
    } else if (node.localName === "img") {
      yield make("image", { ...place, href: node.src, preserveAspectRatio: "none", "image-rendering": style.imageRendering });
    } else {
      if (!/^(transparent|rgba\(.*, 0\))$/.test(style.backgroundColor)) yield make("rect", { ...place, fill: style.backgroundColor, opacity: style.opacity });
      for (const child of node.childNodes) yield* drawParts(child, at, shared, stages);
    }
  }

  function captionOf(figure) {
    const caption = figure.querySelector(":scope > figcaption")?.cloneNode(true);
    for (const control of caption?.querySelectorAll(".copies") ?? []) control.remove();
    return (caption?.textContent ?? "").replace(/\s+/g, " ").trim();
  }

  // Gives pictures of the figure's models as they are turned, and the ground that they stand on.
  async function photograph(figure) {
    const pictures = new Map();
    for (const stage of figure.querySelectorAll(".stage.open")) {
      const { width, height } = stage.getBoundingClientRect();
      pictures.set(stage, await window.Plotly.toImage(stage, { format: "png", width, height, scale: DENSITY }));
    }
    return { pictures, ground: getComputedStyle(document.body).backgroundColor };
  }

  // Draws a figure as it is shown, caption included, in the colours of a light page: the text of an SVG file.
  async function drawFigure(figure) {
    const stages = await photograph(figure);
    document.documentElement.classList.add("copied");
    try {
      return drawPlaces(figure, stages);
    } finally {
      document.documentElement.classList.remove("copied");
    }
  }

  function drawPlaces(figure, stages) {
    const frame = figure.getBoundingClientRect();
    const at = ({ left, top }) => ({ x: left - frame.left, y: top - frame.top });
    const shared = new Map();
    const parts = [...figure.childNodes].flatMap((child) => [...drawParts(child, at, shared, stages)]);
    // What scrolls within the figure may be wider than it.
    const ends = parts.map((part) => Number(part.getAttribute("x")) + Number(part.getAttribute("width")));
    const [width, height] = [Math.max(frame.width, ...ends) + 2 * MARGIN, frame.height + 2 * MARGIN];
    const paper = make("rect", { x: -MARGIN, y: -MARGIN, width, height, fill: getComputedStyle(document.body).backgroundColor });
    const drawing = make(
      "svg", { width, height, viewBox: `${-MARGIN} ${-MARGIN} ${width} ${height}` },
      make("title", {}, captionOf(figure)), make("defs", {}, ...shared.values()), paper, ...parts,
    );
    return { source: new XMLSerializer().serializeToString(drawing), width, height };
  }

  async function paint({ source, width, height }) {
    const image = new Image();
    image.src = `data:image/svg+xml;charset=utf-8,${encodeURIComponent(source)}`;
    await image.decode();
    const canvas = document.createElement("canvas");
    [canvas.width, canvas.height] = [width, height].map((length) => Math.round(DENSITY * length));
    canvas.getContext("2d").drawImage(image, 0, 0, canvas.width, canvas.height);
    return new Promise((done) => canvas.toBlob(done, "image/png"));
  }

  function save(blob, name) {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(blob);
    link.download = name;
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60000);
  }

  // Copies a figure; where the browser refuses, the figure is saved as a file.
  async function take(figure, kind) {
    const drawing = await drawFigure(figure);
    const type = { SVG: "image/svg+xml", PNG: "image/png" }[kind];
    const blob = kind === "SVG" ? new Blob([drawing.source], { type }) : await paint(drawing);
    try {
      const forms = kind === "PNG" || ClipboardItem.supports?.(type) ? { [type]: blob } : {};
      if (kind === "SVG") forms["text/plain"] = new Blob([drawing.source], { type: "text/plain" });
      await navigator.clipboard.write([new ClipboardItem(forms)]);
      return "Copied.";
    } catch {
      save(blob, `${figure.closest("[id]")?.id ?? "figure"}.${kind.toLowerCase()}`);
      return "Saved.";
    }
  }

  for (const figure of document.querySelectorAll("main figure")) {
    if (figure.parentElement.closest("figure")) continue; // it is copied with the one around it
    const said = document.createElement("span");
    said.setAttribute("role", "status");
    const buttons = ["SVG", "PNG"].map((kind) => {
      const button = document.createElement("button");
      button.type = "button";
      button.textContent = kind;
      button.setAttribute("aria-label", `Copy as ${kind}: ${captionOf(figure).slice(0, 80) || "this figure"}`);
      button.addEventListener("click", async () => {
        said.textContent = await take(figure, kind).catch((error) => `It can't be copied (${error.message}).`);
      });
      return button;
    });
    const control = document.createElement("span");
    control.className = "copies";
    control.append("Copy ", ...buttons, " ", said);
    const caption = figure.querySelector(":scope > figcaption");
    if (caption) caption.prepend(control);
    else figure.append(control);
  }
})();
