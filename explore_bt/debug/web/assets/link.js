// The socket to the server: questions with answers, and news.

/** Asks the server; finds it again when it was lost. */
export class Link {
  #socket = null;
  #waiting = new Map();
  #count = 0;
  #token = new URLSearchParams(location.hash.slice(1)).get("token") ?? "";

  /** Whether it has ever been admitted. */
  wasOpen = false;

  /** `onNews(news)`, `onState(isOpen)`. */
  constructor(onNews, onState) {
    this.onNews = onNews;
    this.onState = onState;
    this.#open();
  }

  /** The answer's members; rejects with the server's words. */
  ask(ask, members = {}) {
    if (this.#socket.readyState !== WebSocket.OPEN) return Promise.reject(new Error("the server is not there"));
    const id = ++this.#count;
    this.#socket.send(JSON.stringify({ id, ask, ...members }));
    return new Promise((resolve, reject) => this.#waiting.set(id, { resolve, reject }));
  }

  #open() {
    const scheme = location.protocol === "https:" ? "wss" : "ws";
    const query = this.#token ? `?token=${encodeURIComponent(this.#token)}` : "";
    this.#socket = new WebSocket(`${scheme}://${location.host}/socket${query}`);
    this.#socket.onopen = () => { this.wasOpen = true; this.onState(true); };
    this.#socket.onmessage = (event) => this.#take(JSON.parse(event.data));
    this.#socket.onclose = () => {
      for (const { reject } of this.#waiting.values()) reject(new Error("the server has gone"));
      this.#waiting.clear();
      this.onState(false);
      setTimeout(() => this.#open(), 2000);
    };
  }

  #take(message) {
    if (message.news) return this.onNews(message.news);
    const waiting = this.#waiting.get(message.id);
    this.#waiting.delete(message.id);
    if (message.error !== undefined) waiting?.reject(new Error(message.error));
    else waiting?.resolve(message);
  }
}
