// A field on an array: a layer of it as a picture, a row of it as a line, with its extrema.

import type { Field } from "./field_data";

type Colour = [number, number, number];

/** A dot on the picture. */
export interface Dot {
  vertex: number;
  colour: string;
  isSelected: boolean;
}

export class FieldPicture {
  private layer = 0;
  private colours: (at: number) => Colour = () => [0, 0, 0];
  private dots: Dot[] = [];
  private readonly context: CanvasRenderingContext2D;
  private isAsked = false;

  constructor(private readonly element: HTMLElement, private readonly canvas: HTMLCanvasElement, private readonly field: Field) {
    this.context = canvas.getContext("2d")!;
    new ResizeObserver(() => this.draw()).observe(element);
  }

  /** `colours` is asked for the colour of a vertex by its place among those that are shown. */
  show(layer: number, colours: (at: number) => Colour, dots: Dot[]): void {
    Object.assign(this, { layer, colours, dots });
    this.draw();
  }

  /** The place of the vertex under an event among those that are shown. */
  under(event: { clientX: number; clientY: number }): number | null {
    const box = this.canvas.getBoundingClientRect();
    const { left, top, size } = this.frame();
    const [, rows, columns] = this.field.shape!;
    const x = Math.floor((event.clientX - box.left - left) / size[0]);
    const y = this.isLine ? 0 : Math.floor((event.clientY - box.top - top) / size[1]);
    if (x < 0 || y < 0 || x >= columns || y >= rows) return null;
    return (this.layer * rows + y) * columns + x;
  }

  private get isLine(): boolean {
    return this.field.shape![0] * this.field.shape![1] === 1;
  }

  /** Where the picture begins, and how large a value is on it, in pixels. */
  private frame(): { left: number; top: number; size: [number, number] } {
    const [, rows, columns] = this.field.shape!;
    const { clientWidth: width, clientHeight: height } = this.element;
    if (this.isLine) return { left: 12, top: 12, size: [(width - 24) / columns, height - 24] };
    const one = Math.min((width - 24) / columns, (height - 24) / rows);
    return { left: (width - one * columns) / 2, top: (height - one * rows) / 2, size: [one, one] };
  }

  private draw(): void {
    if (this.isAsked) return;
    this.isAsked = true;
    requestAnimationFrame(() => {
      this.isAsked = false;
      this.paint();
    });
  }

  private paint(): void {
    const { canvas, context, element } = this;
    const ratio = devicePixelRatio;
    canvas.width = Math.max(1, element.clientWidth * ratio);
    canvas.height = Math.max(1, element.clientHeight * ratio);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const [, rows, columns] = this.field.shape!;
    const { left, top, size } = this.frame();
    const begin = this.layer * rows * columns;
    if (this.isLine) this.paintLine();
    else if (rows && columns) {
      const image = new ImageData(columns, rows);
      for (let k = 0; k < rows * columns; k++) image.data.set([...this.colours(begin + k), 255], 4 * k);
      const small = document.createElement("canvas");
      [small.width, small.height] = [columns, rows];
      small.getContext("2d")!.putImageData(image, 0, 0);
      context.imageSmoothingEnabled = size[0] < 1;
      context.drawImage(small, left, top, size[0] * columns, size[1] * rows);
    }
    for (const { vertex, colour, isSelected } of this.dots) {
      const at = vertex - this.field.first - begin;
      if (at < 0 || at >= rows * columns) continue;
      const x = left + size[0] * ((at % columns) + 0.5);
      const y = this.isLine ? this.height(at) : top + size[1] * (Math.floor(at / columns) + 0.5);
      context.beginPath();
      context.arc(x, y, isSelected ? 8 : 5, 0, 2 * Math.PI);
      context.fillStyle = colour;
      context.fill();
      context.lineWidth = 1.5;
      context.strokeStyle = "#fff";
      context.stroke();
    }
  }

  private height(at: number): number {
    const { top, size } = this.frame();
    return top + size[1] * (1 - Math.max(0, this.field.values[at] - 1) / 254);
  }

  /** A series: bars from the least value up, close beside each other. */
  private paintLine(): void {
    const { left, top, size } = this.frame();
    const { values } = this.field;
    for (let at = 0; at < values.length; at++) {
      if (!values[at]) continue;
      this.context.fillStyle = `rgb(${this.colours(at).join(" ")})`;
      const y = this.height(at);
      this.context.fillRect(left + size[0] * at, y, Math.max(1, size[0]), top + size[1] + 4 - y);
    }
  }
}
