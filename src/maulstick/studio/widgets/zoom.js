const STEP = 1.25; // times larger by a key or a button
const NEAREST = 32; // times the true size, or the size that fits
const PER_PIXEL = 0.0015; // of a wheel, as a logarithm
const PER_PINCH = 0.01; // of a touchpad, which browsers report as a wheel with Ctrl
const LINE = 20; // CSS pixels of a wheel that counts lines
const FAR = 0.1; // share of the view that an arrow key moves
const STILL = 200; // milliseconds after which a picture that was moved is drawn sharply again

export default {
  template: `
    <div class="zoomed" :class="{ moving }" ref="view" role="group" tabindex="0" :aria-label="label"
      @pointerdown="begin" @pointermove="move" @pointerup="leave" @pointercancel="leave"
      @wheel.prevent="roll" @keydown="key">
      <img :src="source" :alt="alt" :style="laid" draggable="false">
      <div v-if="other" class="over" :style="{ clipPath: 'inset(0 0 0 ' + split + '%)' }">
        <img :src="other" :alt="otherAlt" :style="laid" draggable="false">
      </div>
      <span class="scale figure" role="status">{{ told }}</span>
    </div>
  `,
  // wide, high: of the sheet in CSS pixels where a millimetre of it is one of the screen
  props: { source: String, other: String, alt: String, otherAlt: String, label: String, wide: Number, high: Number },
  data() {
    return { scale: 0, x: 0, y: 0, split: 50, moving: false, fits: true }; // x, y: of the sheet's upper left corner
  },
  computed: {
    laid() {
      const [width, height] = [this.wide, this.high].map((side) => `${side}px`);
      return { width, height, transform: `translate(${this.x}px, ${this.y}px) scale(${this.scale})` };
    },
    told() {
      return `${Number((100 * this.scale).toPrecision(2))} % of its size`;
    },
  },
  mounted() {
    this.pointers = new Map(); // places by pointer
    this.fitting = new ResizeObserver(() => (this.fits ? this.fit() : this.lay(this.scale, this.x, this.y)));
    this.fitting.observe(this.$refs.view);
    this.fit();
  },
  unmounted() {
    this.fitting.disconnect();
    clearTimeout(this.resting);
  },
  methods: {
    part(share) {
      this.split = share;
    },
    fit() {
      this.lay(this.fitted(), 0, 0);
      this.fits = true;
    },
    showTrueSize() {
      this.zoom(1 / this.scale);
    },
    nearer() {
      this.zoom(STEP);
    },
    farther() {
      this.zoom(1 / STEP);
    },

    fitted() {
      const { clientWidth, clientHeight } = this.$refs.view;
      return Math.min(clientWidth / this.wide, clientHeight / this.high);
    },
    zoom(times, at = this.middle()) {
      const fitted = this.fitted();
      const scale = Math.min(Math.max(this.scale * times, Math.min(fitted, 1)), NEAREST * Math.max(fitted, 1));
      const [u, v] = [(at[0] - this.x) / this.scale, (at[1] - this.y) / this.scale];
      this.lay(scale, at[0] - u * scale, at[1] - v * scale);
    },
    // A side that is shorter than the view lies in its middle, and a longer one leaves no room beside it.
    lay(scale, x, y) {
      const { clientWidth, clientHeight } = this.$refs.view;
      [this.scale, this.fits, this.moving] = [scale, false, true];
      this.x = settled(x, clientWidth - scale * this.wide);
      this.y = settled(y, clientHeight - scale * this.high);
      clearTimeout(this.resting);
      this.resting = setTimeout(() => (this.moving = false), STILL);
    },
    middle() {
      return [this.$refs.view.clientWidth / 2, this.$refs.view.clientHeight / 2];
    },
    place(event) {
      const box = this.$refs.view.getBoundingClientRect();
      return [event.clientX - box.left, event.clientY - box.top];
    },

    begin(event) {
      if (event.button !== 0) return;
      this.$refs.view.setPointerCapture(event.pointerId);
      this.pointers.set(event.pointerId, this.place(event));
    },
    move(event) {
      if (!this.pointers.has(event.pointerId)) return;
      const before = spread([...this.pointers.values()]);
      this.pointers.set(event.pointerId, this.place(event));
      const after = spread([...this.pointers.values()]);
      const [[x, y], [u, v]] = [before.middle, after.middle];
      this.lay(this.scale, this.x + u - x, this.y + v - y);
      if (before.wide) this.zoom(after.wide / before.wide, after.middle);
    },
    leave(event) {
      this.pointers.delete(event.pointerId);
    },
    roll(event) {
      const down = event.deltaY * (event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 1 : LINE);
      this.zoom(Math.exp(-down * (event.ctrlKey ? PER_PINCH : PER_PIXEL)), this.place(event));
    },
    key(event) {
      if (event.ctrlKey || event.altKey || event.metaKey) return;
      const [wide, high] = this.middle().map((half) => 2 * FAR * half);
      const by = (x, y) => () => this.lay(this.scale, this.x + x, this.y + y);
      const act = {
        "+": this.nearer, "=": this.nearer, "-": this.farther, 0: this.fit, 1: this.showTrueSize,
        ArrowLeft: by(wide, 0), ArrowRight: by(-wide, 0), ArrowUp: by(0, high), ArrowDown: by(0, -high),
      }[event.key];
      if (!act) return;
      event.preventDefault();
      act();
    },
  },
};

function settled(place, free) {
  return free >= 0 ? free / 2 : Math.min(Math.max(place, free), 0);
}

// Middle of one or more fingers, and how far the first two are apart; 0 for one.
function spread(places) {
  const [[x, y], [u, v]] = [places[0], places[1] ?? places[0]];
  return { middle: [(x + u) / 2, (y + v) / 2], wide: Math.hypot(u - x, v - y) };
}
