import type { Session } from "../session";
import type { Share } from "../share";
import { h } from "../ui/dom";
import { FieldForm } from "../ui/field_form";

/** Physics parameters, taken up at once. */
export class Physics {
  readonly element: HTMLElement;

  constructor(session: Session, share: Share) {
    const form = new FieldForm((name, value) => share.setPhysics({ [name]: value }));
    this.element = h("div", {}, form.element);
    session.on("physics", (fields) => {
      form.show(fields);
      this.element.hidden = fields.length === 0;
    });
  }
}
