// A section of the page that is not drawn anew while one drags something elsewhere and it is out of sight.
import { Component, type ComponentType, createRef } from "preact";
import type { Page } from "./page";

interface Props {
  page: Page;
  /** The section's heading has this as the start of its id. */
  name: string;
  part: ComponentType<{ page: Page }>;
}

export class InSight extends Component<Props> {
  private readonly section = createRef<HTMLElement>();
  private isInSight = true;
  private watch: IntersectionObserver | undefined;

  override componentDidMount() {
    this.watch = new IntersectionObserver((entries) => {
      this.isInSight = entries.at(-1)!.isIntersecting;
      if (this.isInSight) this.forceUpdate();
    });
    if (this.section.current) this.watch.observe(this.section.current);
  }

  override componentWillUnmount() {
    this.watch?.disconnect();
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
