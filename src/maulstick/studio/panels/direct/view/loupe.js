// Loupe over the canvas: what is under the pointer, drawn as vectors, larger.

const SIDE = 200; // CSS pixels, as in direct.css
const TIMES = 4; // larger than the view

export class Loupe {
  constructor(glass, props) {
    Object.assign(this, { glass, props });
  }

  get isOn() {
    return !this.glass.hidden;
  }

  turn() {
    this.glass.hidden = !this.glass.hidden;
  }

  // The view of it, pixels, with a place of the sheet in its middle.
  viewAt([x, y], { scale }) {
    const pixels = Math.round(SIDE * devicePixelRatio);
    if (this.glass.width !== pixels) [this.glass.width, this.glass.height] = [pixels, pixels];
    const larger = scale * TIMES * devicePixelRatio;
    return { scale: larger, x: pixels / 2 - x * larger, y: pixels / 2 - y * larger, wide: pixels, high: pixels };
  }

  paint({ bitmap, view }) {
    const ink = this.glass.getContext("2d");
    const { paper, wide, high } = this.props;
    ink.clearRect(0, 0, view.wide, view.high);
    ink.fillStyle = paper;
    ink.fillRect(view.x, view.y, wide * view.scale, high * view.scale);
    ink.drawImage(bitmap, 0, 0);
  }
}
