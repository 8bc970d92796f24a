"use strict";
// The page is complete without scripts. This script adds a filter of objects and a button that copies the methods text; `model.js` draws the models.
(() => {
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
