// Files on their way to the server: one piece at a time, the next once it says how much has come.

const PIECE = 1 << 20;
const PATIENCE_MS = 5000; // after which a piece is sent again
const VIDEO = /\.(mp4|m4v|mov|avi|mkv|mts|m2ts|webm|mpg|mpeg|wmv|3gp|ogv)$/i;
const MOST_LISTED = 1000; // entries of a dropped folder

export class Uploader {
  /** `complain` shows the user a text. */
  constructor(link, complain) {
    this.link = link;
    this.complain = complain;
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

  /** Send what was dropped; of a folder the videos in it, in the order of their names. */
  async addDropped({ items, files }) {
    const entries = [...items].map((item) => item.webkitGetAsEntry?.()).filter(Boolean);
    if (!entries.some((entry) => entry.isDirectory)) return this.add([...files]);
    const alone = await Promise.all(entries.filter((entry) => entry.isFile).map(fileOf));
    for (const folder of entries.filter((entry) => entry.isDirectory)) {
      try {
        const within = (await listed(folder)).filter((entry) => entry.isFile && VIDEO.test(entry.name));
        if (within.length === 0) this.complain(`the folder ${folder.name} holds no video by its files' names: drop the videos themselves`);
        within.sort((one, other) => one.name.localeCompare(other.name, undefined, { numeric: true }));
        alone.push(...await Promise.all(within.map(fileOf)));
      } catch (error) {
        this.complain(`the folder ${folder.name} cannot be read (${error.message}): drop its videos instead`);
      }
    }
    this.add(alone);
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
    let piece;
    try {
      piece = await sent.slice(bytes, bytes + PIECE).arrayBuffer();
    } catch {
      this.complain(`${sent.name} cannot be read: it was moved or changed, or is no file; drop it again`);
      this.files.delete(file);
      this.link.say({ type: "drop", file });
      return;
    }
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

function fileOf(entry) {
  return new Promise((take, fail) => entry.file(take, fail));
}

/** The entries of a folder; a browser gives them in parts. */
async function listed(folder) {
  const reader = folder.createReader();
  const found = [];
  for (;;) {
    const part = await new Promise((take, fail) => reader.readEntries(take, fail));
    if (part.length === 0 || found.length >= MOST_LISTED) return found;
    found.push(...part);
  }
}
