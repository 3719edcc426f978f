(event) => {
  const map = event.currentTarget;
  const number = event.target.closest("[data-stroke]")?.dataset.stroke;
  if (number === undefined) return;
  const focus = (other) => map.querySelector(`path[data-stroke="${other}"]`)?.focus();
  if (event.type === "click") return focus(number);
  const stroke = map.querySelector(`path[data-stroke="${number}"]`);
  if (event.type === "focusin") {
    for (const other of map.querySelectorAll('[tabindex="0"], [aria-current]')) {
      other.setAttribute("tabindex", "-1");
      other.removeAttribute("aria-current");
    }
    stroke.setAttribute("tabindex", "0");
    stroke.setAttribute("aria-current", "true");
    map.querySelector(".chosen").setAttribute("d", stroke.getAttribute("d")); // over those that were drawn after it
    return emit(Number(number));
  }
  const strokes = map.querySelectorAll("path[data-stroke]").length;
  const to = {
    ArrowLeft: stroke.dataset.left,
    ArrowRight: stroke.dataset.right,
    ArrowUp: stroke.dataset.up,
    ArrowDown: stroke.dataset.down,
    Home: 0,
    End: strokes - 1,
    PageUp: Math.max(Number(number) - 1, 0),
    PageDown: Math.min(Number(number) + 1, strokes - 1),
  }[event.key];
  if (to === undefined) return;
  event.preventDefault();
  focus(to);
}
