// Views of a sheet: its scale and where its corner lies.

// A view whose shorter side lies in the middle, and whose longer one leaves no room beside it. free: pixels beside it.
export function viewOf(scale, x, y, freeAcross, freeDown) {
  return { scale, x: settled(x, freeAcross), y: settled(y, freeDown) };
}

function settled(place, free) {
  return free >= 0 ? free / 2 : Math.min(Math.max(place, free), 0);
}

// Where a picture that was drawn for one view lies in another: its box, and whether that is pixel by pixel.
export function laidOn(before, now) {
  const factor = now.scale / before.scale;
  const box = [now.x - before.x * factor, now.y - before.y * factor, before.wide * factor, before.high * factor];
  return { box, isExact: factor === 1 && box[0] === 0 && box[1] === 0 && before.wide === now.wide && before.high === now.high };
}

// Middle of one or more fingers, and how far the first two are apart; 0 for one.
export function spread(places) {
  const [[x, y], [u, v]] = [places[0], places[1] ?? places[0]];
  return { middle: [(x + u) / 2, (y + v) / 2], wide: Math.hypot(u - x, v - y) };
}
