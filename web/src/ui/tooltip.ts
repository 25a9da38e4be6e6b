import { h } from "./dom";

/** Wait before a help shows [ms]. */
const WAIT = 350;

/** Shows the text of `data-help` beside what is pointed at or focused. */
export function showTooltips(): void {
  const tip = h("div", { class: "tooltip", role: "tooltip", id: "tooltip", popover: "manual" });
  document.body.append(tip);
  /** What has the help, and what in it the help describes. */
  let [over, described]: (HTMLElement | null)[] = [null, null];
  let timer: ReturnType<typeof setTimeout> | undefined;

  /** What was pressed or left stays `over`, so that its help does not come back by itself. */
  const hide = () => {
    clearTimeout(timer);
    described?.removeAttribute("aria-describedby");
    if (tip.matches(":popover-open")) tip.hidePopover();
  };
  const show = (element: HTMLElement) => {
    tip.textContent = element.dataset.help ?? "";
    described?.setAttribute("aria-describedby", "tooltip");
    tip.showPopover();
    const [at, size] = [element.getBoundingClientRect(), tip.getBoundingClientRect()];
    const below = at.bottom + 6 + size.height < innerHeight;
    tip.style.top = `${below ? at.bottom + 6 : at.top - size.height - 6}px`;
    tip.style.left = `${Math.max(8, Math.min(at.left, innerWidth - size.width - 8))}px`;
  };
  const enter = (event: Event) => {
    const target = event.target as HTMLElement;
    const element = target.closest?.<HTMLElement>("[data-help]") ?? null;
    if (element === over) return;
    hide();
    over = element;
    if (!element?.dataset.help) return;
    described = event.type === "focusin" ? target : element;
    timer = setTimeout(() => show(element), WAIT);
  };

  document.addEventListener("pointerover", enter);
  document.addEventListener("focusin", (event) => {
    // What a mouse has focused is pointed at anyway.
    if ((event.target as Element).matches(":focus-visible")) enter(event);
  });
  document.addEventListener("focusout", hide);
  document.addEventListener("pointerdown", hide);
  document.addEventListener("scroll", hide, true);
  document.addEventListener("keydown", (event) => {
    if (event.key === "Escape") hide();
  });
}
