// Files on their way to the server: one piece at a time, the next once it says how much has come.

const PIECE = 1 << 20;
const PATIENCE_MS = 5000; // after which a piece is sent again

export class Uploader {
  constructor(link) {
    this.link = link;
    this.files = new Map();
  }

  /** Send files, after each other. */
  add(files) {
    for (const file of files) {
      const number = crypto.getRandomValues(new Uint32Array(1))[0];
      this.files.set(number, file);
      this.link.say({ type: "begin", file: number, name: file.name, bytes: file.size });
    }
  }

  /** So much of a file has come. */
  async got({ file, bytes }) {
    const sent = this.files.get(file);
    if (!sent) return;
    clearTimeout(sent.waiting);
    if (bytes >= sent.size) {
      this.files.delete(file);
      return;
    }
    const piece = await sent.slice(bytes, bytes + PIECE).arrayBuffer();
    const head = new DataView(new ArrayBuffer(13));
    head.setUint8(0, 0);
    head.setUint32(1, file, true);
    head.setBigUint64(5, BigInt(bytes), true);
    this.link.send(new Blob([head, piece]));
    sent.waiting = setTimeout(() => this.got({ file, bytes }), PATIENCE_MS);
  }

  /** Files that are not in the tray any more are not sent on. */
  keep(numbers) {
    for (const [number, file] of this.files) {
      if (file.begun && !numbers.has(number)) {
        clearTimeout(file.waiting);
        this.files.delete(number);
      }
      file.begun ||= numbers.has(number);
    }
  }
}
