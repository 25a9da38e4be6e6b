/** Pictures and films of what is drawn, saved as files. */

import { Emitter } from "./emitter";
import type { Notice } from "./notice";
import type { Session } from "./session";
import type { View } from "./view/view";

/** Frames a second of a film, and bits a second. */
const [RATE, BITS] = [60, 12e6];
const FORMATS = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"];

const NO_FILM = "This browser cannot record WebM.";

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

  /** Whether a film is being recorded: of pictures that are drawn, hence of those that do not change, too. */
  get filming(): boolean {
    return this.film?.state === "recording";
  }

  /** Begins a film, or ends and saves it. */
  toggleFilm(): void {
    try {
      if (this.film) this.film.stop();
      else this.begin();
    } catch (error) {
      this.film = null;
      this.notice.tell(`No film was recorded: ${(error as Error).message}`);
    }
    this.emit("recording", this.filming);
  }

  private begin(): void {
    const { canvas } = this.view.stage;
    const format = "MediaRecorder" in window && FORMATS.find((type) => MediaRecorder.isTypeSupported(type));
    if (!format || !("captureStream" in canvas)) {
      this.notice.tell(NO_FILM);
      return;
    }
    const stream = canvas.captureStream(RATE);
    const recorder = new MediaRecorder(stream, { mimeType: format, videoBitsPerSecond: BITS });
    const pieces: Blob[] = [];
    recorder.ondataavailable = ({ data }) => pieces.push(data);
    recorder.onerror = () => this.notice.tell("The browser stopped recording the film.");
    recorder.onstop = () => {
      this.film = null;
      this.emit("recording", false);
      const film = new Blob(pieces, { type: "video/webm" });
      if (film.size) save(film, `${this.name}.webm`);
      else this.notice.tell("The film is empty: record for longer.");
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
