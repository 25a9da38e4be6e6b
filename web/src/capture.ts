/** Pictures and films of what is drawn, saved as files. */

import { Emitter } from "./emitter";
import type { Notice } from "./notice";
import type { Session } from "./session";
import type { View } from "./view/view";

/** Frames a second of a film, and bits a second. */
const [RATE, BITS] = [60, 12e6];
const FORMATS = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"];

/** Saves pictures, and records films to WebM. */
export class Capture extends Emitter<{ recording: boolean }> {
  private film: MediaRecorder | null = null;

  constructor(
    private readonly session: Session,
    private readonly view: View,
    private readonly notice: Notice,
  ) {
    super();
  }

  savePicture(): void {
    // The canvas is empty after the browser has shown it, so it is drawn in the same turn.
    this.view.render();
    this.view.stage.canvas.toBlob((picture) => {
      if (picture) save(picture, `${this.name}.png`);
      else this.notice.tell("The browser made no picture of the canvas.");
    }, "image/png");
  }

  /** Begins a film, or ends and saves it. */
  toggleFilm(): void {
    if (this.film) this.film.stop();
    else this.begin();
    this.emit("recording", this.film?.state === "recording");
  }

  private begin(): void {
    const mimeType = FORMATS.find((format) => MediaRecorder.isTypeSupported(format));
    if (!mimeType) {
      this.notice.tell("This browser cannot record WebM.");
      return;
    }
    const stream = this.view.stage.canvas.captureStream(RATE);
    const recorder = new MediaRecorder(stream, { mimeType, videoBitsPerSecond: BITS });
    const pieces: Blob[] = [];
    recorder.ondataavailable = ({ data }) => pieces.push(data);
    recorder.onstop = () => {
      this.film = null;
      save(new Blob(pieces, { type: "video/webm" }), `${this.name}.webm`);
    };
    recorder.start(1000);
    this.film = recorder;
  }

  /** Of the files: the scene and its time. */
  private get name(): string {
    const time = this.session.frame?.time ?? 0;
    return `${this.session.scene?.name ?? "kinetarium"}-${time.toFixed(3)}s`;
  }
}

function save(data: Blob, name: string): void {
  const address = URL.createObjectURL(data);
  const link = document.createElement("a");
  link.href = address;
  link.download = name;
  link.click();
  setTimeout(() => URL.revokeObjectURL(address), 10_000);
}
