const LIGHT = 0.15; // millimetres wide, at pressure 0
const DEEP = 1.2; // at pressure 1
const INK = "#26221d";
const NEAR = 2.5; // millimetres from a stroke that is rubbed out
const ERASER = 32; // PointerEvent.buttons
const COLUMNS = 3; // x, y, pressure
const TAP = 400; // milliseconds that fingers stay at most where two undo, and three redo
const STILL = 12; // CSS pixels that they may move meanwhile

export default {
  template: `
    <div class="pen" :class="{ rubs, deaf }" :style="{ '--proportion': width / height }">
      <canvas ref="sheet" role="img" :aria-label="'A sheet of paper, ' + width + ' by ' + height + ' millimetres'"
        @pointerdown="begin" @pointermove="move" @pointerup="end" @pointercancel="cancel" @contextmenu.prevent></canvas>
      <p v-if="deaf" class="silence" role="alert">The studio does not answer; strokes would be lost.</p>
    </div>
  `,
  props: { width: Number, height: Number, longest: Number, rubs: Boolean },
  data() {
    return { deaf: false }; // whether nobody hears what is drawn
  },
  created() {
    this.strokes = new Map(); // by id: { points: [x, y, pressure, x, …], box }; beside Vue, which would watch each number
    this.unheard = new Map(); // points of strokes, by id, of which the studio has not said yet that it has them
    this.rubbed = new Map(); // swipes by ids of strokes, of which it has not said yet that they are gone
    this.stroke = null; // what is being drawn
    this.rubber = null; // where it was
    this.swipe = null; // number of the movement that rubs out
    this.pointer = null;
    this.knowsPen = false;
    this.fingers = new Map(); // places where they came down, by pointer
    this.tap = null; // { began, most, still } of the fingers that are down
  },
  mounted() {
    this.ink = this.$refs.sheet.getContext("2d", { desynchronized: true });
    this.fitting = new ResizeObserver(() => this.fit());
    this.fitting.observe(this.$refs.sheet);
    document.addEventListener("keydown", this.key);
    this.$nextTick(() => {
      this.socket = window.socket; // of the page, which is mounted after what is on it
      this.socket.on("disconnect", this.lose);
      this.socket.on("connect", this.regain);
    });
    this.fit();
    this.$emit("ready");
  },
  unmounted() {
    this.fitting.disconnect();
    document.removeEventListener("keydown", this.key);
    this.socket.off("disconnect", this.lose);
    this.socket.off("connect", this.regain);
  },
  methods: {
    show(strokes) {
      for (const [id, points] of strokes) {
        this.strokes.set(id, { points, box: boxOf(points) });
        this.draw(points);
      }
    },
    heard(id) {
      this.unheard.delete(id);
    },
    drop(id) {
      this.rubbed.delete(id);
      this.erase(id);
    },
    erase(id) {
      this.unheard.delete(id);
      const stroke = this.strokes.get(id);
      if (!stroke) return;
      this.strokes.delete(id);
      this.drawAll(stroke.box);
    },

    lose() {
      this.deaf = true;
      this.lift();
      this.drawAll();
    },
    // What was done before the silence was noticed is sent again.
    regain() {
      this.deaf = false;
      for (const [id, points] of this.unheard) this.$emit("stroke", { id, points });
      for (const [id, swipe] of this.rubbed) this.$emit("rub", { id, swipe });
    },

    begin(event) {
      if (this.deaf) return;
      if (this.countFinger(event)) return;
      const isPen = event.pointerType === "pen";
      this.knowsPen ||= isPen;
      if (isPen && this.tap) this.tap.still = false; // a palm
      if (event.pointerType === "touch" && this.knowsPen) return; // a palm
      if (this.pointer !== null) {
        if (!isPen || this.pointerType === "pen") return;
        this.cancel({ pointerId: this.pointer }); // the palm came first
      }
      const erases = Boolean(event.buttons & ERASER);
      if (event.button !== 0 && !erases) return;
      this.pointer = event.pointerId;
      this.pointerType = event.pointerType;
      this.$refs.sheet.setPointerCapture(event.pointerId);
      document.activeElement?.blur?.(); // so that the keys are the sheet's
      if (this.rubs || erases) {
        this.rubber = this.place(event);
        this.swipe = newNumber();
        this.rub(this.rubber);
      } else {
        this.stroke = { id: newNumber(), told: [], points: [] };
        this.record(event);
      }
    },
    move(event) {
      const down = this.fingers.get(event.pointerId);
      if (down && Math.hypot(event.clientX - down[0], event.clientY - down[1]) > STILL) this.tap.still = false;
      if (event.pointerId !== this.pointer) return;
      const all = event.getCoalescedEvents?.() ?? [];
      for (const each of all.length ? all : [event]) {
        if (this.stroke) this.record(each);
        else if (this.rubber) this.rub(this.place(each));
      }
    },
    end(event) {
      this.leaveFinger(event);
      if (event.pointerId !== this.pointer) return;
      this.finish();
      this.lift();
    },
    cancel(event) {
      if (this.fingers.delete(event.pointerId)) this.tap.still = false;
      if (event.pointerId !== this.pointer) return;
      this.lift();
      this.drawAll();
    },
    // Whether this finger makes a tap of several, whose first one has drawn nothing then.
    countFinger(event) {
      if (event.pointerType !== "touch") return false;
      if (!this.fingers.size) this.tap = { began: event.timeStamp, most: 0, still: true };
      this.fingers.set(event.pointerId, [event.clientX, event.clientY]);
      this.tap.most = Math.max(this.tap.most, this.fingers.size);
      if (this.pointerType === "pen" && this.pointer !== null) this.tap.still = false; // a palm
      if (this.fingers.size < 2 || !this.tap.still || event.timeStamp - this.tap.began > TAP) return false;
      if (this.pointerType === "touch" && this.pointer !== null) {
        this.lift();
        this.drawAll();
      }
      return true;
    },
    leaveFinger(event) {
      if (!this.fingers.delete(event.pointerId) || this.fingers.size) return;
      const { began, most, still } = this.tap;
      if (still && most > 1 && event.timeStamp - began < TAP) this.$emit(most === 2 ? "undo" : "redo");
    },
    lift() {
      this.pointer = this.stroke = this.rubber = null;
    },

    record(event) {
      const { told, points } = this.stroke;
      const [x, y] = this.place(event);
      if (x < 0 || y < 0 || x > this.width || y > this.height || points.length === COLUMNS * this.longest) {
        this.finish();
        return;
      }
      const time = Math.max(performance.timeOrigin + event.timeStamp, told.at(-6) ?? 0);
      const felt = event.pressure || (event.pointerType === "pen" ? 0 : 0.5); // some screens say 0 for a finger
      const pressure = rounded(felt, 3);
      told.push(rounded(time, 1), x, y, pressure, Math.round(event.tiltX ?? 0), Math.round(event.tiltY ?? 0));
      points.push(x, y, pressure);
      this.segment(points, points.length / COLUMNS - 1);
    },
    finish() {
      const stroke = this.stroke;
      this.stroke = null;
      if (!stroke?.points.length) return;
      this.tail(stroke.points);
      this.strokes.set(stroke.id, { points: stroke.points, box: boxOf(stroke.points) });
      this.unheard.set(stroke.id, stroke.told);
      this.$emit("stroke", { id: stroke.id, points: stroke.told });
    },
    rub(place) {
      const way = boxOf([...this.rubber, 0, ...place, 0]);
      for (const [id, { points, box }] of this.strokes) {
        if (meet(box, way) && isNear(points, this.rubber, place)) {
          this.erase(id);
          this.rubbed.set(id, this.swipe);
          this.$emit("rub", { id, swipe: this.swipe });
        }
      }
      this.rubber = place;
    },
    key(event) {
      const key = event.key.toLowerCase();
      if (!(event.ctrlKey || event.metaKey) || event.altKey || !"zy".includes(key)) return;
      if (document.querySelector(".q-dialog")) return;
      if (event.target.closest?.("input, textarea, [contenteditable]")) return;
      event.preventDefault();
      this.$emit(key === "y" || event.shiftKey ? "redo" : "undo");
    },

    place(event) {
      const box = this.$refs.sheet.getBoundingClientRect();
      return [
        rounded(((event.clientX - box.left) / box.width) * this.width, 3),
        rounded(((event.clientY - box.top) / box.height) * this.height, 3),
      ];
    },
    fit() {
      const sheet = this.$refs.sheet;
      const wide = Math.round(sheet.clientWidth * devicePixelRatio);
      const high = Math.round(sheet.clientHeight * devicePixelRatio);
      if (!wide || !high || (sheet.width === wide && sheet.height === high && this.scale)) return;
      [sheet.width, sheet.height, this.scale] = [wide, high, wide / this.width];
      this.ink.setTransform(this.scale, 0, 0, this.scale, 0, 0); // all of this is lost with the size
      this.ink.lineCap = this.ink.lineJoin = "round";
      this.ink.strokeStyle = this.ink.fillStyle = INK;
      this.drawAll();
    },
    drawAll(box = [0, 0, this.width, this.height]) {
      if (!this.scale) return;
      const ink = this.ink;
      const [left, upper, right, lower] = box.map((side) => Math.round(side * this.scale)); // else a seam is seen
      ink.save();
      ink.resetTransform();
      ink.beginPath();
      ink.rect(left, upper, right - left, lower - upper);
      ink.clip();
      ink.setTransform(this.scale, 0, 0, this.scale, 0, 0);
      ink.clearRect(0, 0, this.width, this.height);
      for (const stroke of this.strokes.values()) if (meet(stroke.box, box)) this.draw(stroke.points);
      if (this.stroke) this.draw(this.stroke.points);
      ink.restore();
    },
    draw(points) {
      for (let i = 0; i < points.length / COLUMNS; i++) this.segment(points, i);
      this.tail(points);
    },
    // From between the two points before the point i to between the last of these and it: bent there, and smooth.
    segment(points, i) {
      const ink = this.ink;
      const at = COLUMNS * i;
      const [x, y, u, v] = [points[at], points[at + 1], points[at - 3], points[at - 2]];
      ink.beginPath();
      if (i === 0) {
        ink.arc(x, y, this.widthAt(points, 0) / 2, 0, 2 * Math.PI);
        ink.fill();
        return;
      }
      if (i === 1) {
        ink.moveTo(u, v);
        ink.lineTo((u + x) / 2, (v + y) / 2);
      } else {
        ink.moveTo((points[at - 6] + u) / 2, (points[at - 5] + v) / 2);
        ink.quadraticCurveTo(u, v, (u + x) / 2, (v + y) / 2);
      }
      ink.lineWidth = this.widthAt(points, i - 1);
      ink.stroke();
    },
    tail(points) {
      const last = points.length / COLUMNS - 1;
      if (last < 1) return;
      const [u, v, , x, y] = points.slice(COLUMNS * (last - 1));
      this.ink.beginPath();
      this.ink.moveTo((u + x) / 2, (v + y) / 2);
      this.ink.lineTo(x, y);
      this.ink.lineWidth = this.widthAt(points, last);
      this.ink.stroke();
    },
    widthAt(points, i) {
      return LIGHT + (DEEP - LIGHT) * points[COLUMNS * i + 2];
    },
  },
};

