// Canvas on which a person directs a plan: its elements; what they do is in the modules that it loads.

export default {
  template: `
    <div class="strokes-view" :class="tool" ref="view" role="group" tabindex="0" :aria-label="label">
      <canvas ref="sheet" aria-hidden="true"></canvas>
      <canvas ref="glass" hidden class="loupe" aria-hidden="true"></canvas>
      <span ref="scale" class="scale figure"></span>
    </div>
  `,
  // wide, high: of the sheet, millimetres.  colours, halfWidths: of each paint, at pressures from 0 to 1.
  // version: of the strokes at the address `source`.  resourcePath: where the modules are.
  // said: regions and guides (see places.js).  saidChosen: id of one of them.  broad: width of the brush of importance.
  props: {
    source: String, version: Number, picture: String, label: String, wide: Number, high: Number, paper: String,
    colours: Array, halfWidths: Array, tool: String, paint: Number, resourcePath: String,
    said: Object, saidChosen: Number, broad: Number,
  },
  watch: {
    version() {
      this.stage?.load();
    },
    said() {
      this.stage?.showPlaces();
    },
    saidChosen() {
      this.stage?.showPlaces();
    },
    tool() {
      this.stage?.repaint();
    },
  },
  async mounted() {
    const modules = ["stage", "pointers", "keys"].map((name) => import(`${this.resourcePath}/${name}.js`));
    const [{ Stage }, { Pointers }, { Keys }] = await Promise.all(modules);
    if (!this.$refs.view) return; // the page has gone on meanwhile
    this.stage = new Stage(this.$refs, this.$props, (name, what) => this.$emit(name, what));
    this.keys = new Keys(this.stage);
    this.pointers = new Pointers(this.stage, this.keys);
  },
  unmounted() {
    this.keys?.close();
    this.stage?.close();
  },
  methods: {
    // Call a method of the stage by its name.
    run(name, ...given) {
      this.stage?.[name](...given);
    },
  },
};
