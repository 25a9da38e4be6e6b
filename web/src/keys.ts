import type { Page } from "./page";
import type { Shortcut } from "./shortcuts";

const ARROWS = ["ArrowLeft", "ArrowRight", "ArrowUp", "ArrowDown"];
const DIGITS = Array.from({ length: 9 }, (_, i) => String(i + 1));
const shifted = (keys: string[]) => keys.map((key) => `Shift+${key}`);
/** The place of a viewpoint that a digit stands for. */
const place = (key: string) => Number(key.at(-1)) - 1;

/** All that keys do; the help lists it in this order. */
export function keys(page: Page): Shortcut[] {
  const key = (keys: string | string[], help: string, act: (page: Page, key: string) => void): Shortcut => ({
    keys: [keys].flat(),
    help,
    act: (pressed) => act(page, pressed),
  });
  return [
    key(" ", "Runs or stops", ({ controls }) => controls.toggle()),
    key("n", "Steps once", ({ controls }) => controls.step(1)),
    key("Shift+n", "Steps 100 times", ({ controls }) => controls.step(100)),
    key("r", "Restarts", ({ controls }) => controls.restart()),
    key("b", "Rebuilds", ({ build }) => build.rebuild()),
    key([",", "."], "Goes back or on by a hundredth of what is recorded", ({ timeline }, pressed) =>
      timeline.leap(pressed === "," ? -1 : 1),
    ),
    key(["[", "]"], "The replicas before, or after", ({ controls }, pressed) =>
      controls.leaf(pressed === "[" ? -1 : 1),
    ),
    key(ARROWS, "Turn the view; pull at what is held", ({ grabbing, navigation }, pressed) =>
      grabbing.holds ? grabbing.arrow(pressed) : navigation.arrow(pressed),
    ),
    key(
      shifted(ARROWS),
      "Move the view; pull to and fro at what is held",
      ({ grabbing, navigation }, pressed) =>
        grabbing.holds ? grabbing.arrow(pressed) : navigation.arrow(pressed),
    ),
    key(["+", "-"], "Comes closer, or goes away", ({ navigation }, pressed) =>
      navigation.step(pressed === "+"),
    ),
    key("f", "Frames the scene, or the picked body; looks straight ahead", ({ navigation }) =>
      navigation.frame(),
    ),
    key(["j", "k"], "Picks the next body, or the one before", ({ selection }, pressed) =>
      selection.turn(pressed === "j" ? 1 : -1),
    ),
    key("c", "Follows the picked body, or no more", ({ navigation }) => navigation.mount("follow")),
    key("v", "Sees with the picked body's eyes, or no more", ({ navigation }) => navigation.mount("ride")),
    key("x", "Lets the camera go", ({ navigation }) => navigation.mount("free")),
    key("u", "Pushes the picked body along the view", ({ pushing }) => pushing.pushPicked()),
    key("h", "Holds the picked body by a spring, or lets it go", ({ grabbing, selection }) =>
      grabbing.hold(selection.drawn),
    ),
    key("g", "The pointer grabs bodies, or turns the view again", ({ pointing }) => pointing.toggle("grab")),
    key("p", "The pointer pushes bodies, or turns the view again", ({ pointing }) => pointing.toggle("push")),
    key("t", "Trails of none, the picked, all bodies", ({ viewPanel }) => viewPanel.turnTrails()),
    key(DIGITS, "Goes to a kept viewpoint", ({ viewPanel }, pressed) => viewPanel.recall(place(pressed))),
    key(shifted(DIGITS), "Keeps the viewpoint", ({ viewPanel }, pressed) => viewPanel.save(place(pressed))),
    key("o", "Shows or hides plots", ({ shell }) => shell.togglePlots()),
    key("s", "Saves a picture", ({ capture }) => capture.savePicture()),
    key("Shift+s", "Begins or ends a film", ({ capture }) => capture.toggleFilm()),
    key("Shift+e", "Shows or hides the scene's panel", ({ shell }) => shell.toggleSide("left")),
    key("Shift+i", "Shows or hides the panel of bodies", ({ shell }) => shell.toggleSide("right")),
    key("l", "Light, dark, or as the system says", ({ themes }) => themes.turn()),
    key("?", "This help", ({ shell }) => shell.help()),
    key("Escape", "Closes a panel over the picture; picks nothing, lets tools go", (page) => {
      const { shell, selection, pointing, grabbing, notice } = page;
      if (shell.closeOverlay()) return;
      selection.now = null;
      grabbing.hold(null);
      pointing.tool = "look";
      notice.clear();
    }),
  ];
}
