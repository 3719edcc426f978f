// Stage of the canvas: what is seen of the sheet while it moves and once it rests, and what is done there.

import { paintFrame } from "./frame.js";
import { Loupe } from "./loupe.js";
import { Places } from "./places.js";
import { viewOf } from "./views.js";

const STEP = 1.25; // times larger by a key or a button
const NEAREST = 64; // times the true size, or the size that fits
const TRUE = 96 / 25.4; // CSS pixels per millimetre where a millimetre is one of the screen
const AGAIN = 1000; // milliseconds after which the studio is asked again where it did not answer
const STILL = 50; // milliseconds after which a view that was moved is drawn sharply, whatever was being drawn
const HANDLE = -56; // CSS pixels from the middle of what is chosen to the handle that turns it

// refs: elements by name: view, sheet, glass, scale.  props: of the component in canvas.js.  emit: tells the server.
export class Stage {
  constructor(refs, props, emit) {
    [this.root, this.sheet, this.scale, this.emit] = [refs.view, refs.sheet, refs.scale, emit];
    this.loupe = new Loupe(refs.glass, props);
    Object.assign(this, { props, wide: props.wide, high: props.high });
    this.view = { scale: 0, x: 0, y: 0 }; // CSS pixels per millimetre, and of the sheet's corner
    this.layers = {}; // { bitmap, view } by name
    this.chosen = { ids: [], middle: null };
    this.shift = { dx: 0, dy: 0, turn: 0 }; // of what is chosen, until the server has moved it; millimetres, radians
    this.act = null; // what a pointer does: { kind, … }
    this.sent = []; // what was drawn, each until the server has it
    this.acts = this.drawnActs = props.version; // that the worker has, and that are seen
    this.places = new Places();
    this.showPlaces();
    this.beforeChoice = () => {};
    this.asked = null; // tool that a key took up since a button did
    this.fits = true;
    this.faded = 0;
    this.ink = this.sheet.getContext("2d");
    this.image = new Image();
    this.image.onload = () => this.repaint();
    if (props.picture) this.image.src = props.picture;
    this.worker = new Worker(`${props.resourcePath}/worker.js`, { type: "module" });
    this.worker.onmessage = ({ data }) => this.hear(data);
    this.tell({ act: "begin", colours: [...props.colours], size: [this.wide, this.high] });
    this.fitting = new ResizeObserver(() => this.resize());
    this.fitting.observe(this.root);
    this.resize();
    this.load();
  }

  close() {
    this.isClosed = true;
    clearTimeout(this.waiting);
    this.worker.terminate();
    this.fitting.disconnect();
    clearTimeout(this.resting);
  }

  // Strokes come one change after the other; what they are then is asked for by what is known here.
  async load() {
    if (this.loading) return;
    this.loading = true;
    while (this.known !== this.props.version) {
      const wanted = this.props.version;
      const since = this.known === undefined ? "" : `?since=${this.known}`;
      const answer = await fetch(`${this.props.source}/${wanted}${since}`).catch(() => null);
      const whole = await (answer?.ok ? answer.arrayBuffer() : answer?.text())?.catch(() => null);
      if (whole == null) { // none, or one that broke off, which the page says
        if (!this.isClosed) this.waiting = setTimeout(() => this.load(), AGAIN);
        break;
      }
      if (!answer.ok) {
        this.emit("refused", whole);
        break;
      }
      this.known = wanted;
      this.tell({ act: "take", bytes: whole, acts: wanted }, [whole]);
    }
    this.loading = false;
  }

  tell(message, kept = []) {
    this.worker.postMessage(message, kept);
  }

  hear(message) {
    if (message.layer) {
      this.layers[message.layer]?.bitmap.close();
      this.layers[message.layer] = message;
      if (message.layer === "view") this.drawn();
      if (message.layer === "loupe") this.loupe.paint(message);
      if (message.layer === "chosen" && this.settles) this.arrive();
      if (message.layer === "chosen") this.root.toggleAttribute("data-chosen", this.chosen.ids.length > 0);
      this.repaint();
    }
    if (message.taken) this.taken(message.taken);
    if (message.chosen) {
      const before = this.chosen;
      this.chosen = message.chosen;
      if (!this.chosen.ids.length) {
        if (this.isMoved) this.act = null; // another page has taken it out
        this.settle();
      }
      this.repaint();
      if (JSON.stringify(before) !== JSON.stringify(this.chosen)) this.emit("chosen", this.chosen);
    }
  }

  // The worker has strokes as they are after some acts; where they are others than before, they are drawn next.
  taken({ strokes, acts, areOthers }) {
    Object.assign(this.root.dataset, { strokes, acts });
    [this.acts, this.settles] = [acts, areOthers];
    if (!areOthers) {
      if (!this.drawing) this.unsend();
      return this.arrive();
    }
    this.root.removeAttribute("data-sharp");
    this.drawing = true;
  }

  // Methods that the page calls.
  fade(share) {
    this.faded = share;
    this.repaint();
  }

  fit() {
    this.lay(this.fitted(), 0, 0);
    this.fits = true;
  }

  showTrueSize() {
    this.zoom(TRUE / this.view.scale);
  }

  nearer() {
    this.zoom(STEP);
  }

  farther() {
    this.zoom(1 / STEP);
  }

  magnify() {
    this.loupe.turn();
    this.point(this.pointed ?? this.middle());
  }

