// Stroke that a person draws, as it looks while the pen is down.

const COLUMNS = 3; // x, y, pressure

// Pressure of a pointer in [0, 1]; a mouse says a half, and some screens say 0 for a finger.
export function felt(event) {
  return event.pressure || (event.pointerType === "pen" ? 0 : 0.5);
}

// Draw points (x, y, pressure, …), millimetres, as a band. halfWidths: at pressures from 0 to 1, millimetres.
export function drawingStroke(ink, points, { scale, x, y }, colour, halfWidths) {
  ink.fillStyle = ink.strokeStyle = colour;
  ink.lineCap = "round";
  for (let i = 0; i < points.length; i += COLUMNS) {
    const wide = Math.max(halfWidthAt(halfWidths, points[i + 2]) * scale, 0.5);
    const [u, v] = [points[i] * scale + x, points[i + 1] * scale + y];
    ink.beginPath();
    if (!i) ink.arc(u, v, wide, 0, 2 * Math.PI);
    if (!i) ink.fill();
    ink.moveTo(points[i && i - COLUMNS] * scale + x, points[(i && i - COLUMNS) + 1] * scale + y);
    ink.lineTo(u, v);
    ink.lineWidth = 2 * wide;
    ink.stroke();
  }
}

function halfWidthAt(halfWidths, pressure) {
  const at = pressure * (halfWidths.length - 1);
  const lower = Math.min(Math.floor(at), halfWidths.length - 2);
  return halfWidths[lower] + (at - lower) * (halfWidths[lower + 1] - halfWidths[lower]);
}
