// The connection to the server: messages with numbers, their answers, and a new connection when one is lost.

const WAITS = [300, 700, 1500, 3000]; // ms before the next try
const ENDED = 1001; // the code with which a server that ends closes a connection
const LONG = 400; // ms without an answer from which on the page says that the server computes

export class Link {
  constructor(onNews, onStatus) {
    this.onNews = onNews;
    this.onStatus = onStatus;
    this.waiting = new Map();
    this.number = 0;
    this.tries = 0;
    this.open = false;
    this.session = sessionStorage.getItem("fastpin session") ?? "";
    this.since = 0; // when the oldest message without an answer was sent, ms
    setInterval(() => this.watch(), LONG / 2);
    this.connect();
  }

  // Say that the server computes, if an answer takes long.
  watch() {
    if (this.open) this.onStatus(this.waiting.size && performance.now() - this.since > LONG ? "computing" : "connected");
  }

  // End a long history that the server follows.
  stop() {
    if (this.open) this.socket.send(JSON.stringify({ kind: "stop", id: ++this.number }));
  }

  connect() {
    const address = new URL("socket", location.href);
    address.protocol = "ws:";
    this.socket = new WebSocket(address);
    this.socket.onopen = () => {
      this.open = true;
      this.tries = 0;
      this.onStatus("connected");
      this.ask("hello", { session: this.session });
    };
    this.socket.onmessage = (event) => this.receive(JSON.parse(event.data));
    this.socket.onclose = (event) => this.lost(event.code);
  }

  lost(code) {
    this.open = false;
    for (const answer of this.waiting.values()) answer({ kind: "gone" });
    this.waiting.clear();
    if (code === ENDED) this.tries = WAITS.length;
    this.onStatus(this.tries < WAITS.length ? "again" : "lost");
    setTimeout(() => this.connect(), WAITS[Math.min(this.tries, WAITS.length - 1)]);
    this.tries += 1;
  }

  receive(answer) {
    if (answer.kind === "welcome") {
      this.session = answer.session;
      sessionStorage.setItem("fastpin session", answer.session);
      this.onNews(answer);
      return; // the pictures follow under the same number
    }
    this.onNews(answer);
    this.since = performance.now();
    this.waiting.get(answer.id)?.(answer);
    this.waiting.delete(answer.id);
  }

  // Send a message. The promise gives its answer, or {kind: "gone"} without a server.
  ask(kind, fields = {}) {
    if (!this.open) return Promise.resolve({ kind: "gone" });
    const id = ++this.number;
    if (!this.waiting.size) this.since = performance.now();
    this.socket.send(JSON.stringify({ kind, id, ...fields }));
    return new Promise((answer) => this.waiting.set(id, answer));
  }
}