function newNumber() {
  return 2 ** 32 + Math.floor(Math.random() * 2 ** 52);
}

function rounded(number, places) {
  return Number(number.toFixed(places));
}

// The left, upper, right and lower sides of all that points can ink, and of all from where they can be rubbed out.
function boxOf(points) {
  const box = [Infinity, Infinity, -Infinity, -Infinity];
  for (let i = 0; i < points.length; i += COLUMNS) {
    box[0] = Math.min(box[0], points[i] - NEAR);
    box[1] = Math.min(box[1], points[i + 1] - NEAR);
    box[2] = Math.max(box[2], points[i] + NEAR);
    box[3] = Math.max(box[3], points[i + 1] + NEAR);
  }
  return box;
}

function meet(one, other) {
  return one[0] < other[2] && other[0] < one[2] && one[1] < other[3] && other[1] < one[3];
}

// Whether the way from one place to another passes a stroke closely.
function isNear(points, from, to) {
  for (let i = 0; i < points.length; i += COLUMNS) {
    const [x, y] = [points[i], points[i + 1]];
    const [u, v] = i ? [points[i - COLUMNS], points[i - COLUMNS + 1]] : [x, y];
    if (distance(x, y, from, to) < NEAR || distance(...to, [u, v], [x, y]) < NEAR) return true;
  }
  return false;
}

function distance(x, y, [u, v], [r, s]) {
  const [along, down] = [r - u, s - v];
  const long = along * along + down * down;
  const part = long ? Math.min(1, Math.max(0, ((x - u) * along + (y - v) * down) / long)) : 0;
  return Math.hypot(x - u - part * along, y - v - part * down);
}
