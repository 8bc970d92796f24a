"use strict";
// The page is complete without this script: it shows what a dot says where there is no pointer to hover.
(() => {
  const shown = document.getElementById("pointed");
  for (const dots of document.querySelectorAll(".curve .dots")) {
    dots.addEventListener("click", (event) => {
      const title = event.target.closest("circle")?.querySelector("title");
      if (!title) return;
      shown.textContent = title.textContent;
      shown.hidden = false;
    });
  }
})();
