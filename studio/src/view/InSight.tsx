// A section of the page that is not redrawn during a drag elsewhere while it is out of sight.
import { Component, type ComponentType, createRef } from "preact";
import type { Page } from "./page";

interface Props {
  page: Page;
  /** The id of the section's heading is `{name}-title`. */
  name: string;
  part: ComponentType<{ page: Page }>;
}

export class InSight extends Component<Props> {
  private readonly section = createRef<HTMLElement>();
  private isInSight = true;
  private observer: IntersectionObserver | undefined;

  override componentDidMount() {
    this.observer = new IntersectionObserver((entries) => {
      this.isInSight = entries.at(-1)!.isIntersecting;
      if (this.isInSight) this.forceUpdate();
    });
    if (this.section.current) this.observer.observe(this.section.current);
  }

  override componentWillUnmount() {
    this.observer?.disconnect();
  }

  override shouldComponentUpdate(next: Props) {
    return this.isInSight || !next.page.isMoving;
  }

  override render({ page, name, part: Part }: Props) {
    return (
      <section ref={this.section} aria-labelledby={`${name}-title`}>
        <Part page={page} />
      </section>
    );
  }
}
