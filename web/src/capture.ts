/** Pictures and films of the canvas, saved as files. */

/** Frames a second of a film. */
const RATE = 60;
const FORMATS = ["video/webm;codecs=vp9", "video/webm;codecs=vp8", "video/webm"];

export async function savePicture(canvas: HTMLCanvasElement, name: string): Promise<void> {
  const picture = await new Promise<Blob | null>((done) => canvas.toBlob(done, "image/png"));
  if (!picture) throw new Error("The browser made no picture of the canvas.");
  save(picture, `${name}.png`);
}

/** Records the canvas to a WebM file. */
export class Recorder {
  private recorder: MediaRecorder | null = null;
  private pieces: Blob[] = [];

  constructor(private readonly canvas: HTMLCanvasElement) {}

  get recording(): boolean {
    return this.recorder !== null;
  }

  start(): void {
    const mimeType = FORMATS.find((format) => MediaRecorder.isTypeSupported(format));
    if (!mimeType) throw new Error("This browser cannot record WebM.");
    const recorder = new MediaRecorder(this.canvas.captureStream(RATE), {
      mimeType,
      videoBitsPerSecond: 12e6,
    });
    const pieces: Blob[] = [];
    recorder.ondataavailable = ({ data }) => pieces.push(data);
    recorder.start(1000);
    this.pieces = pieces;
    this.recorder = recorder;
  }

  /** Ends the film and saves it. */
  async stop(name: string): Promise<void> {
    const { recorder, pieces } = this;
    if (!recorder) return;
    this.recorder = null;
    await new Promise((done) => {
      recorder.onstop = done;
      recorder.stop();
    });
    save(new Blob(pieces, { type: "video/webm" }), `${name}.webm`);
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
