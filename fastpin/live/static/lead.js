// Loads and changes that the user makes. Of a drag only the latest one is sent when the last one is answered.

let gestures = Date.now();

export function newGesture() {
  gestures += 1;
  return gestures;
}

export class Leader {
  constructor(link) {
    this.link = link;
    this.busy = false;
    this.next = null;
    this.asked = 0; // when the latest message that is answered was sent, ms
  }

  // Follow a load. While one is on its way, the latest of the others waits.
  drag(loads, gesture) {
    this.send("load", { loads, gesture });
  }

  // Change the problem, in the same way.
  change(changes, gesture, follow) {
    this.send("change", { changes, gesture, follow });
  }

  async send(kind, fields) {
    if (this.busy) {
      this.next = [kind, fields];
      return;
    }
    this.busy = true;
    const asked = performance.now();
    await this.link.ask(kind, fields);
    this.asked = asked;
    this.busy = false;
    if (this.next) {
      const next = this.next;
      this.next = null;
      this.send(...next);
    }
  }

  // Follow one load, and give its answer.
  step(loads, gesture) {
    return this.link.ask("load", { loads, gesture });
  }
}
