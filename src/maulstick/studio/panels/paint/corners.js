const NAMES = ["Upper left", "Upper right", "Lower right", "Lower left"];
const STEP = 0.002; // share of a side that an arrow key moves a corner; with Shift a tenth of it
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
const NEARER = 5; // times larger in the magnifier
const WIDE = 160; // CSS pixels of the magnifier

export default {
  template: `
    <div class="corners">
      <img ref="photo" :src="source" alt="What the camera sees" draggable="false">
      <svg viewBox="0 0 1 1" preserveAspectRatio="none" aria-hidden="true"><polygon :points="now.join(' ')"/></svg>
      <div v-for="([x, y], i) in now" :key="i" role="button" tabindex="0" class="corner"
        :aria-label="names[i] + ' corner of the sheet'" :style="{ left: 100 * x + '%', top: 100 * y + '%' }"
        @pointerdown="grasp($event, i)" @pointermove="move" @pointerup="release" @pointercancel="release"
        @keydown="step($event, i)" @focus="shown = i" @blur="shown = null"><span>{{ i + 1 }}</span></div>
      <div v-if="shown !== null" class="magnifier" aria-hidden="true" :style="magnified()"></div>
    </div>
  `,
  props: { source: String, corners: Array }, // shares of the photograph's sides
  data() {
    return { now: this.corners, held: null, shown: null, names: NAMES };
  },
  methods: {
    grasp(event, corner) {
      if (event.button !== 0 || this.held !== null) return;
      event.preventDefault();
      event.currentTarget.focus({ focusVisible: false });
      event.currentTarget.setPointerCapture(event.pointerId);
      [this.held, this.pointer] = [corner, event.pointerId];
      this.began = { place: this.now[corner], x: event.clientX, y: event.clientY };
    },
    move(event) {
      if (this.held === null || event.pointerId !== this.pointer) return;
      const box = this.$refs.photo.getBoundingClientRect();
      const { place, x, y } = this.began;
      this.take(this.held, [place[0] + (event.clientX - x) / box.width, place[1] + (event.clientY - y) / box.height]);
    },
    release(event) {
      if (event.pointerId === this.pointer) this.held = this.pointer = null;
    },
    step(event, corner) {
      const way = ARROWS[event.key];
      if (!way || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      const far = event.shiftKey ? STEP / 10 : STEP;
      const [x, y] = this.now[corner];
      this.take(corner, [x + far * way[0], y + far * way[1]]);
    },
    take(corner, place) {
      this.now = this.now.map((each, i) => (i === corner ? place.map((share) => Math.min(Math.max(share, 0), 1)) : each));
      this.$emit("placed", this.now);
    },
    // What lies around the corner, in the middle of the sheet, where it hides no other one.
    magnified() {
      const [x, y] = this.now[this.shown];
      const { clientWidth, clientHeight } = this.$refs.photo;
      return {
        width: `${WIDE}px`,
        height: `${WIDE}px`,
        backgroundImage: `url(${this.source})`,
        backgroundSize: `${NEARER * clientWidth}px ${NEARER * clientHeight}px`,
        backgroundPosition: `${WIDE / 2 - NEARER * x * clientWidth}px ${WIDE / 2 - NEARER * y * clientHeight}px`,
      };
    },
  },
};
