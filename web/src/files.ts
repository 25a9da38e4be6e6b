import type { Notice } from "./notice";
import type { Skins } from "./panels/skins";
import type { Selection } from "./selection";
import type { Share } from "./share";
import type { View } from "./view/view";

/** What a robot's file may be called, for a file dialog. */
export const ROBOT_FILES = ".xml,.mjcf,.urdf";
/** Longest command that a server takes [bytes]; `crates/viewer/src/client.rs` says the same. */
const LONGEST = 1 << 20;

/** Files that are dropped anywhere on the page or chosen: robots are opened, all others are skins. */
export class Files {
  constructor(
    private readonly share: Share,
    private readonly view: View,
    private readonly selection: Selection,
    private readonly skins: Skins,
    private readonly notice: Notice,
  ) {
    // Where the page does not take a file, the browser leaves the page for it.
    addEventListener("dragover", (event) => {
      if (event.dataTransfer?.types.includes("Files")) event.preventDefault();
    });
    addEventListener("drop", (event) => this.drop(event));
  }

  /** Opens a robot file. */
  async open(file: File): Promise<void> {
    const command = { type: "file", name: file.name, text: await file.text() } as const;
    if (new Blob([JSON.stringify(command)]).size < LONGEST) this.share.openFile(command);
    else this.notice.tell(`${file.name} is larger than 1 MB: open it with \`kinetarium view\` instead.`);
  }

  private drop(event: DragEvent): void {
    const [file] = event.dataTransfer?.files ?? [];
    if (!file) return;
    event.preventDefault();
    if (isRobot(file)) {
      this.open(file);
      return;
    }
    const onPicture = event.target === this.view.stage.canvas;
    const hit = onPicture ? this.view.hit(event.offsetX, event.offsetY) : null;
    this.skins.wear(file, hit?.body ?? this.selection.now?.body);
  }
}

function isRobot({ name }: File): boolean {
  return ROBOT_FILES.split(",").some((extension) => name.toLowerCase().endsWith(extension));
}
