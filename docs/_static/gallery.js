// The filter of the gallery: one tag at a time.
document.querySelectorAll(".filter button").forEach((button) =>
  button.addEventListener("click", () => {
    document.querySelectorAll(".filter button").forEach((other) => other.setAttribute("aria-pressed", String(other === button)));
    const tag = button.dataset.tag;
    document.querySelectorAll(".card").forEach((card) => (card.hidden = tag !== "" && !card.dataset.tags.split("|").includes(tag)));
  }),
);
