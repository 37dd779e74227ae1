import { download } from "./download";
import { svgOf } from "./svg_file";

/** Pixels of the picture for each pixel of the plot on the page, so that it is sharp in print. */
const SCALE = 3;

/** A plot as a PNG picture that looks as on the page; null if the browser cannot draw it. */
export async function pngOf(plot: SVGSVGElement): Promise<Blob | null> {
  const { width, height } = plot.getBoundingClientRect();
  const address = URL.createObjectURL(new Blob([svgOf(plot)], { type: "image/svg+xml" }));
  try {
    const image = new Image();
    image.width = width;
    image.height = height;
    image.src = address;
    await image.decode();
    const canvas = document.createElement("canvas");
    canvas.width = Math.max(1, Math.round(SCALE * width));
    canvas.height = Math.max(1, Math.round(SCALE * height));
    canvas.getContext("2d")?.drawImage(image, 0, 0, canvas.width, canvas.height);
    return await new Promise((done) => canvas.toBlob(done, "image/png"));
  } finally {
    URL.revokeObjectURL(address);
  }
}

export async function savePng(plot: SVGSVGElement, name: string): Promise<void> {
  const picture = await pngOf(plot);
  if (picture) download(name, "image/png", picture);
}
