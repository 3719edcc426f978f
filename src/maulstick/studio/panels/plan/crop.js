const LEAST = 0.05; // share of a side that is kept, so that edges do not meet
const STEP = 0.01; // share of a side that an arrow key moves; with Shift a tenth of it
const ARROWS = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

// Sides that each handle moves: -1 the left or upper one, 1 the right or lower one, 0 none.
const ALL = { name: "What is kept", x: 0, y: 0 };
const EDGES = [
  { name: "Left edge", x: -1, y: 0 },
  { name: "Upper edge", x: 0, y: -1 },
  { name: "Right edge", x: 1, y: 0 },
  { name: "Lower edge", x: 0, y: 1 },
];
const CORNERS = [
  { name: "Upper left corner", x: -1, y: -1 },
  { name: "Upper right corner", x: 1, y: -1 },
  { name: "Lower right corner", x: 1, y: 1 },
  { name: "Lower left corner", x: -1, y: 1 },
];

export default {
  template: `
    <div class="cutting" v-show="source">
      <img ref="picture" :src="source" alt="The picture as it is corrected" draggable="false">
      <div class="cut-off" aria-hidden="true"><div class="kept" :style="place(all)"></div></div>
      <div v-for="each in handles" :key="each.name" tabindex="0" :role="isEdge(each) ? 'slider' : 'button'"
        :class="['handle', 'x' + each.x, 'y' + each.y, { held: each === held, idle: each === all && isWhole }]"
        :style="place(each)" :aria-label="each.name" v-bind="told(each)" @pointerdown="grasp($event, each)"
        @pointermove="move" @pointerup="release" @pointercancel="release" @keydown="step($event, each)"></div>
    </div>
  `,
  props: { source: String, crop: Array, ratio: Number }, // ratio: width over height to keep, in shares; 0 for any
  data() {
    return { now: this.crop, held: null, all: ALL, handles: [ALL, ...EDGES, ...CORNERS] };
  },
  computed: {
    isWhole() {
      return this.now.every((share, i) => share === (i < 2 ? 0 : 1));
    },
  },
  methods: {
    lay(crop) {
      if (!this.held) this.now = crop;
    },

    isEdge: (handle) => !handle.x !== !handle.y,
    place({ x, y }) {
      const [left, top, right, bottom] = this.now.map((share) => `${100 * share}%`);
      const wide = x < 0 ? { left } : x > 0 ? { left: right } : { left, width: `${100 * (this.now[2] - this.now[0])}%` };
      const high = y < 0 ? { top } : y > 0 ? { top: bottom } : { top, height: `${100 * (this.now[3] - this.now[1])}%` };
      return { ...wide, ...high };
    },
    told(handle) {
      if (!this.isEdge(handle)) return {};
      const { x, y } = handle;
      const at = Math.round(100 * this.now[x < 0 ? 0 : y < 0 ? 1 : x > 0 ? 2 : 3]);
      return {
        "aria-valuemin": 0,
        "aria-valuemax": 100,
        "aria-valuenow": at,
        "aria-valuetext": `${x + y < 0 ? at : 100 - at} % cut off`,
        "aria-orientation": x ? "horizontal" : "vertical",
      };
    },

    grasp(event, handle) {
      if (event.button !== 0 || this.held) return;
      event.preventDefault();
      event.currentTarget.focus({ focusVisible: false });
      event.currentTarget.setPointerCapture(event.pointerId);
      [this.held, this.pointer] = [handle, event.pointerId];
      this.began = { crop: this.now, x: event.clientX, y: event.clientY };
    },
    move(event) {
      if (!this.held || event.pointerId !== this.pointer) return;
      const { crop, x, y } = this.began;
      const box = this.$refs.picture.getBoundingClientRect();
      const far = [(event.clientX - x) / box.width, (event.clientY - y) / box.height];
      this.take("dragged", moved(crop, this.held, ...far, this.ratio));
    },
    release(event) {
      if (event.pointerId !== this.pointer) return;
      this.held = this.pointer = null;
      this.$emit("laid", this.now);
    },
    step(event, handle) {
      const way = ARROWS[event.key];
      if (!way || event.ctrlKey || event.altKey || event.metaKey) return;
      event.preventDefault();
      const far = event.shiftKey ? STEP / 10 : STEP;
      this.take("laid", moved(this.now, handle, far * way[0], far * way[1], this.ratio));
    },
    take(name, crop) {
      this.now = crop.map((share) => Number(share.toFixed(4)));
      this.$emit(name, this.now);
    },
  },
};

// The crop after a handle has been moved by shares of the sides.
function moved([left, top, right, bottom], { x, y }, across, down, ratio) {
  if (!x && !y) {
    const [along, below] = [clamped(across, -left, 1 - right), clamped(down, -top, 1 - bottom)];
    return [left + along, top + below, right + along, bottom + below];
  }
  let wide = clamped(right - left + x * across, LEAST, x < 0 ? right : 1 - left);
  let high = clamped(bottom - top + y * down, LEAST, y < 0 ? bottom : 1 - top);
  if (!x) wide = right - left;
  if (!y) high = bottom - top;
  if (ratio) {
    [wide, high] = shaped(x ? wide : high * ratio, y ? high : wide / ratio, ratio);
    const room = [roomOf(x, left, right) / wide, roomOf(y, top, bottom) / high];
    const scale = Math.min(1, ...room);
    [wide, high] = [wide * scale, high * scale];
  }
  const [[west, east], [north, south]] = [side(x, left, right, wide), side(y, top, bottom, high)];
  return [west, north, east, south];
}

// The larger of both sides decides, and none is too short.
function shaped(wide, high, ratio) {
  const larger = Math.max(wide, high * ratio, LEAST, LEAST * ratio);
  return [larger, larger / ratio];
}

// How long a side can become where the other end, or the middle, stays.
function roomOf(way, first, last) {
  return way < 0 ? last : way > 0 ? 1 - first : Math.min(first + last, 2 - first - last);
}

function side(way, first, last, long) {
  if (way < 0) return [last - long, last];
  if (way > 0) return [first, first + long];
  return [(first + last - long) / 2, (first + last + long) / 2];
}

function clamped(number, least, most) {
  return Math.min(Math.max(number, least), Math.max(most, least));
}
