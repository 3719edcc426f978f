// Search from file://, where browsers start no workers: the worker's script runs in a hidden frame instead.
if (location.protocol === "file:") {
  window.Worker = class extends EventTarget {
    #inner;
    #ready;

    constructor(url) {
      super();
      const frame = document.body.appendChild(document.createElement("iframe"));
      frame.hidden = true;
      this.#inner = frame.contentWindow;
      this.#inner.postMessage = (data) => this.dispatchEvent(new MessageEvent("message", { data }));
      this.#inner.importScripts = () => {};
      const script = this.#inner.document.createElement("script");
      script.src = new URL(url, location.href);
      this.#ready = new Promise((resolve) => (script.onload = resolve));
      this.#inner.document.body.append(script);
    }

    postMessage(data) {
      this.#ready.then(() => this.#inner.dispatchEvent(new MessageEvent("message", { data })));
    }

    terminate() {
      this.#inner.frameElement.remove();
    }
  };
}