  // The pointer is at a place of the view, CSS pixels.
  point(at) {
    this.pointed = at;
    if (this.tool === "importance") this.repaint(); // its brush follows
    if (this.loupe.isOn) this.tell({ act: "see", layer: "loupe", view: this.loupe.viewAt(this.onSheet(at), this.view) });
  }

  showLocks(shows) {
    this.tell({ act: "locks", shows });
  }

  // Regions and guides are others, or another one is chosen.
  showPlaces() {
    const { said, saidChosen } = this.props;
    this.places.take(said);
    this.places.chosen = saidChosen;
    this.root.dataset.regions = said.regions.length;
    this.root.dataset.guides = said.guides.length;
    this.repaint();
  }

  showRegions(shows) {
    this.places.shows = shows;
    this.repaint();
  }

  choose(what, adds = false) {
    this.beforeChoice(); // what was chosen before may still have to be moved
    this.tell({ act: "choose", ...what, adds, view: this.seen() });
  }

  chooseAll() {
    this.choose({ all: true });
  }

  chooseNone() {
    this.choose({ ids: [] });
  }

  // The server has done what it was told; how far something was moved since, it is told later.
  arrive() {
    this.settles = false;
    if (this.shift.isSent) this.settle();
  }

  // What is chosen lies where the server has it.
  settle() {
    [this.shift, this.settles] = [{ dx: 0, dy: 0, turn: 0 }, false];
    this.repaint();
  }

  fitted() {
    const { clientWidth, clientHeight } = this.root;
    return Math.min(clientWidth / this.wide, clientHeight / this.high);
  }

  zoom(times, at = this.middle()) {
    const { scale, x, y } = this.view;
    const fitted = this.fitted();
    const next = Math.min(Math.max(scale * times, Math.min(fitted, TRUE)), NEAREST * Math.max(fitted, TRUE));
    this.lay(next, at[0] - ((at[0] - x) / scale) * next, at[1] - ((at[1] - y) / scale) * next);
  }

  lay(scale, x, y) {
    const { clientWidth, clientHeight } = this.root;
    this.fits = false;
    this.view = viewOf(scale, x, y, clientWidth - scale * this.wide, clientHeight - scale * this.high);
    this.scale.textContent = `${Number(((100 * scale) / TRUE).toPrecision(2))} % of its size`;
    this.repaint();
    this.stale = true;
    if (!this.drawing) this.see();
    clearTimeout(this.resting);
    this.resting = setTimeout(() => this.stale && this.see(), STILL);
  }

  resize() {
    const { root, sheet } = this;
    const [wide, high] = [root.clientWidth, root.clientHeight].map((side) => Math.round(side * devicePixelRatio));
    if (!wide || !high) return;
    this.ratio = devicePixelRatio;
    if (sheet.width !== wide || sheet.height !== high) [sheet.width, sheet.height] = [wide, high];
    if (this.fits) this.fit();
    else this.lay(this.view.scale, this.view.x, this.view.y);
  }

  // The view in device pixels, as the worker draws it.
  seen() {
    const [{ scale, x, y }, ratio] = [this.view, devicePixelRatio];
    const { width, height } = this.sheet;
    return { scale: scale * ratio, x: x * ratio, y: y * ratio, wide: width, high: height };
  }

  // Have the view drawn sharply; a drawing of another view that is under way is given up.
  see() {
    [this.stale, this.drawing] = [false, true];
    this.tell({ act: "see", layer: "view", view: this.seen() });
    if (this.chosen.ids.length) this.tell({ act: "see", layer: "chosen", view: this.seen() });
  }

  drawn() {
    this.drawing = false;
    this.unsend();
    if (this.stale) this.see();
  }

  // Each act that is seen now was the oldest one of those that were sent.
  unsend() {
    this.sent.splice(0, this.acts - this.drawnActs);
    this.drawnActs = this.acts;
  }

  get tool() {
    return this.asked ?? this.props.tool;
  }

  middle() {
    return [this.root.clientWidth / 2, this.root.clientHeight / 2];
  }

  onSheet([u, v]) {
    return [(u - this.view.x) / this.view.scale, (v - this.view.y) / this.view.scale];
  }

  repaint() {
    this.frame ??= requestAnimationFrame(() => {
      this.frame = undefined;
      if (this.ratio !== devicePixelRatio) return this.resize(); // the window is on another screen
      const isSharp = paintFrame(this) && this.known !== undefined && !this.stale && !this.drawing;
      this.root.toggleAttribute("data-sharp", isSharp);
    });
  }

  // Place of the handle that turns what is chosen, CSS pixels.
  handle() {
    const { scale, x, y } = this.view;
    const [u, v] = this.chosen.middle;
    const { dx, dy, turn } = this.shift;
    return [(u + dx) * scale + x - HANDLE * Math.sin(turn), (v + dy) * scale + y + HANDLE * Math.cos(turn)];
  }

  // Whether a pointer moves what is chosen.
  get isMoved() {
    return ["move", "turn"].includes(this.act?.kind);
  }

  // What a pointer had begun is given up.
  leave() {
    if (this.isMoved) this.settle();
    this.act = null;
    this.repaint();
  }

  // The server has refused what was drawn or moved.
  giveUp() {
    this.sent = [];
    if (this.shift.isSent) this.settle();
    this.repaint();
  }
}
